"""Allowed pairs of links where no SRDF says so, found on the original meshes.

Written apart from `collision.allowed_pairs`, which looks at the optimiser's convex pieces: what a certificate need not
show is decided by what it measures.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from ..descriptions.hand import HandDescription
from ..descriptions.robot import ArmDescription
from .clearance import LinkPair, Placed, mesh_distance
from .joints import Limits
from .kinematics import Kinematics
from .synergies import Synergies

POSTURES = 300
HAND_POSTURES = 60
_TOUCHING = 1e-6
"""Meshes nearer than this touch, m."""

Links = frozenset[str]


@dataclass(frozen=True)
class Sampling:
    """The postures that are tried: of arm and hand, the same every time; other joints stay at rest."""

    kinematics: Kinematics
    arm: ArmDescription
    hand: HandDescription
    synergies: Synergies
    limits: Limits
    """Of the joints, rad (m); a joint without limits makes one turn."""

    def placed(self, pairs: Sequence[LinkPair], count: int) -> Iterator[Placed]:
        """Yield the meshes of the pairs in random postures."""
        meshes = {mesh.link: mesh for pair in pairs for mesh in pair}
        for angles in islice(self._postures(), count):
            yield Placed(meshes, self.kinematics.poses(angles))

    def in_hand(self, pair: LinkPair) -> bool:
        """Whether nothing but the hand's joints moves two links against each other."""
        return self.kinematics.moved_by(*(mesh.link for mesh in pair)) <= self.hand.joints

    def _postures(self) -> Iterator[dict[str, float]]:
        rng = np.random.default_rng(1)
        limits = self.limits | self.synergies.limits(self.limits)
        names = [*self.arm.joints, *self.synergies.names]
        while True:
            drawn = {name: rng.uniform(*limits.get(name, (-math.pi, math.pi))) for name in names}
            yield self.kinematics.followed(drawn | self.synergies.angles(drawn))


def sorted_out(pairs: Sequence[LinkPair], sampling: Sampling, margin: float) -> tuple[list[LinkPair], list[LinkPair]]:
    """Return the pairs that must keep the margin and those that must not touch, of pairs that no joint joins.

    The rest may do either: pairs that are nearer than the margin in every posture, and touch in some: a pin in its eye
    touches or not by the last digits of the URDF. If they touch in none, they must not. Nor must links of the hand that
    touch in no posture tried; a margin would keep the jaw from closing.
    """
    touching = _always_near(pairs, sampling, max(margin, _TOUCHING))
    left = [pair for pair in pairs if _links(pair) not in touching]
    hand = _never_touching([pair for pair in left if sampling.in_hand(pair)], sampling)
    enabled = [pair for pair in left if _links(pair) not in hand]
    return enabled, [pair for pair in pairs if _links(pair) in hand or touching.get(_links(pair)) is False]


def _always_near(pairs: Sequence[LinkPair], sampling: Sampling, margin: float) -> dict[Links, bool]:
    """Return the pairs that are nearer than the margin in every posture, and whether they touch in one."""
    left, touching = list(pairs), dict.fromkeys(map(_links, pairs), False)
    for placed in sampling.placed(pairs, POSTURES):
        distances = [_distance(pair, placed, margin) for pair in left]
        for pair, distance in zip(left, distances, strict=True):
            touching[_links(pair)] |= distance < _TOUCHING
        left = [pair for pair, distance in zip(left, distances, strict=True) if distance < margin]
        if not left:
            break
    return {_links(pair): touching[_links(pair)] for pair in left}


def _never_touching(pairs: list[LinkPair], sampling: Sampling) -> set[Links]:
    left = pairs
    for placed in sampling.placed(pairs, HAND_POSTURES):
        left = [pair for pair in left if _distance(pair, placed, _TOUCHING) >= _TOUCHING]
    return set(map(_links, left))


def _distance(pair: LinkPair, placed: Placed, most: float) -> float:
    """Return the lesser of `most` and the distance of two meshes; -inf if they touch."""
    first, second = pair
    apart = float(np.linalg.norm(placed.centers[first.link] - placed.centers[second.link]))
    return most if apart - first.radius - second.radius >= most else mesh_distance(first, second, placed, most)


def _links(pair: LinkPair) -> Links:
    return frozenset(mesh.link for mesh in pair)
