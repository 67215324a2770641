"""Circles as polygons, and cones as convex solids of flat sides."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import coal
import numpy as np

from ...arrays import Array

_ARC = 2e-7
"""How far an arc may bulge out of the polygon that stands for it, m."""


@lru_cache(maxsize=64)
def circle(radius: float, height: float) -> Array:
    """Return the corners of a polygon on a circle across z, no arc of which bulges more than `_ARC`, shape (n, 3)."""
    count = max(16, math.ceil(math.pi / math.acos(max(0.0, 1.0 - _ARC / radius)))) if radius > 0.0 else 1
    angles = np.arange(count) * (2 * math.pi / count)
    corners = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(count, height)])
    corners.flags.writeable = False  # all who ask get this one
    return corners


def turned(rims: Array) -> Any:
    """Return a cone between two rims (radius, height), shape (2, 2), as a convex solid of flat sides for Coal.

    Its corners have few neighbours each, of which Coal bears 255: ends are cut into zigzags, and a tip is blunt.
    """
    count = len(circle(float(rims[:, 0].max()), 0.0))
    angles = np.arange(count) * (2 * math.pi / count)
    corners, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for radius, height in rims:
        r = max(float(radius), 0.5 * _ARC)
        corners.extend(list(np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(count, height)])))
    order = [k // 2 if k % 2 == 0 else count - 1 - k // 2 for k in range(count)]
    for k in range(count - 2):
        a, b, c = sorted(order[k : k + 3])
        triangles.append(coal.Triangle(c, b, a))
        triangles.append(coal.Triangle(count + a, count + b, count + c))
    for k in range(count):
        following = (k + 1) % count
        triangles.append(coal.Triangle(k, following, count + following))
        triangles.append(coal.Triangle(k, count + following, count + k))
    return coal.Convex(corners, triangles)
