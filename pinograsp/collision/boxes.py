"""Lower bounds of distances from bounding boxes: much tighter than those from bounding spheres for long solids."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..compiled import compiled

ROUNDING = 1e-9
"""What a bound may be too large by, m."""


@compiled
def box_gap(first: Array, half: Array, second: Array, other_half: Array, apart: Array) -> float:
    """Return how far two boxes are apart at least: their gap along that edge of one of them where it is widest, m.

    Args:
        first: rotation of the first box, its edges as columns, shape (3, 3).
        half: half its edges, m, shape (3,).
        second: rotation of the second box, shape (3, 3).
        other_half: half its edges, m, shape (3,).
        apart: from the centre of the first to that of the second, m, shape (3,).
    """
    widest = -np.inf
    for side in range(2):
        axes, others = (first, second) if side == 0 else (second, first)
        own, theirs = (half, other_half) if side == 0 else (other_half, half)
        for i in range(3):
            gap = abs(axes[0, i] * apart[0] + axes[1, i] * apart[1] + axes[2, i] * apart[2]) - own[i]
            for j in range(3):
                along = axes[0, i] * others[0, j] + axes[1, i] * others[1, j] + axes[2, i] * others[2, j]
                gap -= theirs[j] * abs(along)
            widest = max(widest, gap)
    return widest


def half_edges(shape: Any) -> Array:
    """Return half the edges of the bounding box of a Coal geometry, m, shape (3,)."""
    return np.asarray(0.5 * (shape.aabb_local.max_ - shape.aabb_local.min_))
