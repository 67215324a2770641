"""Boxes in a tree, the parts of each side by side in memory: processors look at several of them at once.

Every box has `WIDE` parts. Its things are halved by number again and again, so that all leaves are equally deep; where
the number of leaves is no power of `WIDE`, some parts of the first box are empty.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled

WIDE = 8


class BoxTree(NamedTuple):
    """Boxes within boxes; whoever goes through it begins with box number 0.

    Part j of box k has the number WIDE k + j + shift. From len(parts) on, these are leaves in their order.
    """

    parts: Array
    """Low and high ends of the parts of each box, m, shape (boxes, 6, WIDE)."""
    shift: int


def box_tree(low: Array, high: Array) -> BoxTree:
    """Return the tree above leaves that are grouped already, as by `groups`.

    Args:
        low: low ends of their boxes, m, shape (n, 3), n a power of two.
        high: high ends, infinitely low where a leaf is empty.
    """
    level, boxes = len(low), 1
    while level > WIDE:
        level //= WIDE
        boxes += level
    parts, shift = np.empty((boxes, 6, WIDE)), level + 1 - WIDE
    parts[0, :3], parts[0, 3:] = np.inf, -np.inf
    _put_together(parts, shift, low, high)
    return BoxTree(parts, shift)


def groups(points: Array) -> tuple[Indices, Indices]:
    """Return points, shape (n, 3), in groups of up to `WIDE` neighbours.

    Returns:
        Their numbers, the last repeated where they are fewer, shape (g, WIDE), g a power of two; and how many, (g,).
    """
    order, ends = _halved(points, max(0, math.ceil(math.log2(len(points) / WIDE))))
    return order[np.minimum(ends[:-1, None] + np.arange(WIDE), ends[1:, None] - 1)], np.diff(ends)


@compiled
def _put_together(parts: Array, shift: int, low: Array, high: Array) -> None:
    """Write the ends of leaves, and of the boxes around them, from the last one on."""
    for number in range(len(parts) + len(low) - 1, 0, -1):
        leaf, (box, j) = number - len(parts), divmod(number - shift, WIDE)
        for axis in range(3):
            if leaf >= 0:
                parts[box, axis, j], parts[box, 3 + axis, j] = low[leaf, axis], high[leaf, axis]
            else:
                parts[box, axis, j], parts[box, 3 + axis, j] = parts[number, axis].min(), parts[number, 3 + axis].max()


@compiled
def box_ends(corners: Array) -> tuple[Array, Array]:
    """Return the low and high ends of boxes around triangles, shape (n, 3, 3), m, shapes (n, 3)."""
    low, high = corners[:, 0].copy(), corners[:, 0].copy()
    for n in range(len(corners)):
        for corner in range(1, 3):
            for axis in range(3):
                low[n, axis] = min(low[n, axis], corners[n, corner, axis])
                high[n, axis] = max(high[n, axis], corners[n, corner, axis])
    return low, high


@compiled
def _halved(points: Array, depth: int) -> tuple[Indices, Indices]:
    """Return the order of points in which every part of them is halved along its longest side, and the ends of parts.

    Args:
        points: shape (n, 3).
        depth: how often they are halved; the ends have the shape (2^depth + 1,).
    """
    order, places, ends = np.arange(len(points)), points.T.copy(), np.empty((1 << depth) + 1, dtype=np.intp)
    ends[0], ends[1 << depth] = 0, len(points)
    step = 1 << depth
    while step > 1:
        for at in range(0, 1 << depth, step):
            first, last, widest, longest = ends[at], ends[at + step], 0, -1.0
            for axis in range(3):
                low, high = np.inf, -np.inf
                for k in range(first, last):
                    low, high = min(low, places[axis, k]), max(high, places[axis, k])
                if high - low > longest:
                    widest, longest = axis, high - low
            ends[at + step // 2] = half = first + (last - first) // 2
            others = places[(widest + 1) % 3], places[(widest + 2) % 3]
            _parted(places[widest], others, order, first, last - 1, half)
        step //= 2
    return order, ends


@compiled
def _parted(along: Array, others: tuple[Array, Array], order: Indices, low: int, high: int, half: int) -> None:
    """Put in a part of some points, from low to high, first those that are lowest along an axis, up to half."""
    one, other = others
    while low < high:
        pivot = along[(low + high) // 2]
        i, j = low, high
        while i <= j:
            while along[i] < pivot:
                i += 1
            while along[j] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                along[i], along[j] = along[j], along[i]
                one[i], one[j] = one[j], one[i]
                other[i], other[j] = other[j], other[i]
                i += 1
                j -= 1
        if half <= j:
            high = j
        elif half >= i:
            low = i
        else:
            return
