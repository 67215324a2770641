"""Remark on an object that stands on nothing, though something is close below it.

It is made where the load is the object's weight: what gravity acts on rests on something until it is grasped, and a gap
says that its pose is wrong. A task that gives a wrench says itself what acts on its object, which may hang in the air:
the paper's do by definition.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..arrays import Array
from ..descriptions.bodies import Body
from ..descriptions.pose import Pose
from ..geometry.shapes import surface_of
from .overlaps import depth_in
from .task_model import TaskModel

TOUCHING = 0.005
"""Gap up to which nothing is said, m: as much is left on purpose."""
CLOSE = 0.05
"""Height below which an object was meant to stand, m; one that hangs higher is held by what the scene leaves out."""
STEP = 0.00005
"""To which a height is found, m."""


def check_standing(model: TaskModel) -> list[str]:
    """Return the remark, in words, that the object stands on nothing, though something is close below it."""
    scene, name = model.scene, model.task.object
    gravity = np.array(scene.gravity)
    if model.task.wrench is not None or not gravity.any():
        return []
    target, gaps = scene.objects[name], _gaps(model, scene.objects[name])
    if min(gaps.values()) <= TOUCHING:
        return []
    low, high = 0.0, CLOSE
    fallen = _gaps(model, _moved(target, high * gravity / np.linalg.norm(gravity)))
    floor = min(fallen, key=fallen.__getitem__)
    if fallen[floor] > 0.0:
        return []
    while high - low > STEP:
        middle = 0.5 * (low + high)
        fallen = _gaps(model, _moved(target, middle * gravity / np.linalg.norm(gravity)))
        nearest = min(fallen, key=fallen.__getitem__)
        low, high, floor = (low, middle, nearest) if fallen[nearest] <= 0.0 else (middle, high, floor)
    return [f"{name!r} stands on nothing: it is {1e3 * high:.1f} mm above {floor!r}"]


def _moved(body: Body, by: Array) -> Body:
    T = body.pose.matrix.copy()
    T[:3, 3] += by
    return body.model_copy(update={"pose": Pose.of(T)})


def _gaps(model: TaskModel, target: Body) -> Mapping[str, float]:
    """Return how far a body is from walls, obstacles and other objects, m; those beyond `CLOSE` need not be exact."""
    T, surface = target.pose.matrix, surface_of(target.shape)
    walls = {
        name: float(inward @ T[:3, 3]) - offset - surface.extent(-T[:3, :3].T @ inward)
        for name, (inward, offset) in model.scene.enclosure.walls.items()
    }
    return walls | {name: -depth_in(target, body) for name, body in model.scene.bodies_besides(model.task).items()}
