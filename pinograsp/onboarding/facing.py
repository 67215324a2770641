"""Which flat faces a hand closes on each other: two of a jaw; of a hand of many fingers, the thumb's and theirs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..descriptions.urdf_checks import WIDEST, usable
from ..kinematics.tree import TreeJoint, UrdfTree
from .facets import Facet

OPPOSED = math.cos(math.radians(8.0))
NEARLY = math.cos(math.radians(60.0))
"""While faces are turned to each other within this, their gap tells whether they close."""
CLOSES = 0.4
"""Part of the widest gap that faces close at least: those of neighbouring fingers hardly do."""
ALONG = 0.6
"""Part of its way that a face goes along the normal of the one that it is to close on: near a hinge it passes by."""
OVERLAP_ALLOWED = 1e-3
"""Faces may pass through each other by this when the hand is closed, m."""
PROUD = 5e-4
"""A link that reaches farther than this beyond a face is in the way of what the face is to touch, m."""
MOST_PAIRS = 300
SIDE = 0.8
"""Cosine between its normal and the axis of its finger from which on a face is at the finger's side."""
WORTH = 0.2
"""Part of the best pairing's score that a further finger is worth to be given a pad."""
STEPS, POSTURES = 41, 300
"""Postures of a hand with one synergy, evenly, and with more, at random."""
USUAL_RANGE = {"prismatic": (0.0, 0.05)}
"""For a joint without usable limits, m; a turning one gets `USUAL_TURN`."""
USUAL_TURN = (-0.8, 0.8)


class Pairing(NamedTuple):
    """How well two faces hold something between them."""

    score: float
    """Area that faces the other face, m^2, less what speaks against it."""
    first: int
    second: int


def usual_limits(joint: TreeJoint, turn: tuple[float, float] = USUAL_TURN) -> tuple[float, float] | None:
    """Return limits to begin with for a joint that has no usable ones, rad (m); None for one that has.

    Args:
        joint: a joint.
        turn: those of one that turns, where the URDF tells nothing.
    """
    low, high = joint.limits
    if joint.kind == "continuous" or usable(low, high):
        return None
    if usable(high, low):
        return high, low
    if joint.kind == "revolute" and low < -WIDEST and high > WIDEST:
        return (-2.0 * math.pi, 2.0 * math.pi)  # as of a joint that turns freely, which it is meant to be
    return USUAL_RANGE.get(joint.kind, turn)


def facing(facets: Sequence[Facet], tree: UrdfTree, palm: str, hand: Sequence[str]) -> tuple[Facet, ...]:
    """Return the two faces that face each other most of the time, with the largest area, and that close; or none.

    Of a hand of more fingers, the faces of those fingers follow that the first one, the thumb's, closes on as well.

    Args:
        facets: of the fingers, and of the palm where it is one of them.
        tree: of the robot.
        palm: link that carries the fingers; the faces are of different ones.
        hand: the hand's joints that follow none.
    """
    fingers = {facet.link: finger_of(tree, palm, facet.link) for facet in facets}
    motions = {link: _motion(tree, palm, link) for link in fingers}
    many = len(hand) > 2  # links of one finger may branch off the palm side by side
    facets = [facet for facet in facets if _may_touch(facet, motions[facet.link], many)]
    if not facets:
        return ()
    poses = [tree.poses(angles) for angles in _postures(tree, hand)]
    own = [fingers[facet.link] for facet in facets]
    outer = _outwardness(tree, facets, own)
    found = []
    for first, second in _likely(facets, poses, NEARLY if len(hand) > 1 else OPPOSED):
        if own[first] != own[second]:
            score = _score(facets[first], facets[second], poses, often=len(hand) == 1)
            score *= min(outer[first], outer[second]) if len(hand) > 1 else 1.0
            found += [Pairing(score, first, second)] if score > 0.0 else []
    if not found:
        return ()
    return tuple(facets[index] for index in _thumb_first(found, own))


def finger_of(tree: UrdfTree, palm: str, link: str) -> str:
    """Return the joint with which the finger of a link begins, or nothing for a link of the palm's own body."""
    beyond = tree.path(link)[len(tree.path(palm)) :]
    return beyond[0].name if beyond else ""


def _motion(tree: UrdfTree, palm: str, link: str) -> Array | None:
    """Return how its own joint moves a link of a finger a little towards the end of its range that is farther from 0.

    Shape (4, 4), in the link's frame; None for a link of the palm's body.
    """
    beyond = tree.path(link)[len(tree.path(palm)) :]
    if not beyond:
        return None
    joint = beyond[-1]
    leader = tree.joints[joint.leader or joint.name]
    step = 1e-3 if abs(leader.limits[1]) >= abs(leader.limits[0]) else -1e-3
    ends = [tree.poses({leader.name: value}) for value in (0.0, step)]
    before, after = (np.linalg.inv(at[joint.parent]) @ at[link] for at in ends)
    return np.asarray(np.linalg.inv(before) @ after)


def _may_touch(facet: Facet, motion: Array | None, many: bool) -> bool:
    """Whether a face may be meant to touch: neither a side of a finger nor, among many fingers, a back.

    A face is at a side if the finger's own joint never moves it along its normal: the normal is along the axis about
    which it turns, or across the way on which it slides. Among many fingers it is a back if it does not go along its
    normal as the finger bends; of two, which may open with their joints, nobody knows.
    """
    if motion is None:
        return True
    normal = facet.axes[:, 2]
    way = np.array([motion[2, 1], motion[0, 2], motion[1, 0]])
    if np.linalg.norm(way) < 1e-9:  # it slides
        slides = motion[:3, 3] / max(float(np.linalg.norm(motion[:3, 3])), 1e-12)
        return abs(float(slides @ normal)) > math.sqrt(1.0 - SIDE**2)
    if abs(float(way @ normal)) > SIDE * np.linalg.norm(way):
        return False
    moved = motion[:3, :3] @ facet.origin + motion[:3, 3] - facet.origin
    return not many or float(moved @ normal) > 0.0


