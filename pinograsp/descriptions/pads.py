"""The pads of a hand that a task uses, and their contact models."""

from __future__ import annotations

from ..errors import UnknownNameError, close_names
from .robot import RobotDescription
from .scene import Scene


def robot_for(robot: RobotDescription, scene: Scene, task_name: str) -> RobotDescription:
    """Return the robot with the pads of a task, in its order, and its contact model: the other pads are links like any.

    Raises:
        UnknownNameError: there is no such task, or the robot has no pad of a name that the task gives.
    """
    task = scene.task(task_name)
    pads = {pad.name: pad for pad in robot.pads}
    names = tuple(pads) if task.pads is None else task.pads
    for i, name in enumerate(names):
        if name not in pads:
            problem, key = f"{robot.name} has no pad {name!r}", f"tasks.{task_name}.pads[{i}]"
            raise UnknownNameError(problem, file=scene.source, key=key, remedy=close_names(name, list(pads)))
    chosen = [pads[name] for name in names]
    if task.contact_model is not None:
        chosen = [pad.model_copy(update={"contact": task.contact_model}) for pad in chosen]
    return robot.model_copy(update={"pads": tuple(chosen)})
