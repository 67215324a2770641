"""Convex solids for Coal: hulls of points, and the pieces of shapes."""

from __future__ import annotations

from typing import Any, NamedTuple

import coal
import numpy as np

from ..arrays import Array
from .covers import fan
from .hulls import Hull

NEIGHBOURS = 250
"""Corners that a hull may have for certain: Coal wants fewer than 256 neighbours of each."""
THINNEST = 1e-6
"""Of its length: thinner points have no hull that Coal could make, it ends the process."""
IDENTITY = np.eye(4)


class ConvexPiece(NamedTuple):
    """A convex piece of a shape."""

    geometry: Any
    """For Coal."""
    placement: Array = IDENTITY
    """Pose of the geometry in the shape's frame, shape (4, 4)."""
    part: int = 0
    """Which part of the shape it belongs to; 0 but in a compound."""


def convex_solid(points: Array) -> Any:
    """Return the convex hull of points, shape (n, 3), m, for Coal.

    Where one corner has more neighbours than Coal takes, as on the flat end of a fine cylinder, it is a hull of fewer
    corners, a little larger so that it holds all of them. What is thinner than a millionth of its length is made as
    thick as that.
    """
    points = _thickened(points)
    try:
        return _hull(points)
    except RuntimeError:
        return _hull(_fewer(points))


def _hull(points: Array) -> Any:
    cloud = coal.StdVec_Vec3s()
    cloud.extend(list(points))
    return coal.Convex.convexHull(cloud, True, "Qt")


def _thickened(points: Array) -> Array:
    """Return points, and where they are too thin along one of their principal axes, others on both sides of them."""
    away = points - points.mean(axis=0)
    axes = np.linalg.svd(away.T @ away)[0].T
    lengths = np.ptp(away @ axes.T, axis=0)
    least = THINNEST * float(lengths.max())
    for axis in axes[lengths < least]:
        points = np.concatenate([points - 0.5 * least * axis, points + 0.5 * least * axis])
    return points


def _fewer(points: Array) -> Array:
    """Return corners that are farthest along directions all around, moved away from their middle to hold all points."""
    chosen = points[np.unique((points @ fan(NEIGHBOURS).T).argmax(axis=0))]
    hull = Hull(chosen)
    middle = hull.vertices.mean(axis=0)
    heights = (hull.normals * (hull.triangles[:, 0] - middle)).sum(axis=1)
    beyond = ((points - middle) @ hull.normals.T).max(axis=0) / heights
    return np.asarray(middle + max(1.0, float(beyond.max())) * (hull.vertices - middle))
