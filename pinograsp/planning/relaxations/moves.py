"""Moves of the object, and of what is in its way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...arrays import Array
from ...descriptions.pose import Pose
from ...descriptions.scene import Body
from .variant import Failure, Variant, place

LENGTHS = tuple(0.005 * 2.0**k for k in range(7))
"""Sizes of moves that are tried, m."""
NOWHERE = 1e-3
"""Length of a way that has no direction, m."""


def object_moves(failure: Failure) -> Iterator[Variant]:
    """Yield moves of the object: to the pads of the nearest miss, along the axes, and towards the arm.

    Of the axes those come first that lead away from what is in the way.
    """
    name, center = failure.task.object, failure.target.pose.matrix[:3, 3]
    directions = [*_axes(_away(failure, center)), failure.base - center]
    if failure.nearest_miss is not None and "contact gap" in failure.kinds:
        pads = np.mean([contact.point for contact in failure.nearest_miss.contacts], axis=0)
        directions.insert(0, pads - _held_place(failure))
    for direction in directions:
        length = float(np.linalg.norm(direction))
        if length > NOWHERE:
            yield _move("move object", ("objects", name, "pose"), name, failure.target, direction / length)


def obstacle_moves(failure: Failure) -> Iterator[Variant]:
    """Yield moves of the bodies that are in the way: along the axes, those away from the object first."""
    around, center = failure.scene.bodies_besides(failure.task), failure.target.pose.matrix[:3, 3]
    for name in [name for name in failure.bodies if name in around][:2]:
        table = "obstacles" if name in failure.scene.obstacles else "objects"
        for direction in _axes(around[name].pose.matrix[:3, 3] - center)[:4]:
            yield _move("move obstacle", (table, name, "pose"), name, around[name], direction)


def _axes(first: Array) -> list[Array]:
    """Return the directions along the axes, those nearest to a direction first."""
    axes = [sign * axis for axis in np.eye(3) for sign in (1.0, -1.0)]
    return sorted(axes, key=lambda axis: -float(axis @ first))


def _away(failure: Failure, center: Array) -> Array:
    """Return the direction from what is in the way to the object, world; upwards where nothing is."""
    around, walls = failure.scene.bodies_besides(failure.task), failure.scene.enclosure.walls
    for name in failure.bodies:
        if name in walls:
            return walls[name][0]
        if name in around:
            return np.asarray(center - around[name].pose.matrix[:3, 3])
    return -np.array(failure.scene.gravity)


def _held_place(failure: Failure) -> Array:
    """Return where the hand is wanted: between desired contacts, or at the origin of the object, world, m."""
    T, points = failure.target.pose.matrix, failure.task.desired_contacts
    return np.asarray(T[:3, 3] if points is None else T[:3, :3] @ np.mean(points, axis=0) + T[:3, 3])


def _move(kind: str, where: tuple[str, ...], name: str, body: Body, direction: Array) -> Variant:
    def changes(size: float) -> Mapping[str, Any]:
        T = body.pose.matrix.copy()
        T[:3, 3] += size * direction
        return {place(*where): Pose.of(T).model_dump(mode="json", exclude_none=True)}

    def text(size: float) -> str:
        return f"move {name!r} by {1e3 * size:.0f} mm along {_direction(direction)}"

    return Variant(kind, "m", 1e-3, changes, lambda size: size, text, LENGTHS)


def _direction(direction: Array) -> str:
    axis = int(np.abs(direction).argmax())
    if abs(direction[axis]) > 1.0 - 1e-9:
        return f"{'+' if direction[axis] > 0 else '-'}{'xyz'[axis]}"
    return f"({', '.join(f'{x:.2f}' for x in direction)})"
