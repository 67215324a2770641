"""Triangles in a tree of boxes, in which the one nearest to a point is found without most others.

The tree is a complete binary one: every box is halved by number.

Long triangles are in it in pieces. An edge is halved in both of its triangles, or in none: pieces share corners and
edges as triangles do.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices, Integers
from ..compiled import compiled

LONGEST = 1.0 / 20.0
"""Edge of a triangle that is not divided, in parts of the extent."""
_LEAF = 2
_LEVELS = 64
"""Boxes that wait to be looked at, at most."""


class TriangleTree(NamedTuple):
    """Boxes around triangles, m."""

    corners: Array
    """Of triangles or pieces of them, shape (n, 3, 3)."""
    owners: Indices
    """Number of the triangle that each is a piece of, shape (n,)."""
    starts: Indices
    """First triangle of each leaf, and their number, shape (leaves + 1,)."""
    boxes: Array
    """Low and high ends; box k has the parts 2 k and 2 k + 1, the first is number 1, shape (2 leaves, 6)."""


def triangle_tree(vertices: Array, faces: Integers) -> TriangleTree:
    """Return the tree of triangles.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3), f > 0.
    """
    corners, owners = _divided(vertices[faces], LONGEST * float(np.ptp(vertices, axis=0).max()))
    depth = max(0, math.ceil(math.log2(len(corners) / _LEAF)))
    order, starts = _halved(corners.mean(axis=1), depth)
    corners = corners[order]
    boxes = np.zeros((2 << depth, 6))
    boxes[1 << depth :, :3] = np.minimum.reduceat(corners.min(axis=1), starts[:-1])
    boxes[1 << depth :, 3:] = np.maximum.reduceat(corners.max(axis=1), starts[:-1])
    for level in range(depth - 1, -1, -1):
        parts = boxes[2 << level : 4 << level].reshape(-1, 2, 6)
        boxes[1 << level : 2 << level, :3] = parts[:, :, :3].min(axis=1)
        boxes[1 << level : 2 << level, 3:] = parts[:, :, 3:].max(axis=1)
    return TriangleTree(corners, owners[order], starts, boxes)


def _divided(corners: Array, longest: float) -> tuple[Array, Indices]:
    """Return triangles halved at their longest edges until none is longer, m, and the triangle that each is of."""
    owners = np.arange(len(corners))
    found, whose = [], []
    while True:
        squares = ((np.roll(corners, -1, axis=1) - corners) ** 2).sum(axis=2)
        long = squares.max(axis=1) > longest * longest
        found.append(corners[~long])
        whose.append(owners[~long])
        if not long.any():
            return np.concatenate(found), np.concatenate(whose)
        corners, owners, start = corners[long], owners[long], squares[long].argmax(axis=1)
        rows, end = np.arange(len(corners)), (start + 1) % 3
        middles = 0.5 * (corners[rows, start] + corners[rows, end])
        first, second = corners.copy(), corners
        first[rows, end] = middles
        second[rows, start] = middles
        corners, owners = np.concatenate([first, second]), np.concatenate([owners, owners])


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


def nearest(tree: TriangleTree, points: Array) -> tuple[Array, Indices]:
    """Return distances of points, shape (n, 3), to the nearest triangles, m, and the numbers of these, shape (n,)."""
    return _nearest(tree, np.ascontiguousarray(points))


@compiled
def _nearest(tree: TriangleTree, points: Array) -> tuple[Array, Indices]:
    boxes, corners, starts, leaves = tree.boxes, tree.corners, tree.starts, len(tree.starts) - 1
    waiting, bounds = np.empty(_LEVELS, dtype=np.intp), np.empty(_LEVELS)
    found, numbers, best = np.empty(len(points)), np.empty(len(points), dtype=np.intp), 0
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        least = _square(corners, best, x, y, z)  # of what is nearest to the point before
        waiting[0], bounds[0], count = 1, 0.0, 1
        while count:
            count -= 1
            if bounds[count] >= least:
                continue
            box = waiting[count]
            if box >= leaves:
                for k in range(starts[box - leaves], starts[box - leaves + 1]):
                    square = _square(corners, k, x, y, z)
                    if square < least:
                        least, best = square, k
                continue
            one, other = _away(boxes, 2 * box, x, y, z), _away(boxes, 2 * box + 1, x, y, z)
            nearer = 1 if other < one else 0
            if max(one, other) < least:
                waiting[count], bounds[count] = 2 * box + 1 - nearer, max(one, other)
                count += 1
            if min(one, other) < least:
                waiting[count], bounds[count] = 2 * box + nearer, min(one, other)
                count += 1
        found[n] = math.sqrt(least)
        numbers[n] = tree.owners[best]
    return found, numbers


@compiled
def _away(boxes: Array, k: int, x: float, y: float, z: float) -> float:
    """Return the square of the distance of a point to a box."""
    a = max(boxes[k, 0] - x, x - boxes[k, 3], 0.0)
    b = max(boxes[k, 1] - y, y - boxes[k, 4], 0.0)
    c = max(boxes[k, 2] - z, z - boxes[k, 5], 0.0)
    return float(a * a + b * b + c * c)


@compiled
def _square(corners: Array, k: int, x: float, y: float, z: float) -> float:
    """Return the square of the distance of a point to a triangle."""
    ax, ay, az = corners[k, 0, 0], corners[k, 0, 1], corners[k, 0, 2]
    bx, by, bz = corners[k, 1, 0] - ax, corners[k, 1, 1] - ay, corners[k, 1, 2] - az
    cx, cy, cz = corners[k, 2, 0] - ax, corners[k, 2, 1] - ay, corners[k, 2, 2] - az
    px, py, pz = x - ax, y - ay, z - az
    bb, bc, cc = bx * bx + by * by + bz * bz, bx * cx + by * cy + bz * cz, cx * cx + cy * cy + cz * cz
    pb, pc = px * bx + py * by + pz * bz, px * cx + py * cy + pz * cz
    area = bb * cc - bc * bc
    v, w = cc * pb - bc * pc, bb * pc - bc * pb
    if v > 0.0 and w > 0.0 and v + w < area:  # above the triangle itself
        v, w = v / area, w / area
        return float(_length(px - v * bx - w * cx, py - v * by - w * cy, pz - v * bz - w * cz))
    s = min(max(pb / bb, 0.0), 1.0) if bb > 0.0 else 0.0
    least = _length(px - s * bx, py - s * by, pz - s * bz)
    s = min(max(pc / cc, 0.0), 1.0) if cc > 0.0 else 0.0
    least = min(least, _length(px - s * cx, py - s * cy, pz - s * cz))
    dd = bb - 2.0 * bc + cc
    s = min(max((pc - pb - bc + bb) / dd, 0.0), 1.0) if dd > 0.0 else 0.0
    x, y, z = bx + s * (cx - bx), by + s * (cy - by), bz + s * (cz - bz)
    return float(min(least, _length(px - x, py - y, pz - z)))


@compiled
def _length(x: float, y: float, z: float) -> float:
    """Return the square of it."""
    return float(x * x + y * y + z * z)
