"""Boxes that are turned to lie along long thin triangles.

Triangles side by side that are long and thin, as those of turned parts, fill little of a box along the axes. Many such
boxes would hold any point, and all of them be looked into.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Mask
from ..compiled import compiled
from .box_tree import BoxTree

LONG = 0.8
"""How much longer the edges of triangles must be one way than across it: difference of squares, of their sum."""
_ROUNDING = 1e-14
"""Of corners that are turned, in parts of their coordinates."""


def turn_boxes(tree: BoxTree, corners: Array, empty: Mask) -> Array:
    """Turn the parts of each box about the third axis, all alike, to lie along its triangles if these are long.

    Args:
        tree: its parts are changed.
        corners: of the triangle that each leaf is, m, shape (leaves, 3, 3).
        empty: which leaves are none, shape (leaves,).

    Returns:
        First axis of the parts of each box, shape (boxes, 2); the second one is a quarter turn from there.
    """
    axes = np.tile([1.0, 0.0], (len(tree.parts), 1))
    _turn(tree.parts, tree.shift, corners, empty, axes)
    return axes


@compiled
def _turn(parts: Array, shift: int, corners: Array, empty: Mask, axes: Array) -> None:
    boxes, wide = len(parts), parts.shape[2]
    for box in range(1, boxes):  # the first one has parts that are empty, and holds most points anyway
        first, end = box, box + 1
        while first < boxes:
            first, end = wide * first + shift, wide * end + shift
        first, end = first - boxes, end - boxes
        if _direction(corners[first:end], empty[first:end], axes[box]):
            each = (end - first) // wide
            for j in range(wide):
                start = first + each * j
                _bound(corners[start : start + each], empty[start : start + each], axes[box], parts[box, :, j])


@compiled
def _direction(corners: Array, empty: Mask, axis: Array) -> bool:
    """Write the direction of the edges of triangles, shape (n, 3, 3), if they are long, and return whether they are."""
    xx = xy = yy = 0.0
    for n in range(len(corners)):
        if not empty[n]:
            for i in range(3):
                x = corners[n, i, 0] - corners[n, i - 1, 0]
                y = corners[n, i, 1] - corners[n, i - 1, 1]
                xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
    if math.hypot(xx - yy, 2.0 * xy) <= LONG * (xx + yy):
        return False
    angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
    axis[0], axis[1] = math.cos(angle), math.sin(angle)
    return True


@compiled
def _bound(corners: Array, empty: Mask, axis: Array, ends: Array) -> None:
    """Write the ends along two turned axes of the box around triangles, shape (n, 3, 3); ends has the shape (6,)."""
    low, left, high, right, size = np.inf, np.inf, -np.inf, -np.inf, 0.0
    for n in range(len(corners)):
        if not empty[n]:
            for i in range(3):
                x, y = corners[n, i, 0], corners[n, i, 1]
                along, across = axis[0] * x + axis[1] * y, axis[0] * y - axis[1] * x
                low, high = min(low, along), max(high, along)
                left, right = min(left, across), max(right, across)
                size = max(size, abs(x) + abs(y))
    slack = _ROUNDING * size
    ends[0], ends[3], ends[1], ends[4] = low - slack, high + slack, left - slack, right + slack
