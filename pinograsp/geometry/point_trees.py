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
    centers: Array
    """Of the balls, m, shape (balls, 3)."""
    radii: Array
    """m, shape (balls,)."""
    parts: Indices
    """Two children of a ball; if it is not divided, its first point and -1 less their number; shape (balls, 2)."""
    points: Array
    """m, shape (points, 3)."""


def point_trees(sets: Sequence[Array], bodies: Sequence[int]) -> PointTrees:
    """Return trees of sets of points, each of shape (n, 3), n > 0, which are fixed to bodies."""
    sizes = np.array([len(points) for points in sets], dtype=np.intp)
    points = np.concatenate([*sets, np.zeros((0, 3))])
    return PointTrees(np.array(bodies, dtype=np.intp), *_divided(points, sizes))


@compiled
def _divided(points: Array, sizes: Indices) -> tuple[Indices, Array, Array, Indices, Array]:
    """Return roots, centers, radii, parts and points of trees of so many points each."""
    most = 2 * len(points)
    roots, parts = np.empty(len(sizes), dtype=np.intp), np.empty((most, 2), dtype=np.intp)
    centers, radii = np.empty((most, 3)), np.empty(most)
    order, balls, begin = np.arange(len(points)), 0, 0
    waiting = np.empty((_DEPTH, 2), dtype=np.intp)  # first and last points of balls that are not made yet
    above = np.empty((_DEPTH, 2), dtype=np.intp)  # the balls that they are parts of, and which
    for tree in range(len(sizes)):
        roots[tree] = balls
        waiting[0, 0], waiting[0, 1], above[0, 0] = begin, begin + sizes[tree], -1
        begin, count = begin + sizes[tree], 1
        while count:
            count -= 1
            first, last = waiting[count, 0], waiting[count, 1]
            if above[count, 0] >= 0:
                parts[above[count, 0], above[count, 1]] = balls
            own = points[order[first:last]]
            widest, longest, square = 0, -1.0, 0.0
            for axis in range(3):
                low, high = own[:, axis].min(), own[:, axis].max()
                centers[balls, axis] = 0.5 * (low + high)
                if high - low > longest:
                    widest, longest = axis, high - low
            for k in range(len(own)):
                away = own[k] - centers[balls]
                square = max(square, away[0] ** 2 + away[1] ** 2 + away[2] ** 2)
            radii[balls] = math.sqrt(square)
            if last - first <= LEAF:
                parts[balls, 0], parts[balls, 1] = first, -1 - (last - first)
            else:
                order[first:last] = order[first:last][own[:, widest].argsort(kind="mergesort")]
                half = first + (last - first) // 2
                waiting[count, 0], waiting[count, 1] = half, last
                waiting[count + 1, 0], waiting[count + 1, 1] = first, half  # the first half is made first
                above[count : count + 2, 0] = balls
                above[count, 1], above[count + 1, 1] = 1, 0
                count += 2
            balls += 1
    return roots, centers[:balls].copy(), radii[:balls].copy(), parts[:balls].copy(), points[order]


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
    parts, points, centers, radii = trees.parts, trees.points, trees.centers, trees.radii
    count = 1
    while count:
        count -= 1
        if bounds[count] >= least:
            continue
        first, second = parts[waiting[count], 0], parts[waiting[count], 1]
        if second < 0:
            for k in range(first, first - 1 - second):
                value, last = _outside(normals, offsets, points[k], least, last)
                if value < least:
                    least, facet = value, last
                    nearest[:] = points[k]
            continue
        one, last = _outside(normals, offsets, centers[first], least + radii[first], last)
        other, last = _outside(normals, offsets, centers[second], least + radii[second], last)
        one -= radii[first]
        other -= radii[second]
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
