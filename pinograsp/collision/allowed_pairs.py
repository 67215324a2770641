"""Pairs of links that are not checked against each other, found where an SRDF is missing.

- Two links that a movable joint joins touch there.
- Others are near each other in every posture: the parts of a linkage, a wrist inside its fork.
- Links of the hand that touch in no posture of the hand need no margin between them either: a closed jaw or a folded
  linkage is narrower than what keeps an arm off itself, and moved by nothing but the synergies.

A pair is dropped from the search by the first posture that decides it, so nothing has to be kept in a file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..kinematics.robot import RobotModel
from .solids import Solid, distance_request, self_pairs

POSTURES = 500
"""Random postures tried: two links that one posture in a hundred holds apart look inseparable with 0.7 % chance."""
HAND_POSTURES = 60
"""For links of the hand, which fewer joints move."""

LinkPair = frozenset[str]


def excused_links(robot: RobotModel, solids: list[Solid], margin: float) -> frozenset[LinkPair]:
    """Return the pairs of links that are not checked against each other: by an SRDF or, if one is missing, found here.

    Args:
        robot: the robot.
        solids: of its links, as `robot_solids` gives them.
        margin: distance that the others are to keep, m.
    """
    given = robot.urdf.disabled_pairs
    if robot.urdf.complete:
        return given
    parents = robot.model.parents
    found = set(given)
    for a, b in self_pairs(robot, solids, given):
        first, second = solids[a].joint, solids[b].joint
        if parents[first] == second or parents[second] == first:
            found.add(_links(solids[a], solids[b]))
    found |= always_near(robot, solids, self_pairs(robot, solids, frozenset(found)), margin)
    in_hand = [
        pair
        for pair in self_pairs(robot, solids, frozenset(found))
        if robot.moved_by_hand(solids[pair[0]].joint, solids[pair[1]].joint)
    ]
    return frozenset(found | _never_touching(robot, solids, in_hand))


def always_near(
    robot: RobotModel, solids: list[Solid], pairs: Iterable[tuple[int, int]], margin: float
) -> set[LinkPair]:
    """Return the pairs of links that are nearer than a margin in all of `POSTURES` random postures.

    Args:
        robot: the robot; the postures are within its limits, the same every time.
        solids: of its links.
        pairs: indices of the solids in question; two links are as far apart as the nearest two of theirs.
        margin: m.
    """
    left, request = _by_links(solids, pairs), distance_request()
    for poses in _random_poses(robot, POSTURES):
        for links, theirs in list(left.items()):
            near = (k for k, (a, b) in enumerate(theirs) if _nearer(solids[a], solids[b], poses, margin, request))
            first = next(near, None)
            if first is None:
                del left[links]
            else:  # asked first in the next posture, where it is most likely near again
                theirs.insert(0, theirs.pop(first))
        if not left:
            break
    return set(left)


def _never_touching(robot: RobotModel, solids: list[Solid], pairs: Iterable[tuple[int, int]]) -> set[LinkPair]:
    left, request = _by_links(solids, pairs), distance_request()
    for poses in _random_poses(robot, HAND_POSTURES):
        for links, theirs in list(left.items()):
            if any(_nearer(solids[a], solids[b], poses, 0.0, request) for a, b in theirs):
                del left[links]
    return set(left)


def _by_links(solids: list[Solid], pairs: Iterable[tuple[int, int]]) -> dict[LinkPair, list[tuple[int, int]]]:
    found: dict[LinkPair, list[tuple[int, int]]] = {}
    for a, b in pairs:
        found.setdefault(_links(solids[a], solids[b]), []).append((a, b))
    return found


def _random_poses(robot: RobotModel, count: int) -> Iterator[list[Array]]:
    """Yield the poses of all joints, shape (4, 4), in random postures."""
    rng, data = np.random.default_rng(0), robot.model.createData()
    for _ in range(count):
        pin.forwardKinematics(robot.model, data, robot.joint_positions(rng.uniform(robot.lower, robot.upper)))
        yield [M.homogeneous for M in data.oMi]


def _nearer(first: Solid, second: Solid, poses: list[Array], margin: float, request: Any) -> bool:
    """Whether two solids are nearer than the margin; poses of all joints."""
    (Ta, Tb), (a, b) = (poses[first.joint], poses[second.joint]), (first.center, second.center)
    apart = Ta[:3, :3] @ a + Ta[:3, 3] - Tb[:3, :3] @ b - Tb[:3, 3]
    if float(np.linalg.norm(apart)) - first.radius - second.radius >= margin:
        return False
    Ta, Tb = Ta @ first.placement, Tb @ second.placement
    at = coal.Transform3s(Ta[:3, :3], Ta[:3, 3]), coal.Transform3s(Tb[:3, :3], Tb[:3, 3])
    return bool(coal.distance(first.shape, at[0], second.shape, at[1], request, coal.DistanceResult()) < margin)


def _links(first: Solid, second: Solid) -> LinkPair:
    return frozenset((first.name, second.name))
