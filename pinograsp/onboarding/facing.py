"""Which two flat faces of the fingers a hand closes on each other."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..arrays import Array
from ..descriptions.urdf_checks import WIDEST, usable
from ..kinematics.tree import TreeJoint, UrdfTree
from .facets import Facet

OPPOSED = math.cos(math.radians(8.0))
OVERLAP_ALLOWED = 1e-3
"""Faces may pass through each other by this when the hand is closed, m."""
PROUD = 5e-4
"""A link that reaches farther than this beyond a face is in the way of what the face is to touch, m."""
MOST_PAIRS = 300
STEPS, POSTURES = 9, 60
"""Postures of a hand with one synergy, evenly, and with more, at random."""
USUAL_RANGE = {"prismatic": (0.0, 0.05)}
"""For a joint without usable limits, m; a turning one gets `USUAL_TURN`."""
USUAL_TURN = (-0.8, 0.8)


def usual_limits(joint: TreeJoint) -> tuple[float, float] | None:
    """Return limits to begin with for a joint that has no usable ones, rad (m); None for one that has."""
    if joint.kind == "continuous" or usable(*joint.limits):
        return None
    if joint.kind == "revolute" and joint.limits[0] < -WIDEST and joint.limits[1] > WIDEST:
        return (-2.0 * math.pi, 2.0 * math.pi)  # as of a joint that turns freely, which it is meant to be
    return USUAL_RANGE.get(joint.kind, USUAL_TURN)


def facing_pair(facets: Sequence[Facet], tree: UrdfTree, palm: str, hand: Sequence[str]) -> tuple[Facet, Facet] | None:
    """Return the two faces that face each other most of the time, with the largest area, and that close.

    Args:
        facets: of the fingers.
        tree: of the robot.
        palm: link that carries the fingers; the faces are of different ones.
        hand: the hand's joints that follow none.
    """
    if not facets:
        return None
    poses = [tree.poses(angles) for angles in _postures(tree, hand)]
    first_joint = len(tree.path(palm))
    fingers = [tree.path(facet.link)[first_joint].name for facet in facets]
    best, found = 0.0, None
    for first, second in _likely(facets, poses):
        if fingers[first] != fingers[second]:
            score = _score(facets[first], facets[second], poses)
            if score > best:
                best, found = score, (facets[first], facets[second])
    return found


def _likely(facets: Sequence[Facet], poses: Sequence[Mapping[str, Array]]) -> list[tuple[int, int]]:
    """Return pairs of faces that are turned to each other in some posture, the most promising ones first."""
    count = len(facets)
    turned = np.zeros((count, count))
    origins, normals = (np.array([f.origin for f in facets]), np.array([f.axes[:, 2] for f in facets]))
    for at in poses:
        T = np.array([at[facet.link] for facet in facets]).reshape(-1, 4, 4)
        n = np.einsum("fij,fj->fi", T[:, :3, :3], normals)
        c = np.einsum("fij,fj->fi", T[:, :3, :3], origins) + T[:, :3, 3]
        before = c @ n.T - (c * n).sum(axis=1) > -OVERLAP_ALLOWED  # face i is before face j
        turned += (n @ n.T < -OPPOSED) & before & before.T
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


def _score(first: Facet, second: Facet, poses: Sequence[Mapping[str, Array]]) -> float:
    """Return the area that faces the other one, on average, times the part of the opening that can be closed, m^2."""
    areas, gaps = [], []
    for at in poses:
        T = np.linalg.inv(at[first.link]) @ at[second.link]
        apart = first.axes.T @ (T[:3, :3] @ second.origin + T[:3, 3] - first.origin)
        axes = first.axes.T @ T[:3, :3] @ second.axes
        if -axes[2, 2] < OPPOSED or apart[2] < -OVERLAP_ALLOWED:
            continue
        half = np.abs(axes[:2, :2]) @ second.sides / 2
        low = np.maximum(-first.sides / 2, apart[:2] - half)
        high = np.minimum(first.sides / 2, apart[:2] + half)
        if (high > low).all():
            areas.append(float(np.prod(high - low)))
            gaps.append(max(float(apart[2]), 0.0))
    if not gaps or max(gaps) < 1e-3:
        return 0.0
    closes = (max(gaps) - min(gaps)) / max(gaps)
    return sum(areas) / len(poses) * closes * min(_freedom(first), _freedom(second))
