"""Near-identical grasps become one."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from ..arrays import without_turns
from .grasp import Grasp
from .ranking import ordered

SAME_JOINTS = 0.02
"""Largest difference of any joint (rad or m; whole turns do not count) of near-identical grasps."""
SAME_POINTS = 0.001
"""Largest distance between contact points of near-identical grasps, m."""

_FIRST = 1.01 * SAME_POINTS**2
"""Squared distance beyond which a contact point is farther away than that, whatever the rounding, m^2."""


def merge(grasps: Sequence[Grasp]) -> tuple[Grasp, ...]:
    """Return the grasps in the default order, each the one of least U of those near it; their counts are summed.

    Equal costs are ordered by start, so that the result does not depend on the order of `grasps`.
    """
    by_cost = sorted(grasps, key=lambda g: (g.cost.U, g.start))
    if not by_cost:
        return ()
    joints = np.array([list(g.joints.values()) for g in by_cost])
    points = np.array([[c.point for c in g.contacts] for g in by_cost])
    remaining = np.ones(len(by_cost), dtype=bool)
    merged = []
    for i, grasp in enumerate(by_cost):
        if not remaining[i]:
            continue
        # Few are near in their first contact: only these are looked at as a whole.
        near = np.flatnonzero(remaining & (((points[:, 0] - points[i, 0]) ** 2).sum(axis=1) <= _FIRST))
        slide = np.linalg.norm(points[near] - points[i], axis=2).max(axis=1)
        turn = np.abs(without_turns(joints[near] - joints[i])).max(axis=1)
        near = near[(turn <= SAME_JOINTS) & (slide <= SAME_POINTS)]
        remaining[near] = False
        count = sum(by_cost[j].count for j in near)
        merged.append(dataclasses.replace(grasp, count=count))
    return ordered(merged)
