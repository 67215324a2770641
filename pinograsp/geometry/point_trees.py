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
