"""Points that are fixed to bodies, in trees of balls: the one nearest to a surface is found without most others.

A ball around some points holds them; the signed distance d of its centre less its radius is no more than that of any
of them, since d grows by no more than the way. The children of a ball are looked at nearest first, and left out if they
cannot hold anything nearer than what is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled

LEAF = 16
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
    centers: list[Array] = []
    radii: list[float] = []
    parts: list[tuple[int, int]] = []
    ordered: list[Array] = []
    count = 0

    def ball(points: Array) -> int:
        nonlocal count
        number = len(centers)
        low, high = points.min(axis=0), points.max(axis=0)
        center = 0.5 * (low + high)
        centers.append(center)
        radii.append(float(np.sqrt(((points - center) ** 2).sum(axis=1).max())))
        parts.append((count, -1 - len(points)))
        if len(points) <= LEAF:
            ordered.append(points)
            count += len(points)
            return number
        order = points[:, int((high - low).argmax())].argsort(kind="stable")
        half = len(points) // 2
        parts[number] = ball(points[order[:half]]), ball(points[order[half:]])
        return number

    roots = [ball(points) for points in sets]
    return PointTrees(
        np.array(bodies, dtype=np.intp),
        np.array(roots, dtype=np.intp),
        np.array(centers).reshape(-1, 3),
        np.array(radii),
        np.array(parts, dtype=np.intp).reshape(-1, 2),
        np.concatenate([*ordered, np.zeros((0, 3))]),
    )


@compiled
def deepest_point(trees: PointTrees, normals: Array, offsets: Array) -> tuple[float, Array, int]:
    """Return how far the first set is outside a convex solid, negative inside, m, its point there, and the facet.

    Args:
        trees: the set.
        normals: outward unit normals of the facets in the frame of the set, shape (k, 3).
        offsets: normal . p on the facets, m, shape (k,).
    """
    least, nearest, facet = np.inf, np.zeros(3), 0
    waiting, bounds = np.empty(_DEPTH, dtype=np.intp), np.empty(_DEPTH)
    waiting[0], bounds[0] = trees.roots[0], -np.inf
    count = 1
    while count:
        count -= 1
        if bounds[count] >= least:
            continue
        first, second = trees.parts[waiting[count]]
        if second < 0:
            for k in range(first, first - 1 - second):
                value, which = _outside(normals, offsets, trees.points[k])
                if value < least:
                    least, facet = value, which
                    nearest[:] = trees.points[k]
            continue
        one = _outside(normals, offsets, trees.centers[first])[0] - trees.radii[first]
        other = _outside(normals, offsets, trees.centers[second])[0] - trees.radii[second]
        if one < other:
            first, second, one, other = second, first, other, one
        waiting[count], bounds[count] = first, one
        waiting[count + 1], bounds[count + 1] = second, other
        count += 2
    return least, nearest, facet


@compiled
def _outside(normals: Array, offsets: Array, point: Array) -> tuple[float, int]:
    """Return how far a point is beyond the facet that it is farthest beyond, m, and which that is."""
    most, facet = -np.inf, 0
    for k in range(len(offsets)):
        beyond = -offsets[k]
        for axis in range(3):
            beyond += normals[k, axis] * point[axis]
        if beyond > most:
            most, facet = beyond, k
    return most, facet
