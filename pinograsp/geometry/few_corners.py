"""Convex polyhedra of few corners that contain many points and stand off them a little.

The points that are farthest along fixed directions, and those that are farthest beyond the hull of these, are corners
of an inner hull. Each of its facets is moved outwards to the last of all points; what is behind all these planes
contains every point. With n directions it stands off by some 1 / n of the radius of what is round, and not at all of a
box.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import HalfspaceIntersection, QhullError

from ..arrays import Array, Indices
from .hulls import Hull

_AT_ONCE = 2_000_000
"""Products of points and directions that are held in memory."""
_SLACK = 1e-9
"""Of its size, by which a polyhedron is larger: more than what rounding takes away."""


def corners_around(points: Array, count: int) -> Array:
    """Return the corners of a convex polyhedron that contains points.

    Args:
        points: shape (n, 3), m.
        count: number of directions from which it is made.

    Returns:
        Shape (k, 3), m, k some ten times the number of directions at most.

    Raises:
        FlatError: the points lie in one plane.
    """
    points = _once(points)
    inner, _ = _farthest(points, fan(count))
    beyond, _ = _farthest(points, Hull(points[inner]).normals)
    hull = Hull(points[np.union1d(inner, beyond)])
    normals = np.unique(hull.normals.round(12), axis=0)
    _, heights = _farthest(points, normals)
    middle = hull.vertices.mean(axis=0)
    size = float(np.ptp(hull.vertices, axis=0).max())
    inwards = (heights - normals @ middle) / size + _SLACK
    try:
        planes = np.column_stack([normals, -inwards])
        corners = HalfspaceIntersection(planes, np.zeros(3)).intersections
        return np.asarray(middle + size * corners[np.isfinite(corners).all(axis=1)])
    except QhullError:  # too thin to be made of planes
        return _box_around(hull.vertices, points)


def _once(points: Array) -> Array:
    """Return every point once: as corners of triangles they come six times."""
    order = np.lexsort(points.T)
    ordered = points[order]
    return np.asarray(ordered[np.append(True, (ordered[1:] != ordered[:-1]).any(axis=1))])


def _farthest(points: Array, directions: Array) -> tuple[Indices, Array]:
    """Return which points, shape (k,), are farthest along directions, shape (m, 3), and how far, shape (m,)."""
    step = max(1, _AT_ONCE // len(directions))
    best, heights = np.zeros(len(directions), dtype=np.int64), np.full(len(directions), -np.inf)
    for first in range(0, len(points), step):
        along = directions @ points[first : first + step].T
        chosen = along.argmax(axis=1)
        found = along[np.arange(len(directions)), chosen]
        better = found > heights
        best[better], heights[better] = chosen[better] + first, found[better]
    return np.unique(best), heights


def _box_around(corners: Array, points: Array) -> Array:
    """Return the corners of the box along the principal axes of some corners that contains points."""
    axes = np.linalg.svd(corners - corners.mean(axis=0), full_matrices=False)[2]
    along = points @ axes.T
    ends = np.stack([along.min(axis=0), along.max(axis=0)])
    ends += np.array([[-1.0], [1.0]]) * _SLACK * float(np.ptp(ends, axis=0).max())
    return np.asarray(np.array(np.meshgrid(*ends.T)).reshape(3, -1).T @ axes)


def fan(count: int) -> Array:
    """Return directions spread evenly by the golden angle, shape (count, 3)."""
    k = np.arange(count) + 0.5
    z, longitude = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    rho = np.sqrt(1.0 - z * z)
    return np.column_stack([rho * np.cos(longitude), rho * np.sin(longitude), z])
