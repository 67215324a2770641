"""Pairs of links that are not checked against each other: by an SRDF or, where one is missing, found here.

- Two links that a movable joint joins touch there.
- Others are near each other in every posture: the parts of a linkage, a wrist inside its fork.
- Links of the hand that touch in no posture of the hand need no margin between them either: a closed jaw or a folded
  linkage is narrower than what keeps an arm off itself, and moved by nothing but the synergies.

A pair is dropped from the search by the first posture that decides it, so nothing has to be kept in a file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import combinations, product
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..kinematics.robot import Robot
from ..memo import remembered
from .solids import distance_request, link_bodies
from .world import Body, BodyKey, Solid, pair_of_links

POSTURES = 500
"""Random postures tried: two links that one posture in a hundred holds apart look inseparable with 0.7 % chance."""
HAND_POSTURES = 60
"""For links of the hand, which fewer joints move."""

Pair = frozenset[BodyKey]
SolidPairs = dict[Pair, list[tuple[Body, Solid, Body, Solid]]]
"""Pairs of solids, by the pair of their bodies."""


def allowed_pairs(robot: Robot, margin: float) -> frozenset[Pair]:
    """Return the pairs of links that need not keep apart; found once for a robot, wherever it is mounted.

    Args:
        robot: the robot.
        margin: distance that the others are to keep, m.
    """
    return _allowed_pairs(robot.unmounted, margin)


@remembered
def _allowed_pairs(robot: Robot, margin: float) -> frozenset[Pair]:
    given = frozenset(pair_of_links(*sorted(links)) for links in robot.urdf.disabled_pairs if len(links) == 2)
    if robot.urdf.complete:
        return given
    parents = robot.model.parents
    left = pairs_apart(robot, given)
    found = {_pair(a, b) for a, b in left if parents[a.joint] == b.joint or parents[b.joint] == a.joint}
    left = [pair for pair in left if _pair(*pair) not in found]
    found |= always_near(robot, left, margin)
    in_hand = [(a, b) for a, b in left if _pair(a, b) not in found and robot.moved_by_hand(a.joint, b.joint)]
    return given | found | _never_touching(robot, in_hand)


def pairs_apart(robot: Robot, allowed: frozenset[Pair]) -> list[tuple[Body, Body]]:
    """Return the pairs of links that move against each other and may not touch."""
    return [
        (first, second)
        for first, second in combinations(link_bodies(robot), 2)
        if (robot.supports[first.joint] != robot.supports[second.joint]).any() and _pair(first, second) not in allowed
    ]


def always_near(robot: Robot, pairs: Iterable[tuple[Body, Body]], margin: float) -> set[Pair]:
    """Return the pairs of links that are nearer than a margin in all of `POSTURES` random postures.

    Args:
        robot: the robot; the postures are within its limits, the same every time.
        pairs: the links in question; two links are as far apart as the nearest two of their solids.
        margin: m.
    """
    left, request = _by_links(pairs), distance_request()
    for poses in _random_poses(robot, POSTURES):
        for links, theirs in list(left.items()):
            near = (k for k, pair in enumerate(theirs) if _nearer(*pair, poses, margin, request))
            first = next(near, None)
            if first is None:
                del left[links]
            else:  # asked first in the next posture, where it is most likely near again
                theirs.insert(0, theirs.pop(first))
        if not left:
            break
    return set(left)


def _never_touching(robot: Robot, pairs: Iterable[tuple[Body, Body]]) -> set[Pair]:
    left, request = _by_links(pairs), distance_request()
    for poses in _random_poses(robot, HAND_POSTURES):
        for links, theirs in list(left.items()):
            if any(_nearer(*pair, poses, 0.0, request) for pair in theirs):
                del left[links]
    return set(left)


def _by_links(pairs: Iterable[tuple[Body, Body]]) -> SolidPairs:
    return {_pair(a, b): [(a, s, b, t) for s, t in product(a.solids, b.solids)] for a, b in pairs}


def _random_poses(robot: Robot, count: int) -> Iterator[list[Array]]:
    """Yield the poses of all joints, shape (4, 4), in random postures."""
    rng, data = np.random.default_rng(0), robot.model.createData()
    for _ in range(count):
        pin.forwardKinematics(robot.model, data, robot.joint_positions(rng.uniform(robot.lower, robot.upper)))
        yield [M.homogeneous for M in data.oMi]


def _nearer(a: Body, first: Solid, b: Body, second: Solid, poses: list[Array], margin: float, request: Any) -> bool:
    """Whether two solids are nearer than the margin; poses of all joints."""
    Ta, Tb = poses[a.joint] @ a.pose, poses[b.joint] @ b.pose
    apart = Ta[:3, :3] @ first.center + Ta[:3, 3] - Tb[:3, :3] @ second.center - Tb[:3, 3]
    if float(np.linalg.norm(apart)) - first.radius - second.radius >= margin:
        return False
    Ta, Tb = Ta @ first.placement, Tb @ second.placement
    at = coal.Transform3s(Ta[:3, :3], Ta[:3, 3]), coal.Transform3s(Tb[:3, :3], Tb[:3, 3])
    return bool(coal.distance(first.shape, at[0], second.shape, at[1], request, coal.DistanceResult()) < margin)


def _pair(first: Body, second: Body) -> Pair:
    return frozenset((first.key, second.key))
