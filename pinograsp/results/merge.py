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
        turn = np.abs(without_turns(joints - joints[i])).max(axis=1)
        slide = np.linalg.norm(points - points[i], axis=2).max(axis=1)
        near = remaining & (turn <= SAME_JOINTS) & (slide <= SAME_POINTS)
        remaining &= ~near
        count = sum(by_cost[j].count for j in np.flatnonzero(near))
        merged.append(dataclasses.replace(grasp, count=count))
    return ordered(merged)
