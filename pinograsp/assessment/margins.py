"""The guaranteed margin of each kind of error: how large it may be, alone, before the grasp fails.

    position          along the axes of the first pad's frame, both ways, and along the diagonals between three
    orientation       rotations about these axes, both ways, through the origin of the object's frame
    joint             every arm joint alone, both ways
    center of mass    the axes of the object's frame, both ways
    friction          the least coefficient
    weight            the largest factor of the task's wrench

What "guaranteed" means. Of positions, orientations and joints: the grasp holds at this size in all directions listed,
to 2 %. Between the directions nothing is tested, and that it holds at every smaller size, too, is assumed: size after
size is halved, as if a direction that fails at one size failed at every larger one. Of friction, weight and centre of
mass it is proven for the contacts as they are: what friction balances more of it balances too, and the wrenches that
contacts balance are a convex set, so that every factor between 1 and the largest one holds, and every centre of mass
within the octahedron of the six points. Margins of several kinds do not add up: that is what the samples are for.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TypeVar

import numpy as np

from .judge import Judge
from .outcome import Margin
from .verdict import SLIPS, Verdict

TOLERANCE = 0.02
"""Of positions, orientations and joints, in parts of the size."""
EXACT = 1e-3
"""Of friction, in parts of the coefficient."""
SMALLEST = 1e-4
"""In parts of the largest size looked at; what is below counts as nothing."""
FARTHEST, STEEPEST, JOINT = 0.05, 0.5, 0.1
"""Largest position, m, orientation, rad, and joint error, rad (m), that is looked at."""
HEAVIEST = 100.0
"""Largest factor of the weight that is looked at."""

Vector = tuple[float, float, float]
AXES: tuple[Vector, ...] = ((1.0, 0, 0), (-1.0, 0, 0), (0, 1.0, 0), (0, -1.0, 0), (0, 0, 1.0), (0, 0, -1.0))
Direction = TypeVar("Direction")


def margin_of(judge: Judge, kind: str) -> Margin:
    """Return the margin of one of `KINDS`; the grasp must hold without errors."""
    return KINDS[kind](judge)


def _position(judge: Judge) -> Margin:
    axes = judge.closing.planned.rotations[0].T
    base = judge.no_errors
    directions: list[Vector] = [*AXES, *((x, y, z) for x, y, z in itertools.product((1.0, -1.0), repeat=3))]

    def verdict(size: float, direction: Vector) -> Verdict:
        unit = np.array(direction) / np.linalg.norm(direction)
        return judge.verdict(replace(base, position=size * unit @ axes))

    return _tested("position", "m", FARTHEST, {_name(d): d for d in directions}, verdict)


def _orientation(judge: Judge) -> Margin:
    axes, base = judge.closing.planned.rotations[0].T, judge.no_errors

    def verdict(size: float, direction: Vector) -> Verdict:
        return judge.verdict(replace(base, orientation=size * np.array(direction) @ axes))

    return _tested("orientation", "rad", STEEPEST, {_name(d): d for d in AXES}, verdict)


def _joint(judge: Judge) -> Margin:
    names, base = judge.setup.robot.arm.joints, judge.no_errors
    signed = {f"{s}{name}": (i, float(f"{s}1")) for i, name in enumerate(names) for s in "+-"}

    def verdict(size: float, which: tuple[int, float]) -> Verdict:
        joint, sign = which
        joints = np.zeros(len(names))
        joints[joint] = sign * size
        return judge.verdict(replace(base, joints=joints))

    return _tested("joint", "rad", JOINT, signed, verdict)


def _center_of_mass(judge: Judge) -> Margin:
    load, size = judge.wrench, judge.closing.size
    axes = np.array(AXES) @ judge.T_world_object[:3, :3].T
    torques = np.cross(axes, load[:3])
    directions = np.column_stack([np.zeros((6, 3)), torques])
    felt = np.linalg.norm(torques, axis=1) > 1e-9 * np.linalg.norm(load[:3])
    most = np.full(6, size)
    if felt.any():
        most[felt] = np.minimum(judge.growth(directions[felt]), size)
    worst = int(most.argmin())
    capped = bool(most[worst] >= size)
    return Margin(
        "center of mass", float(most[worst]), "m", *(("", "") if capped else (_name(AXES[worst]), SLIPS)), capped
    )


def _friction(judge: Judge) -> Margin:
    base, task = judge.no_errors, judge.task.contact.friction

    def enough(friction: float) -> bool:
        return judge.balances(replace(base, friction=friction))

    if enough(0.0):
        return Margin("friction", 0.0, "", "", "", True)
    low, high = 0.0, task
    while high - low > EXACT * high and high > SMALLEST * task:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if enough(middle) else (middle, high)
    return Margin("friction", high, "", "", SLIPS, False)


def _weight(judge: Judge) -> Margin:
    load = judge.wrench
    if not load.any():
        return Margin("weight", HEAVIEST, "", "", "", True)
    more = float(judge.growth(load[None])[0])
    capped = 1.0 + more >= HEAVIEST
    return Margin("weight", min(1.0 + more, HEAVIEST), "", "", "" if capped else SLIPS, capped)


KINDS: dict[str, Callable[[Judge], Margin]] = {
    "position": _position,
    "orientation": _orientation,
    "friction": _friction,
    "weight": _weight,
    "center of mass": _center_of_mass,
    "joint": _joint,
}
"""How the margin of each kind of error is found."""


def _tested(
    kind: str,
    unit: str,
    most: float,
    directions: Mapping[str, Direction],
    verdict: Callable[[float, Direction], Verdict],
) -> Margin:
    """Return the largest size at which no direction fails, by bisection.

    Args:
        kind: of the error.
        unit: of its size.
        most: largest size that is looked at.
        directions: by name.
        verdict: of the grasp at a size in a direction.
    """
    order = list(directions)

    def failure(size: float) -> tuple[str, Verdict] | None:
        for name in order:
            found = verdict(size, directions[name])
            if not found.holds:
                # The direction that failed last is likely to fail again.
                order.remove(name)
                order.insert(0, name)
                return name, found
        return None

    ends = failure(most)
    if ends is None:
        return Margin(kind, most, unit, "", "", True)
    low, high = 0.0, most
    while high - low > TOLERANCE * low and high > SMALLEST * most:
        middle = 0.5 * (low + high)
        failing = failure(middle)
        if failing is None:
            low = middle
        else:
            high, ends = middle, failing
    where, found = ends
    return Margin(kind, low, unit, where, found.reason, False)


def _name(direction: Vector) -> str:
    """Return a direction as +x-y+z."""
    letters = zip(direction, "xyz", strict=True)
    return "".join(f"{'+' if part > 0.0 else '-'}{letter}" for part, letter in letters if part != 0.0)
