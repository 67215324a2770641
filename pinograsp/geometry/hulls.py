"""Convex hulls of points with their facets, and points spread evenly over surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ..arrays import Array, Indices, Mask

_TOUCHING = 1e-6
"""Faces that meet are the same up to this, m."""


class FlatError(Exception):
    """Points in one plane have no hull with facets."""


class Hull:
    """The convex hull of points.

    Args:
        points: shape (n, 3), any frame, m.

    Raises:
        FlatError: the points lie in one plane, or there are none.
    """

    def __init__(self, points: Array) -> None:
        try:
            hull: Any = ConvexHull(points)
        except (QhullError, ValueError) as error:
            raise FlatError from error
        self.vertices: Array = points[hull.vertices]
        """Shape (k, 3)."""
        self.triangles: Array = points[hull.simplices]
        """The facets, shape (facets, 3, 3)."""
        self.areas: Array = areas(self.triangles)
        """Of the facets, m^2, shape (facets,)."""
        self.volume = float(hull.volume)
        """m^3."""
        self.normals: Array = hull.equations[:, :3]
        """Outward unit normals of the facets, shape (facets, 3)."""
        self.offsets: Array = -hull.equations[:, 3]
        """normal . p on the facets, m, shape (facets,)."""
        self._low, self._high = hull.min_bound - _TOUCHING, hull.max_bound + _TOUCHING

    def outside(self, points: Array) -> Array:
        """Return how far points, shape (n, 3), are beyond the facet that they are farthest beyond, m, shape (n,)."""
        return np.asarray((points @ self.normals.T - self.offsets).max(axis=1))

    def holds(self, points: Array, depth: float = -_TOUCHING) -> Mask:
        """Return which of the points, shape (n, 3), are in the hull or on it, or so deep in it, m."""
        inside: Mask = ((points >= self._low) & (points <= self._high)).all(axis=1)
        inside[inside] = (points[inside] @ self.normals.T <= -depth + self.offsets).all(axis=1)
        return inside


def areas(triangles: Array) -> Array:
    """Return the areas, m^2, shape (n,), of triangles, shape (n, 3, 3)."""
    a, b, c = triangles.transpose(1, 0, 2)
    x, y = b - a, c - a
    # |x cross y| by Lagrange's identity, which takes a fraction of the time of np.cross.
    xx, yy, xy = (x * x).sum(axis=1), (y * y).sum(axis=1), (x * y).sum(axis=1)
    return np.asarray(0.5 * np.sqrt(np.maximum(xx * yy - xy * xy, 0.0)))


def spread(triangles: Array, sizes: Array, count: int) -> Array:
    """Return points spread evenly over triangles, at the same places every time.

    Args:
        triangles: shape (n, 3, 3).
        sizes: their areas, shape (n,).
        count: number of points.

    Returns:
        Shape (count, 3).
    """
    parts, u, v = _pattern(count)
    along = sizes.cumsum()
    chosen = np.minimum(np.searchsorted(along, parts * along[-1]), len(triangles) - 1)
    a, b, c = triangles[chosen].transpose(1, 0, 2)
    return np.asarray(a + u * (b - a) + v * (c - a))


@lru_cache(maxsize=512)
def _pattern(count: int) -> tuple[Array, Array, Array]:
    """Return a number from each of `count` equal parts of [0, 1], and u and v with u + v <= 1, shape (count, 1)."""
    rng = np.random.default_rng(0)
    parts = (np.arange(count) + rng.random(count)) / count
    u, v = rng.random((2, count, 1))
    outside = u + v > 1.0
    return parts, np.where(outside, 1.0 - u, u), np.where(outside, 1.0 - v, v)


def boundary(hulls: Sequence[Hull], count: int, around: Sequence[Hull] = ()) -> tuple[Array, Indices]:
    """Return points spread evenly over the outer boundary of a union, and which hull each is of.

    What lies in another hull is not on that boundary, nor are the faces along which hulls meet.

    Args:
        hulls: their boundaries get the points.
        count: number of points before those within another hull are taken out.
        around: further hulls of the union.

    Returns:
        Shapes (n, 3) and (n,), n < count + len(hulls).
    """
    shares = np.array([hull.areas.sum() for hull in hulls])
    counts = np.ceil(count * shares / shares.sum()).astype(int).tolist()
    points, owners = [], []
    for k, (hull, number) in enumerate(zip(hulls, counts, strict=True)):
        outer = spread(hull.triangles, hull.areas, number)
        for other in [*hulls[:k], *hulls[k + 1 :], *around]:
            outer = outer[~other.holds(outer)]
        points.append(outer)
        owners.append(np.full(len(outer), k))
    return np.concatenate(points), np.concatenate(owners)