def _outwardness(tree: UrdfTree, facets: Sequence[Facet], fingers: Sequence[str]) -> list[float]:
    """Return how far out the link of every face is on its finger, 1 for the outermost ones, which touch things."""
    joints = [len(tree.path(facet.link)) for facet in facets]
    ends = {finger: [n for n, own in zip(joints, fingers, strict=True) if own == finger] for finger in fingers}
    return [1.0 / (1 + max(ends[finger]) - n) for n, finger in zip(joints, fingers, strict=True)]


def _thumb_first(found: Sequence[Pairing], fingers: Sequence[str]) -> list[int]:
    """Return the two faces of the best pairing; of more fingers the thumb's face, then those that it closes on.

    The thumb's is the face that closes best on all other fingers together, one face of each.
    """
    against: dict[int, dict[str, tuple[float, int]]] = {}
    for score, *pair in found:
        for face, other in (pair, pair[::-1]):
            best = against.setdefault(face, {}).get(fingers[other], (0.0, 0))
            against[face][fingers[other]] = max(best, (score, other))
    thumb = max(against, key=lambda face: sum(score for score, _ in against[face].values()))
    ranked = sorted(against[thumb].values(), reverse=True)
    kept = [face for score, face in ranked if score >= WORTH * ranked[0][0]]
    if len(kept) > 1:
        return [thumb, *kept]
    _, first, second = max(found)
    return [first, second]


def _likely(facets: Sequence[Facet], poses: Sequence[Mapping[str, Array]], opposed: float) -> list[tuple[int, int]]:
    """Return pairs of faces that are turned to each other in some posture, the most promising ones first."""
    count = len(facets)
    turned = np.zeros((count, count))
    origins, normals = (np.array([f.origin for f in facets]), np.array([f.axes[:, 2] for f in facets]))
    for at in poses:
        T = np.array([at[facet.link] for facet in facets]).reshape(-1, 4, 4)
        n = np.einsum("fij,fj->fi", T[:, :3, :3], normals)
        c = np.einsum("fij,fj->fi", T[:, :3, :3], origins) + T[:, :3, 3]
        before = c @ n.T - (c * n).sum(axis=1) > -OVERLAP_ALLOWED  # face i is before face j
        turned += (n @ n.T < -opposed) & before & before.T
    areas = np.array([np.prod(facet.sides) * _freedom(facet) for facet in facets])
    promise = np.triu(turned * np.minimum.outer(areas, areas), 1)
    order = np.argsort(-promise, axis=None)[:MOST_PAIRS]
    return [divmod(int(k), count) for k in order if promise.flat[k] > 0.0]


def _freedom(facet: Facet) -> float:
    return 1.0 if facet.standing <= PROUD else 0.2


def _postures(tree: UrdfTree, hand: Sequence[str]) -> list[dict[str, float]]:
    ranges = []
    for name in hand:
        joint = tree.joints[name]
        ranges.append(USUAL_TURN if joint.kind == "continuous" else usual_limits(joint) or joint.limits)
    low, high = np.array(ranges).T
    if len(hand) == 1:
        values = np.linspace(low, high, STEPS)
    else:
        values = np.random.default_rng(0).uniform(low, high, (POSTURES, len(hand)))
    return [dict(zip(hand, row.tolist(), strict=True)) for row in values]


def _score(first: Facet, second: Facet, poses: Sequence[Mapping[str, Array]], *, often: bool) -> float:
    """Return the area that faces the other one, times the part of the opening that can be closed, m^2.

    Args:
        first: a face.
        second: another one.
        poses: of the links in postures of the hand.
        often: whether postures count on average, of a hand that has one way to move; else the best counts.
    """
    areas, gaps, ways = [0.0], [], list[Array]()
    for at in poses:
        T = np.linalg.inv(at[first.link]) @ at[second.link]
        apart = first.axes.T @ (T[:3, :3] @ second.origin + T[:3, 3] - first.origin)
        axes = first.axes.T @ T[:3, :3] @ second.axes
        if -axes[2, 2] < NEARLY or apart[2] < -OVERLAP_ALLOWED:
            continue
        gaps.append(max(float(apart[2]), 0.0))
        half = np.abs(axes[:2, :2]) @ second.sides / 2
        low = np.maximum(-first.sides / 2, apart[:2] - half)
        high = np.minimum(first.sides / 2, apart[:2] + half)
        if (high > low).all() and -axes[2, 2] > (OPPOSED if often else NEARLY):
            turned = 1.0 if often else (-axes[2, 2] - NEARLY) / (1.0 - NEARLY)
            areas.append(float(np.prod(high - low)) * float(turned))
            ways.append(apart)
    if not gaps or max(gaps) < 1e-3 or (closes := 1.0 - min(gaps) / max(gaps)) < CLOSES:
        return 0.0
    if often and not _head_on(ways):
        return 0.0
    area = sum(areas) / len(poses) if often else max(areas)
    return area * closes * min(_freedom(first), _freedom(second))


def _head_on(ways: Sequence[Array]) -> bool:
    """Whether one face comes to the other along its normal rather than sideways, z of the places where it passes."""
    if len(ways) < 2:
        return True
    steps = np.abs(np.diff(ways, axis=0))
    return bool(steps[:, 2].sum() > ALONG * np.linalg.norm(steps, axis=1).sum())
