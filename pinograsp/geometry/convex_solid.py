"""Convex solids for Coal: hulls of points, and the pieces of shapes."""

from __future__ import annotations

from typing import Any, NamedTuple

import coal
import numpy as np

from ..arrays import Array

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
    """Return the convex hull of points, shape (n, 3), m, for Coal."""
    cloud = coal.StdVec_Vec3s()
    cloud.extend(list(points))
    return coal.Convex.convexHull(cloud, True, "Qt")
