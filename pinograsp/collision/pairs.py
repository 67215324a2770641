"""The pairs of solids that are measured: of bodies that must keep apart."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations, count, product
from typing import NamedTuple

import coal
import numpy as np

from ..geometry.patches import above
from ..kinematics.robot import Robot
from .world import CLEARANCES, Body, BodyKey, Role, Solid, World

FLUSH = 2e-5
"""How far a solid may stand out of a pad's surface and still count as behind it, m."""


class PlacedSolid(NamedTuple):
    """A solid with its number and the body that it belongs to."""

    number: int
    body: Body
    solid: Solid


@dataclass(frozen=True)
class Pair:
    """Two solids that must keep apart."""

    kind: str
    """Name of the clearance, as in a certificate."""
    link: str
    """The robot's link; in a self pair the outer one."""
    other: str
    """The body that it must keep clear of: a wall, an obstacle, the object or a link."""
    first: int
    """Number of the first solid."""
    second: int
    margin: float
    """Least distance wanted, m."""

    @property
    def name(self) -> str:
        """Both bodies in words."""
        return f"{self.link} - {self.other}"


def pairs_of(robot: Robot, world: World) -> tuple[list[PlacedSolid], tuple[Pair, ...]]:
    """Return the solids of a world that are measured, and their pairs by number, those with walls first.

    Walls are measured against whole hulls: a half-space is as far from them as from the nearest piece.
    """
    numbers = count()
    carried, around = world.of("link", "held"), world.of("wall", "obstacle", "target")
    fine = [PlacedSolid(next(numbers), body, solid) for body in carried for solid in body.solids]
    hulls = [PlacedSolid(next(numbers), body, hull.solid) for body in carried for hull in body.hulls]
    others = [PlacedSolid(next(numbers), body, solid) for body in around for solid in body.solids]
    free = [placed for placed in fine if not _behind_its_pad(robot, placed)]

    def to(role: Role) -> list[PlacedSolid]:
        return [placed for placed in others if placed.body.role == role]

    candidates = [
        *product(hulls, to("wall")),
        *product(fine, to("obstacle")),
        *product(free, to("target")),
        *combinations(fine, 2),
    ]
    return [*fine, *hulls, *others], tuple(_kept_apart(robot, world, candidates))


def _kept_apart(robot: Robot, world: World, candidates: Iterable[tuple[PlacedSolid, PlacedSolid]]) -> Iterable[Pair]:
    """Return the pairs of solids whose bodies must keep apart."""
    apart: dict[tuple[BodyKey, BodyKey], bool] = {}
    for first, second in candidates:
        bodies = first.body.key, second.body.key
        if bodies not in apart:
            apart[bodies] = world.keep_apart(first.body, second.body, robot.supports)
        if apart[bodies]:
            role = second.body.role
            link, other = first.body.name, second.body.name
            if role in {"link", "held"}:  # the outer one comes later
                link, other = other, link
            yield Pair(CLEARANCES[role], link, other, first.number, second.number, world.margins[role])


def _behind_its_pad(robot: Robot, placed: PlacedSolid) -> bool:
    """Return whether the surface of a pad bounds a link, or this solid of it: as its rubber, or as what backs that.

    Then contact and tangency at the pad already keep the solid off a convex object. Its distance to the
    object is zero at every grasp with the gradient of the contact condition: as one more inequality it
    would only make the problem degenerate. What stands out beside the pad keeps its margin from the object.
    """
    shape, T = placed.solid.shape, placed.body.pose @ placed.solid.placement
    if isinstance(shape, coal.Sphere):
        points, around = T[None, :3, 3], float(shape.radius)
    elif isinstance(shape, coal.ConvexBase):
        points, around = np.array(shape.points()) @ T[:3, :3].T + T[:3, 3], 0.0
    else:
        return False
    return any(
        pad.joint == placed.body.joint
        and pad.description.link == placed.body.name
        and float(above(pad.patch, (points - pad.translation) @ pad.rotation).max()) + around < FLUSH
        for pad in robot.pads
    )
