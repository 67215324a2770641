"""Check that the object can be touched where contact may be, on points spread over its surface."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Mask
from ..errors import TaskError
from ..geometry.shapes import surface_of
from ..kinematics.hand_posture import always_parallel
from ..kinematics.reach import arm_reach
from .task_model import TaskModel

POINTS = 4000
"""Points on the surface that are looked at."""
ROOM = 1e-3
"""How far off the surface there must be free space, m."""
YIELD = 0.002
"""How much nearer than its margin to a wall a contact point may be, m: a pad lies up to so far off its link."""
OPPOSITE = 0.8
"""Cosine from which on two normals count as opposite."""
BELOW = 2e-4
"""How far below the surface normals are compared with those on it, m."""
SOME = 400
"""Normals to which an opposite one is looked for, at least."""


def check_region(model: TaskModel) -> list[str]:
    """Refuse an object that nothing can touch where contact may be; return what is odd about its region, in words.

    Raises:
        TaskError: no point of the surface is in the contact region; every such point is nearer to a wall, an obstacle
            or another object than a pad may be, or beyond the arm's reach; or pads that are parallel find no two
            opposite ones.
    """
    file, name = model.scene.source, model.task.object
    key, part = f"objects.{name}.pose", f"the surface of {name!r}"
    points, normals = _surface_points(model)
    if model.region is not None:
        key = f"tasks.{model.task_name}.{'allowed' if model.task.allowed_contacts else 'forbidden'}_contacts"
        part, inside = "this region", model.region(points)[0] >= 0.0
        if not inside.any():
            raise TaskError(
                f"no point of the surface of {name!r} is left for a contact",
                file=file,
                key=key,
                remedy="Widen the region; coordinates are in the object's frame, in metres and radians",
            )
        points, normals = points[inside], normals[inside]
    R, origin = model.T_world_object[:3, :3], model.T_world_object[:3, 3]
    world, outward = points @ R.T + origin, normals @ R.T
    rooms, margin = _rooms(model, world + ROOM * outward), model.task.margin.enclosure
    free, lacking = rooms > max(0.0, margin - YIELD), f"pads keep {1e3 * margin:g} mm from walls and other bodies"
    remedy = "Move the object, or give a smaller `margin.enclosure`"
    if not free.any():
        nearest = "against a wall, an obstacle or another object"
        if rooms.max() > 0.0:
            nearest = f"within {1e3 * float(rooms.max()):.1f} mm of a wall, an obstacle or another object ({lacking})"
        raise TaskError(f"no pad can get there: all of {part} is {nearest}", file=file, key=key, remedy=remedy)
    flat = _off_edges(model, points, normals)
    if always_parallel(model.robot) and not _opposite(outward[free & flat]) and _opposite(outward[flat]):
        raise TaskError(
            f"no two pads can get there: of {part} no opposite faces are far enough from other things; {lacking}",
            file=file,
            key=key,
            remedy=remedy,
        )
    base, reach = arm_reach(model.robot)
    apart = np.linalg.norm(world[free] - base, axis=1)
    if apart.min() > reach:
        raise TaskError(
            f"no pad can get there: {part} is {apart.min():.2f} m from the first arm joint, "
            f"and the pads reach {reach:.2f} m at most",
            file=file,
            key=key,
            remedy=f"Move the object by {math.ceil(100.0 * (apart.min() - reach)) / 100:.2f} m or more towards the arm",
        )
    if model.region is None:
        return []
    values = model.region((model.desired_points - origin) @ R)[0]
    return [
        f"desired_contacts[{i}] is outside the contact region by {-1e3 * value:.1f} mm; contacts will keep off it"
        for i, value in enumerate(values)
        if value < 0.0
    ]


def _off_edges(model: TaskModel, points: Array, normals: Array) -> Mask:
    """Return which points of the surface, object frame, are not on an edge, where the normal could be any."""
    below = model.surface.signed_distance(points - BELOW * normals)[1]
    return np.asarray((below * normals).sum(axis=1) > OPPOSITE)


def _opposite(normals: Array) -> bool:
    """Whether some of the normals, shape (n, 3), are opposite to each other, or nearly so."""
    return bool(len(normals)) and bool((normals @ normals[:: max(1, len(normals) // SOME)].T).min() < -OPPOSITE)


def _surface_points(model: TaskModel) -> tuple[Array, Array]:
    """Return points spread over the object's surface and the outward normals there, object frame, both (n, 3).

    Random points in a ball around the object are moved to the surface along the gradient of the signed distance.
    """
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(POINTS, 3))
    points = directions / np.linalg.norm(directions, axis=1)[:, None] * model.surface.radius
    points *= rng.uniform(0.3, 1.2, size=(POINTS, 1))
    for _ in range(3):
        distances, normals, _ = model.surface.signed_distance(points)
        points = points - distances[:, None] * normals
    return points, model.surface.signed_distance(points)[1]


def _rooms(model: TaskModel, points: Array) -> Array:
    """Return how far world points are inside the enclosure and off obstacles and other objects, m, shape (n,).

    Distances that are above what a pad keeps need not be exact.
    """
    rooms = np.full(len(points), np.inf)
    for inward, offset in model.scene.enclosure.walls.values():
        rooms = np.minimum(rooms, points @ inward - offset)
    for body in model.scene.bodies_besides(model.task).values():
        surface, T = surface_of(body.shape), body.pose.matrix
        balls = np.linalg.norm(points - T[:3, 3], axis=1) - surface.radius
        near = balls < max(ROOM, model.task.margin.enclosure)
        rooms[~near] = np.minimum(rooms[~near], balls[~near])
        if near.any():
            local = (points[near] - T[:3, 3]) @ T[:3, :3]
            rooms[near] = np.minimum(rooms[near], surface.signed_distance(local)[0])
    return rooms
