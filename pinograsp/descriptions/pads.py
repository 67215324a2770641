"""Which of a hand's pads a task uses."""

from __future__ import annotations

from ..errors import InputError, close_names
from .robot import RobotDescription
from .scene import SceneDescription


def robot_for(robot: RobotDescription, scene: SceneDescription, task_name: str) -> RobotDescription:
    """Return the robot with the pads of a task, in its order: to the task, the others are links like any.

    Raises:
        InputError: there is no such task, or the robot has no pad of a name that the task gives.
    """
    names = scene.task(task_name).pads
    if names is None:
        return robot
    pads = {pad.name: pad for pad in robot.pads}
    for i, name in enumerate(names):
        if name not in pads:
            problem, key = f"{robot.name} has no pad {name!r}", f"tasks.{task_name}.pads[{i}]"
            raise InputError(problem, file=scene.source, key=key, remedy=close_names(name, list(pads)))
    return robot.model_copy(update={"pads": tuple(pads[name] for name in names)})
