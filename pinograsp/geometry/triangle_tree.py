"""Triangles in a tree of boxes, in which the one nearest to a point is found without most others.

Long triangles are in it in pieces. An edge is halved in both of its triangles, or in none: pieces share corners and
edges as triangles do. Where many triangles are long and thin, as on turned parts, that would be hundreds of pieces for
each, which are in one another's boxes just the same: then only longer ones are divided.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices, Integers
from ..compiled import compiled, compiled_for_threads
from .box_tree import box_ends, box_tree, groups
from .in_threads import in_threads

LONGEST = 1.0 / 20.0
"""Edge of a triangle that is not divided, in parts of the extent; doubled until there are few pieces."""
FOR_EACH, BESIDES = 2, 100_000
"""Pieces at most, for each triangle and besides."""
_WAITING = 256
"""Boxes that wait to be looked at, at most."""


class TriangleTree(NamedTuple):
    """Boxes around triangles, as `box_tree.BoxTree`; a leaf is eight triangles."""

    parts: Array
    """m, shape (boxes, 6, 8)."""
    shift: int
    corners: Array
    """Coordinates of the three corners of triangles or pieces of them, m, shape (leaves, 9, 8)."""
    owners: Indices
    """Number of the triangle that each is a piece of, shape (leaves, 8)."""


def triangle_tree(vertices: Array, faces: Integers) -> TriangleTree:
    """Return the tree of triangles.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3), f > 0.
    """
    corners, owners = pieces(vertices, faces)
    low, high = box_ends(corners)
    grouped, _ = groups(0.5 * (low + high))
    every = grouped.ravel()
    boxes = box_tree(low[every], high[every])
    sides = np.ascontiguousarray(corners[every].reshape(*grouped.shape, 9).transpose(0, 2, 1))
    return TriangleTree(boxes.parts[: -len(grouped)], boxes.shift, sides, owners[grouped])


def pieces(vertices: Array, faces: Integers) -> tuple[Array, Indices]:
    """Return triangles halved at their longest edges until none is long, and the triangle that each is of.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3), f > 0.

    Returns:
        Corners, m, shape (n, 3, 3), and numbers of triangles, shape (n,); n is at most 2 f + 100,000.
    """
    longest, most = LONGEST * float(np.ptp(vertices, axis=0).max()), FOR_EACH * len(faces) + BESIDES
    corners, owners = np.empty((most, 3, 3)), np.empty(most, dtype=np.intp)
    while (count := _pieces(vertices, faces, longest * longest, corners, owners)) > most:
        longest *= 2.0
    return corners[:count].copy(), owners[:count].copy()


@compiled
def _pieces(vertices: Array, faces: Integers, longest: float, corners: Array, owners: Indices) -> int:
    """Write pieces of triangles, with no edge whose square is longer, and their triangles, and return how many.

    There are more than told if it is one more than there is room for.
    """
    count, waiting = 0, np.empty((_WAITING, 3, 3))
    for n in range(len(faces)):
        for corner in range(3):
            waiting[0, corner] = vertices[faces[n, corner]]
        left = 1
        while left:
            one = waiting[left - 1]
            start, square = _longest_edge(one)
            if square > longest:
                other, end = waiting[left], (start + 1) % 3
                other[:] = one
                one[end] = other[start] = 0.5 * (one[start] + one[end])
                left += 1
                continue
            if count == len(corners):
                return count + 1
            corners[count], owners[count] = one, n
            count, left = count + 1, left - 1
    return count


@compiled
def _longest_edge(corners: Array) -> tuple[int, float]:
    """Return the corner of a triangle, shape (3, 3), at which its longest edge begins, and the square of that."""
    start, most = 0, -1.0
    for i in range(3):
        j = (i + 1) % 3
        x, y, z = corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1], corners[j, 2] - corners[i, 2]
        square = _length(x, y, z)
        if square > most:
            start, most = i, square
    return start, most


def nearest(tree: TriangleTree, points: Array) -> tuple[Array, Indices]:
    """Return distances of points, shape (n, 3), to the nearest triangles, m, and the numbers of these, shape (n,)."""
    distances, numbers = np.empty(len(points)), np.empty(len(points), dtype=np.intp)
    in_threads(_nearest, tree, np.ascontiguousarray(points), distances, numbers)
    return distances, numbers


@compiled_for_threads
def _nearest(tree: TriangleTree, points: Array, distances: Array, numbers: Indices) -> None:
    parts, shift, corners, boxes = tree.parts, tree.shift, tree.corners, len(tree.parts)
    waiting, bounds, squares = np.empty(_WAITING, dtype=np.intp), np.empty(_WAITING), np.empty(8)
    leaf = lane = 0
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        least, count = np.inf, 2
        waiting[0], bounds[0] = 0, 0.0
        waiting[1], bounds[1] = boxes + leaf, 0.0  # what is nearest to the point before is looked at first
        while count:
            count -= 1
            if bounds[count] >= least:
                continue
            box = waiting[count]
            if box >= boxes:
                _to_triangles(corners[box - boxes], x, y, z, squares)
                for j in range(8):
                    if squares[j] < least:
                        least, leaf, lane = squares[j], box - boxes, j
                continue
            _to_boxes(parts[box], x, y, z, squares)
            first = count
            for j in range(8):
                if squares[j] < least:
                    k = count
                    while k > first and bounds[k - 1] < squares[j]:  # the nearest one comes last: it is taken first
                        waiting[k], bounds[k] = waiting[k - 1], bounds[k - 1]
                        k -= 1
                    waiting[k], bounds[k] = 8 * box + j + shift, squares[j]
                    count += 1
        distances[n] = math.sqrt(least)
        numbers[n] = tree.owners[leaf, lane]


@compiled
def _to_boxes(ends: Array, x: float, y: float, z: float, squares: Array) -> None:
    """Write the squares of the distances of a point to boxes, shape (6, n).

    Their number is asked for here and below, although it is known: with a number that it knows, the compiler makes
    no use of instructions for several at once.
    """
    for j in range(ends.shape[1]):
        a = max(ends[0, j] - x, x - ends[3, j], 0.0)
        b = max(ends[1, j] - y, y - ends[4, j], 0.0)
        c = max(ends[2, j] - z, z - ends[5, j], 0.0)
        squares[j] = a * a + b * b + c * c


@compiled
def _to_triangles(corners: Array, x: float, y: float, z: float, squares: Array) -> None:
    """Write the squares of the distances of a point to triangles, shape (9, n)."""
    for j in range(corners.shape[1]):
        ax, ay, az = corners[0, j], corners[1, j], corners[2, j]
        bx, by, bz = corners[3, j] - ax, corners[4, j] - ay, corners[5, j] - az
        cx, cy, cz = corners[6, j] - ax, corners[7, j] - ay, corners[8, j] - az
        px, py, pz = x - ax, y - ay, z - az
        bb, bc, cc = bx * bx + by * by + bz * bz, bx * cx + by * cy + bz * cz, cx * cx + cy * cy + cz * cz
        pb, pc = px * bx + py * by + pz * bz, px * cx + py * cy + pz * cz
        area = bb * cc - bc * bc
        v, w = cc * pb - bc * pc, bb * pc - bc * pb
        above = (v > 0.0) & (w > 0.0) & (v + w < area)  # above the triangle itself
        v, w = v / area, w / area
        whole = _length(px - v * bx - w * cx, py - v * by - w * cy, pz - v * bz - w * cz)
        s = min(max(pb / bb, 0.0), 1.0) if bb > 0.0 else 0.0
        least = _length(px - s * bx, py - s * by, pz - s * bz)
        s = min(max(pc / cc, 0.0), 1.0) if cc > 0.0 else 0.0
        least = min(least, _length(px - s * cx, py - s * cy, pz - s * cz))
        dd = bb - 2.0 * bc + cc
        s = min(max((pc - pb - bc + bb) / dd, 0.0), 1.0) if dd > 0.0 else 0.0
        ex, ey, ez = bx + s * (cx - bx), by + s * (cy - by), bz + s * (cz - bz)
        least = min(least, _length(px - ex, py - ey, pz - ez))
        squares[j] = whole if above else least


@compiled
def _length(x: float, y: float, z: float) -> float:
    """Return the square of it."""
    return float(x * x + y * y + z * z)
