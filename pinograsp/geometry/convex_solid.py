"""Convex hulls of points as Coal's solids."""

from __future__ import annotations

from typing import Any

import coal

from ..arrays import Array


def convex_solid(points: Array) -> Any:
    """Return the convex hull of points, shape (n, 3), m, for Coal."""
    cloud = coal.StdVec_Vec3s()
    cloud.extend(list(points))
    return coal.Convex.convexHull(cloud, True, "Qt")
