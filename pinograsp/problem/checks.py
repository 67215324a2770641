"""Checks of a task that need no solve: of the task in its scene, and with the robot."""

from __future__ import annotations

import numpy as np

from ..descriptions import RobotDescription, Scene, Task
from ..descriptions.shapes import Compound, Mesh
from ..errors import TaskError
from ..geometry.filled import center_of_mass
from ..geometry.shapes import Surface, surface_of
from .angle_findings import angle_findings
from .loads import check_load
from .mesh_findings import mesh_findings
from .openings import check_openings
from .overlaps import depth_in
from .painted_regions import check_paint
from .regions import check_region
from .standing import check_standing
from .task_model import TaskModel

TOLERANCE = 1e-4
"""How far a desired point may be off the surface, and an object beyond a wall, m."""
OVERLAP = 1e-3
"""How deep an object may be in an obstacle or another object, m: poses are measured, and what stands touches."""


def check_placement(scene: Scene, task_name: str) -> None:
    """Refuse a task that cannot be meant in its scene, whatever the robot.

    Raises:
        TaskError: the object reaches beyond a wall or into another body, a desired contact is off the surface, or the
            object is a compound with a mesh.
        FileError: a mesh file of a painted region cannot be used, or nothing in it is painted so.
        UnknownNameError: the scene has no such task.
    """
    task = scene.task(task_name)
    _no_mesh_in_compound(scene, task)
    check_paint(scene, task_name)
    surface = surface_of(scene.objects[task.object].shape)
    _object_inside(scene, task, surface)
    _object_apart(scene, task)
    _contacts_on_surface(scene, task_name, surface)


def check_task(model: TaskModel) -> list[str]:
    """Refuse a task that cannot be meant with its robot; return what is odd about it, in words.

    Raises:
        TaskError: the number of desired contacts is not that of the pads, the jaw does not open wide enough for them,
            no contacts carry the load, or none can be made in the contact region.
    """
    pads = len(model.robot.description.pads)
    if model.task.desired_contacts is not None and len(model.desired_points) != pads:
        raise TaskError(
            f"{len(model.desired_points)} desired contacts for a hand of {pads} pads",
            file=model.scene.source,
            key=f"tasks.{model.task_name}.desired_contacts",
            remedy="Give one for each pad",
        )
    return [
        *file_findings(model.scene, model.task, model.robot.description),
        *_center_of_mass_odd(model),
        *check_openings(model),
        *check_load(model),
        *check_region(model),
        *check_standing(model),
    ]


def file_findings(scene: Scene, task: Task, robot: RobotDescription) -> list[str]:
    """Return what is odd about poses, and what was guessed and mended in mesh files of a scene, in words.

    Raises:
        FileError: a mesh file cannot be read, has changed since it was described, or encloses no body.
    """
    return [*angle_findings(scene, robot), *mesh_findings(scene, task)]


def _center_of_mass_odd(model: TaskModel) -> list[str]:
    """Return what is odd about the centre of mass: millimetres that are given for metres, for one."""
    name, surface = model.task.object, model.surface
    center = center_of_mass(model.scene.objects[name])
    beyond = float(np.linalg.norm(center)) - surface.radius
    if beyond <= 0.0:
        return []
    return [f"the centre of mass of {name!r} is at least {1e3 * beyond:.1f} mm outside of it: in metres, in its frame"]


def _no_mesh_in_compound(scene: Scene, task: Task) -> None:
    """Refuse to grasp a compound with a mesh: what its pads feel there would be single facets."""
    shape = scene.objects[task.object].shape
    if isinstance(shape, Compound) and any(isinstance(part.shape, Mesh) for part in shape.parts):
        raise TaskError(
            "a compound with a mesh cannot be grasped, only be in the way",
            file=scene.source,
            key=f"objects.{task.object}.shape",
            remedy="Put all parts into one mesh file; they may overlap in it",
        )


def _object_inside(scene: Scene, task: Task, surface: Surface) -> None:
    name = task.object
    T = scene.objects[name].pose.matrix
    R, origin = T[:3, :3], T[:3, 3]
    for wall, (inward, offset) in scene.enclosure.walls.items():
        beyond = offset - (inward @ origin - surface.extent(-R.T @ inward))
        if beyond > TOLERANCE:
            raise TaskError(
                f"the object {name!r} is outside the enclosure: {1e3 * beyond:.1f} mm beyond {wall}",
                file=scene.source,
                key=f"objects.{name}.pose",
                remedy="Move the object or the wall",
            )


def _object_apart(scene: Scene, task: Task) -> None:
    """Refuse an object that is in an obstacle or another object; of several the one that it is deepest in is named."""
    name, depths = task.object, dict[str, float]()
    target = scene.objects[name]
    for other, body in scene.bodies_besides(task).items():
        depths[other] = depth_in(target, body)
    other = max(depths, key=depths.__getitem__, default="")
    if other and depths[other] > OVERLAP:
        kind = "object" if other in scene.objects else "obstacle"
        raise TaskError(
            f"the object {name!r} is {1e3 * depths[other]:.1f} mm deep in the {kind} {other!r}",
            file=scene.source,
            key=f"objects.{name}.pose",
            remedy=f"Move one of them; they may touch, and overlap by {1e3 * OVERLAP:g} mm",
        )


def _contacts_on_surface(scene: Scene, task_name: str, surface: Surface) -> None:
    task = scene.task(task_name)
    if task.desired_contacts is None:
        return
    distances = surface.exact_distances(np.array(task.desired_contacts))
    worst = int(np.abs(distances).argmax())
    if abs(distances[worst]) > TOLERANCE:
        side = "outside" if distances[worst] > 0 else "inside"
        raise TaskError(
            f"this desired contact is {1e3 * abs(distances[worst]):.1f} mm {side} the surface of {task.object!r}",
            file=scene.source,
            key=f"tasks.{task_name}.desired_contacts[{worst}]",
            remedy="Desired contacts are points of the surface, in the object's frame, in metres",
        )
