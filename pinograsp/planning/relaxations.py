"""Changes of a scene that may make a task work: one function for each kind, registered in `RELAXATIONS`.

A kind has variants (directions, margins), and each variant a size, which grows from nothing. `remedies` looks for the
least size at which the task works.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions import Scene, Task
from ..descriptions.pose import Pose
from ..descriptions.regions import AllOf, AnyOf, Ball, Band, Cuboid, HalfSpace, Near, Outside, Region
from ..descriptions.scene import Body
from ..descriptions.shapes import Box, Capsule, Cylinder, Sphere
from ..errors import InputError
from ..geometry.shapes import surface_of
from ..results import Grasp

LENGTHS = tuple(0.005 * 2.0**k for k in range(7))
"""Sizes of moves that are tried, m."""
NOWHERE = 1e-3
"""Length of a way that has no direction, m."""
SMALL = (0.001, 0.002, 0.004, 0.008, 0.016, 0.032)
"""Sizes of jaws and regions that are tried, m."""
LIGHTER = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
"""By how many parts of what is left the load is reduced: 1.0 leaves the half."""
DIGITS = 3
"""Of the load that is left."""


@dataclass(frozen=True)
class Failure:
    """What is to be mended."""

    scene: Scene
    task_name: str
    base: Array
    """Origin of the first arm joint, world, m, shape (3,)."""
    bodies: tuple[str, ...]
    """Bodies that are in the way, the most frequent first."""
    kinds: tuple[str, ...]
    """Constraints that are violated, the most frequent first; keys of the scene that a refusal names."""
    nearest_miss: Grasp | None = None
    """The posture that came nearest to a grasp."""

    @property
    def task(self) -> Task:
        """The task."""
        return self.scene.task(self.task_name)

    @property
    def target(self) -> Body:
        """The task's object."""
        return self.scene.objects[self.task.object]


@dataclass(frozen=True)
class Variant:
    """A change of one kind that has a size."""

    kind: str
    unit: str
    step: float
    """To which sizes are rounded up."""
    changes: Callable[[float], Mapping[str, Any]]
    """Of a size: new values by place in the scene; an `InputError` where there is no such change."""
    amount: Callable[[float], float]
    """Of a size, as it is reported."""
    text: Callable[[float], str]
    """Of a size."""
    sizes: tuple[float, ...]
    """That are tried, one after the other."""


def place(*keys: str) -> str:
    """Return the place of a value in a scene, as `Remedy.changes` has it."""
    return json.dumps(list(keys))


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


def margins(failure: Failure) -> Iterator[Variant]:
    """Yield smaller margins: those that are violated."""
    of = {"enclosure clearance": "enclosure", "obstacle clearance": "enclosure", "objects.pose": "enclosure"}
    of |= {"self clearance": "robot", "object clearance": "object", "pad clearance": "object"}
    given = failure.task.margin
    for key in dict.fromkeys(of[kind] for kind in failure.kinds if kind in of):
        had = float(getattr(given, key))
        if had > 0.0:
            yield _margin(failure, key, had)


def weights(failure: Failure) -> Iterator[Variant]:
    """Yield smaller loads: the mass of the object, or the task's wrench."""
    task, wrench = failure.task, failure.scene.wrench_of(failure.task)
    had = float(np.linalg.norm(wrench.force))
    if had == 0.0:
        return

    def left(size: float) -> float:
        number = had / (1.0 + size)
        unit = 10.0 ** (math.floor(math.log10(number)) - DIGITS + 1)
        return math.floor(number / unit) * unit

    def changes(size: float) -> Mapping[str, Any]:
        share = left(size) / had
        if task.wrench is None:
            mass = failure.scene.objects[task.object].mass or 0.0
            return {place("objects", task.object, "mass"): share * mass}
        parts = {"force": [share * f for f in wrench.force], "torque": [share * t for t in wrench.torque]}
        return {place("tasks", failure.task_name, "wrench"): parts}

    def text(size: float) -> str:
        return f"a load of {left(size):.3g} N instead of {had:.3g} N"

    yield Variant("weight", "N", 1e-3, changes, left, text, LIGHTER)


def jaws(failure: Failure) -> Iterator[Variant]:
    """Yield wider jaws, as an object that is so much narrower between its desired contacts."""
    task, body = failure.task, failure.target
    points = np.array(task.desired_contacts or ()).reshape(-1, 3)
    if len(points) not in (0, 2):
        return
    normals = surface_of(body.shape).signed_distance(points)[1]

    def changes(size: float) -> Mapping[str, Any]:
        shape = _narrower(body, normals, size)
        moved = points - 0.5 * size * normals
        found: dict[str, Any] = {place("objects", task.object, "shape"): shape}
        if len(points):
            found[place("tasks", failure.task_name, "desired_contacts")] = moved.tolist()
        return found

    def text(size: float) -> str:
        return f"a jaw that opens {1e3 * size:.1f} mm wider, or {task.object!r} narrower by as much"

    yield Variant("jaw", "m", 1e-4, changes, lambda size: size, text, SMALL)


