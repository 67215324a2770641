"""The largest rectangle inside a flat face that triangles make up."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array, Mask

CELLS = 60
"""Cells along the longer side of the face."""


class Rectangle(NamedTuple):
    """Sides along the axes of the plane, m."""

    low: Array
    """Shape (2,)."""
    high: Array

    @property
    def area(self) -> float:
        """m^2."""
        return float(np.prod(self.high - self.low))


def largest_rectangle(triangles: Array) -> Rectangle:
    """Return the largest rectangle, sides along x and y, within the union of triangles, shape (n, 3, 2), m.

    It is found on a grid of cells, its sides moved to corners of triangles that are as near as a cell.
    """
    corners = triangles.reshape(-1, 2)
    low, high = corners.min(axis=0), corners.max(axis=0)
    step = float((high - low).max()) / CELLS
    counts = np.maximum(np.ceil((high - low) / step).astype(int), 1)
    centers = [low[axis] + step * (np.arange(counts[axis]) + 0.5) for axis in (0, 1)]
    (left, right), (bottom, top) = _largest_block(_covered(triangles, centers[0], centers[1]))
    found = Rectangle(low + step * np.array([left, bottom]), low + step * np.array([right, top]))
    return Rectangle(*(np.array([_snapped(side[k], corners[:, k], step) for k in (0, 1)]) for side in found))


def _covered(triangles: Array, x: Array, y: Array) -> Mask:
    """Return which points (x_i, y_j) lie in a triangle, shape (len(x), len(y))."""
    covered = np.zeros((len(x), len(y)), dtype=bool)
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    starts = np.column_stack([np.searchsorted(x, low[:, 0]), np.searchsorted(y, low[:, 1])]).tolist()
    ends = np.column_stack([np.searchsorted(x, high[:, 0], "right"), np.searchsorted(y, high[:, 1], "right")]).tolist()
    for (a, b, c), (i, j), (k, m) in zip(triangles, starts, ends, strict=True):
        if k <= i or m <= j:
            continue
        twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        inside = np.full((k - i, m - j), abs(twice) > 1e-14)
        for start, end in ((a, b), (b, c), (c, a)):
            along = (end[0] - start[0]) * (y[None, j:m] - start[1]) - (end[1] - start[1]) * (x[i:k, None] - start[0])
            inside &= along * np.sign(twice) >= -1e-15
        covered[i:k, j:m] |= inside
    return covered


def _largest_block(cells: Mask) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the ends, the second one exclusive, along both axes of the largest block of true cells."""
    best, found = 0, ((0, 0), (0, 0))
    heights = np.zeros(cells.shape[1], dtype=int)
    for i, row in enumerate(cells):
        heights = np.where(row, heights + 1, 0)
        stack: list[tuple[int, int]] = []  # where a run of at least that height begins
        for j, height in enumerate([*heights.tolist(), 0]):
            start = j
            while stack and stack[-1][1] >= height:
                start, tall = stack.pop()
                if tall * (j - start) > best:
                    best, found = tall * (j - start), ((i + 1 - tall, i + 1), (start, j))
            stack.append((start, height))
    return found


def _snapped(value: float, corners: Array, step: float) -> float:
    nearest = float(corners[np.abs(corners - value).argmin()])
    return nearest if abs(nearest - value) <= step else value
