"""Check that a contact region can be touched at all, on points spread over the object's surface."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Mask
from ..errors import TaskError
from ..geometry.shapes import surface_of
from ..kinematics.reach import arm_reach
from .task_model import TaskModel

POINTS = 4000
"""Points on the surface that are looked at."""
ROOM = 1e-3
"""How far off the surface there must be free space, m."""


def check_region(model: TaskModel) -> list[str]:
    """Refuse a contact region that nothing can touch; return what is odd about it, in words.

    Raises:
        TaskError: no point of the surface is in the region, or every such point is covered by a wall, an obstacle
            or another object, or is beyond the arm's reach.
    """
    if model.region is None:
        return []
    key = f"tasks.{model.task_name}.{'allowed' if model.task.allowed_contacts else 'forbidden'}_contacts"
    file = model.scene.source
    points, normals = _surface_points(model)
    inside = model.region(points)[0] >= 0.0
    if not inside.any():
        raise TaskError(
            f"no point of the surface of {model.task.object!r} is left for a contact",
            file=file,
            key=key,
            remedy="Widen the region; coordinates are in the object's frame, in metres and radians",
        )
    R, origin = model.T_world_object[:3, :3], model.T_world_object[:3, 3]
    world, outward = points[inside] @ R.T + origin, normals[inside] @ R.T
    free = _uncovered(model, world + ROOM * outward)
    if not free.any():
        raise TaskError(
            "no pad can get there: all of this region is against a wall, an obstacle or another object",
            file=file,
            key=key,
        )
    base, reach = arm_reach(model.robot)
    apart = np.linalg.norm(world[free] - base, axis=1)
    if apart.min() > reach:
        raise TaskError(
            f"no pad can get there: this region is {apart.min():.2f} m from the first arm joint, "
            f"and the pads reach {reach:.2f} m at most",
            file=file,
            key=key,
        )
    values = model.region((model.desired_points - origin) @ R)[0]
    return [
        f"desired contact {i} is outside the contact region by {-1e3 * value:.1f} mm; contacts will keep off it"
        for i, value in enumerate(values)
        if value < 0.0
    ]


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


def _uncovered(model: TaskModel, points: Array) -> Mask:
    """Return which world points are inside the enclosure and in no obstacle or other object."""
    free = np.ones(len(points), dtype=bool)
    for inward, offset in model.scene.enclosure.walls.values():
        free &= points @ inward > offset
    for body in model.scene.bodies_besides(model.task).values():
        T = body.pose.matrix
        free &= surface_of(body.shape).signed_distance((points - T[:3, 3]) @ T[:3, :3])[0] > 0.0
    return free