def regions(failure: Failure) -> Iterator[Variant]:
    """Yield larger regions of contact: what is allowed grows, what is forbidden shrinks."""
    task = failure.task
    if task.contact_region is None:
        return

    def changes(size: float) -> Mapping[str, Any]:
        found = {}
        for key, by in (("allowed_contacts", size), ("forbidden_contacts", -size)):
            region = getattr(task, key)
            if region is not None:
                found[place("tasks", failure.task_name, key)] = grown(region, by).model_dump(mode="json")
        return found

    def text(size: float) -> str:
        return f"a contact region that is {1e3 * size:.1f} mm larger on every side"

    yield Variant("region", "m", 1e-4, changes, lambda size: size, text, SMALL)


RELAXATIONS: tuple[tuple[Callable[[Failure], Iterator[Variant]], frozenset[str]], ...] = (
    (weights, frozenset({"friction", "force limit", "normal force", "force balance", "torque balance", "withstand"})),
    (weights, frozenset({"tasks.wrench", "objects.mass"})),
    (regions, frozenset({"contact region", "surface edge", "pad rim", "tasks.allowed_contacts"})),
    (regions, frozenset({"tasks.forbidden_contacts"})),
    (jaws, frozenset({"objects.shape", "contact gap", "pad tangency", "pad clearance", "object clearance"})),
    (obstacle_moves, frozenset({"obstacle clearance", "objects.pose"})),
    (margins, frozenset({"enclosure clearance", "obstacle clearance", "self clearance", "object clearance"})),
    (margins, frozenset({"pad clearance", "objects.pose"})),
)
"""Kinds of changes, each with the constraints that it loosens, or the keys of refusals that it answers.

Moves of the object are tried for all of them."""


def suitable(failure: Failure) -> list[list[Variant]]:
    """Return the variants of every kind of change that may help, the most promising kind first."""
    makers = [maker for kind in failure.kinds for maker, loosens in RELAXATIONS if kind in loosens]
    return [list(maker(failure)) for maker in dict.fromkeys([*makers, object_moves])]


def grown(region: Region, by: float) -> Region:
    """Return a region that reaches farther on every side, or less far, m.

    Raises:
        InputError: nothing is left of it, or a part has no size that could be grown.
    """
    match region:
        case AllOf() | AnyOf():
            return region.model_copy(update={"parts": tuple(grown(part, by) for part in region.parts)})
        case Outside():
            return Outside(part=grown(region.part, -by))
        case Ball() | Near():
            return region.model_copy(update={"radius": region.radius + by})
        case Band():
            return Band(z=(region.z[0] - by, region.z[1] + by))
        case HalfSpace():
            return region.model_copy(update={"offset": region.offset - by})
        case Cuboid():
            low, high = (np.array(corner) for corner in (region.min, region.max))
            return Cuboid(min=tuple((low - by).tolist()), max=tuple((high + by).tolist()))
    raise InputError(f"a region of type {region.type} has no size that grows")


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


def _margin(failure: Failure, key: str, had: float) -> Variant:
    def left(size: float) -> float:
        return max(0.0, round(had - size, 9))

    def changes(size: float) -> Mapping[str, Any]:
        margin = failure.task.margin.model_dump(mode="json")
        return {place("tasks", failure.task_name, "margin"): {**margin, key: left(size)}}

    def text(size: float) -> str:
        return f"a margin.{key} of {1e3 * left(size):.1f} mm instead of {1e3 * had:.1f} mm"

    return Variant("margin", "m", 1e-4, changes, lambda size: had - left(size), text, (0.25 * had, 0.5 * had, had))


def _narrower(body: Body, normals: Array, size: float) -> Mapping[str, Any]:
    """Return the shape of a body that is narrower across the normals, or where it is narrowest, as JSON data.

    Raises:
        InputError: there is no such shape.
    """
    shape = body.shape
    match shape:
        case Sphere() | Cylinder() | Capsule():
            changed: Mapping[str, Any] = {"radius": shape.radius - 0.5 * size}
        case Box():
            axis = int(np.abs(normals[0]).argmax()) if len(normals) else int(np.argmin(shape.size))
            changed = {"size": tuple(s - size * (i == axis) for i, s in enumerate(shape.size))}
        case _:
            raise InputError(f"a shape of type {shape.type} is not made narrower")
    return shape.model_copy(update=changed).model_dump(mode="json", exclude_none=True)
