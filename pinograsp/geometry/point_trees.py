"""Points that are fixed to bodies, in trees of balls: the one nearest to a surface is found without most others.

A ball around some points holds them; the signed distance d of its centre less its radius is no more than that of any
of them, since d grows by no more than the way. The children of a ball are looked at nearest first, and left out if they
cannot hold anything nearer than what is known.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled

LEAF = 6
"""Points of a ball that is not divided any more, at most."""
_DEPTH = 64


class PointTrees(NamedTuple):
    """Sets of points, each in a tree of balls; in the frames of their bodies."""

    bodies: Indices
    """Number of the body that each set is fixed to, shape (sets,)."""
    roots: Indices
    """Ball of each set that holds all of it, shape (sets,)."""
    balls: Array
    """Centre and radius, m, shape (balls, 4)."""
    parts: Indices
    """The first of the two children of a ball, which follow each other, and 0; if it is not divided, its first point
    and their number; shape (balls, 2)."""
    points: Array
    """m, shape (points, 3)."""


def point_trees(sets: Sequence[Array], bodies: Sequence[int]) -> PointTrees:
    """Return trees of sets of points, each of shape (n, 3), n > 0, which are fixed to bodies."""
    sizes = np.array([len(points) for points in sets], dtype=np.intp)
    points = np.concatenate([*sets, np.zeros((0, 3))])
    return PointTrees(np.array(bodies, dtype=np.intp), *_divided(points, sizes))


@compiled
def _divided(points: Array, sizes: Indices) -> tuple[Indices, Array, Indices, Array]:
    """Return roots, balls, parts and points of trees of so many points each."""
    most = 2 * len(points)
    roots, balls, parts = np.empty(len(sizes), dtype=np.intp), np.empty((most, 4)), np.empty((most, 2), dtype=np.intp)
    order, made, begin = np.arange(len(points)), 0, 0
    waiting = np.empty((_DEPTH, 3), dtype=np.intp)  # balls, and their first and last points
    for tree in range(len(sizes)):
        roots[tree] = made
        waiting[0, 0], waiting[0, 1], waiting[0, 2] = made, begin, begin + sizes[tree]
        begin, made, count = begin + sizes[tree], made + 1, 1
        while count:
            count -= 1
            ball, first, last = waiting[count]
            own = points[order[first:last]]
            widest = _surround(own, balls[ball])
            if last - first <= LEAF:
                parts[ball, 0], parts[ball, 1] = first, last - first
                continue
            order[first:last] = order[first:last][own[:, widest].argsort(kind="mergesort")]
            half = first + (last - first) // 2
            parts[ball, 0], parts[ball, 1] = made, 0
            waiting[count, 0], waiting[count, 1], waiting[count, 2] = made + 1, half, last
            waiting[count + 1, 0], waiting[count + 1, 1], waiting[count + 1, 2] = made, first, half
            made, count = made + 2, count + 2
    return roots, balls[:made].copy(), parts[:made].copy(), points[order]


@compiled
def _surround(points: Array, ball: Array) -> int:
    """Write centre and radius of a ball around points, shape (n, 3); return the axis along which these reach farthest.

    The centre is that of their bounding box.
    """
    widest, longest, square = 0, -1.0, 0.0
    for axis in range(3):
        low, high = points[:, axis].min(), points[:, axis].max()
        ball[axis] = 0.5 * (low + high)
        if high - low > longest:
            widest, longest = axis, high - low
    for k in range(len(points)):
        x, y, z = points[k, 0] - ball[0], points[k, 1] - ball[1], points[k, 2] - ball[2]
        square = max(square, x * x + y * y + z * z)
    ball[3] = math.sqrt(square)
    return widest


@compiled
def deepest_point(trees: PointTrees, normals: Array, offsets: Array) -> tuple[float, Array, int]:
    """Return how far the first set is outside a convex solid, negative inside, m, its point there, and the facet.

    Args:
        trees: the set.
        normals: outward unit normals of the facets in the frame of the set, shape (k, 3).
        offsets: normal . p on the facets, m, shape (k,).
    """
    least, nearest, facet, last = np.inf, np.zeros(3), 0, 0
    waiting, bounds = np.empty(_DEPTH, dtype=np.intp), np.empty(_DEPTH)
    waiting[0], bounds[0] = trees.roots[0], -np.inf
    balls, parts, points = trees.balls, trees.parts, trees.points
    count = 1
    while count:
        count -= 1
        if bounds[count] >= least:
            continue
        first, leaf = parts[waiting[count], 0], parts[waiting[count], 1]
        if leaf:
            for k in range(first, first + leaf):
                value, last = _outside(normals, offsets, points[k], least, last)
                if value < least:
                    least, facet = value, last
                    nearest[:] = points[k]
            continue
        second = first + 1
        one, last = _outside(normals, offsets, balls[first], least + balls[first, 3], last)
        other, last = _outside(normals, offsets, balls[second], least + balls[second, 3], last)
        one -= balls[first, 3]
        other -= balls[second, 3]
        if one < other:
            first, second, one, other = second, first, other, one
        waiting[count], bounds[count] = first, one
        waiting[count + 1], bounds[count + 1] = second, other
        count += 2
    return least, nearest, facet


@compiled
def _outside(normals: Array, offsets: Array, point: Array, enough: float, likely: int) -> tuple[float, int]:
    """Return how far a point is beyond the facet that it is farthest beyond, m, and which that is.

    The facet that is likely is asked first; as soon as one is found beyond which it is far enough, others are not.
    """
    most, facet, x, y, z = -np.inf, likely, point[0], point[1], point[2]
    for k in range(-1, len(offsets)):
        which = likely if k < 0 else k
        beyond = normals[which, 0] * x + normals[which, 1] * y + normals[which, 2] * z - offsets[which]
        if beyond > most:
            most, facet = beyond, which
            if most >= enough:
                break
    return most, facet
