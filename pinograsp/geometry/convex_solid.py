"""Convex solids for Coal: hulls of points, and the pieces of shapes."""

from __future__ import annotations

from typing import Any, NamedTuple

import coal
import numpy as np

from ..arrays import Array
from .few_corners import corners_around

FINENESS = (512, 256, 128, 64, 32)
"""Directions of polyhedra in place of a hull that Coal does not take; one of the last has too few corners for that."""
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

    Where one corner has more neighbours than Coal takes, fewer than 255, it is what `solid_corners` returns. What is
    thinner than a millionth of its length is made as thick as that.
    """
    return _taken(points)[1]


def solid_corners(points: Array) -> Array:
    """Return points whose convex hull contains the given ones, shape (n, 3), m, and is one that Coal takes.

    These are the points themselves but where one corner of their hull, as on the flat end of a fine cylinder, has too
    many neighbours: then they are corners of a polyhedron around it, some thousandth of a round part's radius larger.
    """
    return _taken(points)[0]


def _taken(points: Array) -> tuple[Array, Any]:
    """Return such points and their hull."""
    tried = points = thickened(points)
    for fineness in FINENESS:
        try:
            return tried, _hull(tried)
        except RuntimeError:
            tried = corners_around(points, fineness)
    return tried, _hull(tried)


def _hull(points: Array) -> Any:
    cloud = coal.StdVec_Vec3s()
    cloud.extend(list(points))
    return coal.Convex.convexHull(cloud, True, "Qt")


def thickened(points: Array) -> Array:
    """Return points, shape (n, 3), m, so thick that Coal makes a hull of them, which holds them all.

    They are the points themselves, but where these are too thin along one of their principal axes, as those of a sheet,
    others on both sides of them.
    """
    away = points - points.mean(axis=0)
    axes = np.linalg.svd(away.T @ away)[0].T
    lengths = np.ptp(away @ axes.T, axis=0)
    least = THINNEST * float(lengths.max())
    for axis in axes[lengths < least]:
        points = np.concatenate([points - 0.5 * least * axis, points + 0.5 * least * axis])
    return points
