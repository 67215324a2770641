"""Where the camera stands: the whole box, and close to the object."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..descriptions import Scene, Task
from ..geometry.filled import center_of_mass_world
from ..results.grasp import Grasp
from .viewer import Visualizer

FIELD_OF_VIEW = 40.0
"""Vertical angle, degrees."""
CLOSE_UP_RADIUS = 0.15
"""Radius around the object that the close-up shows, m."""
CAMERA = "/Cameras/default/rotated/<object>"
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class View:
    """Camera position and the point that it looks at and turns about; world frame, m, shapes (3,)."""

    position: Array
    target: Array


def whole_box(scene: Scene, task: Task) -> View:
    """Return a view of the whole enclosure from beyond the object, back to the mounting of the arm."""
    low, high = np.array(scene.enclosure.min), np.array(scene.enclosure.max)
    reach = _reach(scene, task)
    direction = reach - 0.36 * np.cross(UP, reach) + 0.5 * UP
    target = 0.75 * (low + high) / 2 + 0.25 * center_of_mass_world(scene.objects[task.object])
    return _view(target, direction, 0.9 * float(np.linalg.norm(high - low)) / 2)


def close_up(grasp: Grasp, scene: Scene, task: Task) -> View:
    """Return a view of the object across the line that joins the first two contacts, from beyond the hand."""
    reach = _reach(scene, task)
    line = grasp.contacts[1].point - grasp.contacts[0].point
    across = np.cross(line, UP)
    across = across / np.linalg.norm(across) if np.linalg.norm(across) > 1e-6 else reach
    if across @ reach < 0:
        across = -across
    direction = across - 0.35 * np.cross(UP, across) + 0.35 * UP
    center = center_of_mass_world(scene.objects[task.object]) + 0.2 * CLOSE_UP_RADIUS * UP
    return _view(center, direction, CLOSE_UP_RADIUS)


def around(low: Array, high: Array, direction: Array) -> View:
    """Return a view of the whole box between two corners, seen from `direction`; world frame, shapes (3,)."""
    return _view((low + high) / 2, direction, 0.9 * float(np.linalg.norm(high - low)) / 2)


def place(world: Visualizer, view: View) -> None:
    """Put the camera of a viewer at a view.

    meshcat's camera turns about the viewer's origin: the node that holds the world is moved instead.
    """
    T = np.eye(4)
    T[:3, 3] = -view.target
    world.set_transform(T)
    world[CAMERA].set_property("fov", FIELD_OF_VIEW)
    world[CAMERA].set_property("position", y_up(view.position - view.target))


def y_up(p: Array) -> list[float]:
    """Return a point, shape (3,), in the coordinates of meshcat's camera, whose y axis is up."""
    return [float(p[0]), float(p[2]), float(-p[1])]


def _reach(scene: Scene, task: Task) -> Array:
    """Return the horizontal unit vector from the mounting to the object, shape (3,)."""
    reach = center_of_mass_world(scene.objects[task.object]) - np.array(scene.mounting.position)
    reach[2] = 0.0
    length = float(np.linalg.norm(reach))
    return reach / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])


def _view(target: Array, direction: Array, radius: float) -> View:
    """Return the view along -`direction` that a ball of `radius` around `target` fills from top to bottom."""
    distance = radius / math.sin(math.radians(FIELD_OF_VIEW / 2))
    return View(target + distance * direction / np.linalg.norm(direction), target)
