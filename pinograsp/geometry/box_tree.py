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
    boxes, levels = np.concatenate([low, high], axis=1), list[Array]()
    while True:
        count = len(boxes)
        if count < WIDE:
            boxes = np.concatenate([np.tile(np.repeat([np.inf, -np.inf], 3), (WIDE - count, 1)), boxes])
        parts = boxes.reshape(-1, WIDE, 6).transpose(0, 2, 1)
        levels.append(parts)
        if count <= WIDE:
            return BoxTree(np.concatenate(levels[::-1]), count + 1 - WIDE)
        boxes = np.concatenate([parts[:, :3].min(axis=2), parts[:, 3:].max(axis=2)], axis=1)


def groups(points: Array) -> tuple[Indices, Indices]:
    """Return points, shape (n, 3), in groups of up to `WIDE` neighbours.

    Returns:
        Their numbers, the last repeated where they are fewer, shape (g, WIDE), g a power of two; and how many, (g,).
    """
    order, ends = _halved(points, max(0, math.ceil(math.log2(len(points) / WIDE))))
    return order[np.minimum(ends[:-1, None] + np.arange(WIDE), ends[1:, None] - 1)], np.diff(ends)


@compiled
def _halved(points: Array, depth: int) -> tuple[Indices, Indices]:
    """Return the order of points in which every part of them is halved along its longest side, and the ends of parts.

    Args:
        points: shape (n, 3).
        depth: how often they are halved; the ends have the shape (2^depth + 1,).
    """
    order, ends = np.arange(len(points)), np.empty((1 << depth) + 1, dtype=np.intp)
    ends[0], ends[1 << depth] = 0, len(points)
    step = 1 << depth
    while step > 1:
        for at in range(0, 1 << depth, step):
            first, last, widest, longest = ends[at], ends[at + step], 0, -1.0
            for axis in range(3):
                low, high = np.inf, -np.inf
                for k in range(first, last):
                    low, high = min(low, points[order[k], axis]), max(high, points[order[k], axis])
                if high - low > longest:
                    widest, longest = axis, high - low
            ends[at + step // 2] = half = first + (last - first) // 2
            _parted(points, widest, order, first, last - 1, half)
        step //= 2
    return order, ends


@compiled
def _parted(points: Array, axis: int, order: Indices, low: int, high: int, half: int) -> None:
    """Put into a part of the order, from low to high, first those that are lowest along an axis, up to half."""
    while low < high:
        pivot = points[order[(low + high) // 2], axis]
        i, j = low, high
        while i <= j:
            while points[order[i], axis] < pivot:
                i += 1
            while points[order[j], axis] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if half <= j:
            high = j
        elif half >= i:
            low = i
        else:
            return
