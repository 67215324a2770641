"""Moves of the object, and of what is in its way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...arrays import Array
from ...descriptions import Scene
from ...descriptions.bodies import Body
from ...descriptions.pose import Pose
from ...problem.overlaps import depth_in
from .variant import Change, Failure, Variant, place

LENGTHS = (0.08, 0.16, 0.04, 0.32, 0.02, 0.01, 0.005)
"""Sizes of moves of the object that are tried, m: those that help most often first, and what helps is made smaller."""
AWAY = (0.04, 0.16, 0.32)
"""Sizes of moves of what is in its way, growing, m."""
SHARE = 3.0
"""Of the time for moves of the object: they help most often, and have the most ways."""
NOWHERE = 1e-3
"""Length of a way that has no direction, m."""
NEAR = 0.15
"""From the object up to which a body may be in the way of the hand, m."""
BODIES, DIRECTIONS = 3, 4
"""Bodies in the way that are moved, at most, and directions of each."""


def object_moves(failure: Failure) -> Iterator[Change]:
    """Yield the moves of the object: to the pads of the nearest miss, along the axes, and towards the arm.

    Of the axes those come first that lead away from what is in the way.
    """
    name, center = failure.task.object, failure.target.pose.matrix[:3, 3]
    directions = [*_axes(_away(failure, center)), failure.base - center]
    if failure.nearest_miss is not None and "contact gap" in failure.kinds:
        pads = np.mean([contact.point for contact in failure.nearest_miss.contacts], axis=0)
        directions.insert(0, pads - _held_place(failure))
    yield replace(_moves("move object", "objects", name, failure.target, directions), sizes=LENGTHS, share=SHARE)


def obstacle_moves(failure: Failure) -> Iterator[Change]:
    """Yield the moves of each of the bodies in the way: along the axes, those away from the object first.

    Where it is not known what is in the way, it is what is nearest to the object.
    """
    around, center = failure.scene.bodies_besides(failure.task), failure.target.pose.matrix[:3, 3]
    named = [name for name in failure.bodies if name in around]
    gaps = {name: -depth_in(failure.target, body) for name, body in around.items()}
    near = sorted((name for name in gaps if gaps[name] <= NEAR), key=gaps.__getitem__)
    for name in list(dict.fromkeys([*named, *near]))[:BODIES]:
        obstacle = name in failure.scene.obstacles
        without = failure.scene.without_obstacle(name) if obstacle else _without_object(failure.scene, name)
        directions = _axes(around[name].pose.matrix[:3, 3] - center)[:DIRECTIONS]
        table = "obstacles" if obstacle else "objects"
        found = _moves("move obstacle", table, name, around[name], directions)
        yield replace(found, steady=True, without=without)


def _without_object(scene: Scene, name: str) -> Scene:
    """Return the scene without an object and the tasks that are about it."""
    for task, described in scene.tasks.items():
        if described.object == name:
            scene = scene.without_task(task)
    return scene.without_object(name)


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


def _moves(kind: str, table: str, name: str, body: Body, directions: Sequence[Array]) -> Change:
    """Return the moves of a body of a table of the scene along directions, but for those without a length."""
    lengths = [float(np.linalg.norm(direction)) for direction in directions]
    along = [way / length for way, length in zip(directions, lengths, strict=True) if length > NOWHERE]
    variants = tuple(_move((table, name, "pose"), name, body, direction) for direction in along)
    words = f"{name!r} moved along {len(along)} directions by up to"
    return Change(kind, "m", 1e-3, AWAY, variants, lambda size: f"{words} {1e3 * size:.0f} mm")


def _move(where: tuple[str, ...], name: str, body: Body, direction: Array) -> Variant:
    def changes(size: float) -> Mapping[str, Any]:
        T = body.pose.matrix.copy()
        T[:3, 3] += size * direction
        return {place(*where): Pose.of(T).model_dump(mode="json", exclude_none=True)}

    def text(size: float) -> str:
        return f"move {name!r} by {1e3 * size:.0f} mm along {_direction(direction)}"

    return Variant(changes, lambda size: size, text)


def _direction(direction: Array) -> str:
    axis = int(np.abs(direction).argmax())
    if abs(direction[axis]) > 1.0 - 1e-9:
        return f"{'+' if direction[axis] > 0 else '-'}{'xyz'[axis]}"
    return f"({', '.join(f'{x:.2f}' for x in direction)})"
