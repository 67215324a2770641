"""The pairs of solids that are measured: of bodies that must keep apart.

What of a link is behind the surface of its pad is kept off a convex object by contact and tangency at the pad, and no
pair of theirs is measured: its distance is zero at every grasp with the gradient of the contact condition, and as one
more inequality would only make the problem degenerate. An object of several parts is not so simple: the pad touches one
of them, and what is behind its surface may run into another. These pairs are measured, with the pads and the part; who
uses them leaves out those of the part that a pad touches. An uneven object, a mesh, has no solids here and no pairs:
see `object_points`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, combinations, count, product
from typing import NamedTuple

import coal
import numpy as np

from ..arrays import Array, Indices
from ..geometry.patches import above
from ..kinematics.robot import Robot
from .world import CLEARANCES, Body, BodyKey, Role, Solid, World

FLUSH = 2e-5
"""How far a solid may stand out of a pad's surface and still count as behind it, m."""
PAD_MARGIN = -1e-5
"""Least distance of what is behind a pad to the parts of the object that the pad does not touch, m: parts may be flush
with each other."""
PAD_CLEARANCE = "pad clearance"


class PlacedSolid(NamedTuple):
    """A solid with its number and the body that it belongs to."""

    number: int
    body: Body
    solid: Solid
    parts: tuple[int, ...] = ()
    """Numbers of the solids that it is the hull of; none of a solid that is measured itself."""


class Pair(NamedTuple):
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
    pads: tuple[int, ...] = ()
    """Numbers of the pads that the first solid is behind; none but in a pad clearance."""
    part: int = 0
    """Part of the object that the second solid belongs to."""

    @property
    def name(self) -> str:
        """Both bodies in words."""
        return f"{self.link} - {self.other}"


@dataclass(frozen=True)
class LinkPairs:
    """The pairs of the links, without those of pad clearances, which are the last."""

    links: tuple[str, ...]
    link_of: Indices
    """Number of the link of every pair, shape (pairs,)."""
    counts: Indices
    """Pairs of every link, shape (links,)."""
    margins: Array
    """Least distance wanted of every pair, m, shape (pairs,)."""

    @classmethod
    def among(cls, pairs: Sequence[Pair]) -> LinkPairs:
        """Return those that are among the pairs of a world."""
        kept = [pair for pair in pairs if pair.kind != PAD_CLEARANCE]
        numbers = {link: number for number, link in enumerate(dict.fromkeys(pair.link for pair in kept))}
        link_of = np.array([numbers[pair.link] for pair in kept], dtype=np.intp)
        counts = np.bincount(link_of, minlength=len(numbers))
        return cls(tuple(numbers), link_of, counts, np.array([pair.margin for pair in kept]))


@dataclass(frozen=True)
class PadPairs:
    """The pairs of pad clearances."""

    pairs: Mapping[int, Pair]
    """With their numbers among all pairs."""
    groups: Mapping[tuple[str, int], int]
    """Numbers of the links with the parts of the object that they make pairs with."""

    @classmethod
    def among(cls, pairs: Sequence[Pair]) -> PadPairs:
        """Return those that are among the pairs of a world."""
        kept = {number: pair for number, pair in enumerate(pairs) if pair.kind == PAD_CLEARANCE}
        groups = dict.fromkeys((pair.link, pair.part) for pair in kept.values())
        return cls(kept, {group: number for number, group in enumerate(groups)})


def pairs_of(robot: Robot, world: World) -> tuple[list[PlacedSolid], tuple[Pair, ...]]:
    """Return the solids of a world that are measured, and their pairs by number, those with walls first.

    Walls are measured against whole hulls: a half-space is as far from them as from the nearest piece.
    """
    numbers = count()
    carried, around = world.of("link", "held"), world.of("wall", "obstacle", "target")
    fine = [PlacedSolid(next(numbers), body, solid) for body in carried for solid in body.solids]
    own: dict[BodyKey, list[int]] = {}
    for placed in fine:
        own.setdefault(placed.body.key, []).append(placed.number)
    hulls = [
        PlacedSolid(next(numbers), body, hull.solid, tuple(own[body.key][part] for part in hull.parts))
        for body in carried
        for hull in body.hulls
    ]
    others = [PlacedSolid(next(numbers), body, solid) for body in around for solid in body.solids]

    def to(role: Role) -> list[PlacedSolid]:
        return [placed for placed in others if placed.body.role == role]

    pads = {placed.number: pads_before(robot, placed) for placed in fine}
    free = [placed for placed in fine if not pads[placed.number]]
    behind = [placed for placed in fine if pads[placed.number]]
    of_parts = [placed for placed in to("target") if len({solid.part for solid in placed.body.solids}) > 1]

    candidates = chain(
        product(hulls, to("wall")), product(fine, to("obstacle")), product(free, to("target")), combinations(fine, 2)
    )
    pressed = (
        pair._replace(kind=PAD_CLEARANCE, margin=PAD_MARGIN, pads=pads[pair.first], part=second.solid.part)
        for first, second in product(behind, of_parts)
        for pair in _kept_apart(robot, world, [(first, second)])
    )
    return [*fine, *hulls, *others], (*_kept_apart(robot, world, candidates), *pressed)


def _kept_apart(robot: Robot, world: World, candidates: Iterable[tuple[PlacedSolid, PlacedSolid]]) -> Iterable[Pair]:
    """Return the pairs of solids whose bodies must keep apart."""
    apart: dict[tuple[int, int], tuple[str, str, str, float] | None] = {}
    for first, second in candidates:
        bodies = id(first.body), id(second.body)
        if bodies not in apart:
            apart[bodies] = _said(world, first.body, second.body, robot)
        said = apart[bodies]
        if said is not None:
            kind, link, other, margin = said
            yield Pair(kind, link, other, first.number, second.number, margin)


def _said(world: World, first: Body, second: Body, robot: Robot) -> tuple[str, str, str, float] | None:
    """Return kind, link, other body and margin of the pairs of two bodies, or None if they may touch."""
    if not world.keep_apart(first, second, robot.supports):
        return None
    link, other, role = first.name, second.name, second.role
    if role in {"link", "held"}:  # the outer one comes later
        link, other = other, link
    return CLEARANCES[role], link, other, world.margins[role]


def pads_before(robot: Robot, placed: PlacedSolid) -> tuple[int, ...]:
    """Return the pads whose surface bounds a link, or this solid of it: as their rubber, or as what backs that."""
    shape, T = placed.solid.shape, placed.body.pose @ placed.solid.placement
    if isinstance(shape, coal.Sphere):
        points, around = T[None, :3, 3], float(shape.radius)
    elif isinstance(shape, coal.ConvexBase):
        points, around = np.array(shape.points()) @ T[:3, :3].T + T[:3, 3], 0.0
    else:
        return ()
    return tuple(
        number
        for number, pad in enumerate(robot.pads)
        if pad.joint == placed.body.joint
        and pad.description.link == placed.body.name
        and float(above(pad.patch, (points - pad.translation) @ pad.rotation).max()) + around < FLUSH
    )
