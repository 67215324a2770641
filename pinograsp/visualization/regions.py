"""The object's surface painted by where contact is allowed (green) and forbidden (red)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..descriptions.regions import Region
from ..descriptions.shapes import Shape
from ..geometry.shapes import surface_of
from ..geometry.tessellation import refined
from ..verification.regions import depths
from . import colors
from .surfaces import surface_mesh

TRIANGLE = 0.004
"""Longest edge of a painted triangle, m: borders of regions are drawn this well."""


def painted_surface(shape: Shape, region: Region) -> Any:
    """Return a meshcat geometry of a shape whose triangles have the colour of their middle."""
    surface = surface_of(shape)
    tessellation = refined(surface.tessellation(), TRIANGLE)
    allowed = depths(region, tessellation.corners.mean(axis=1)) >= 0.0
    paint = np.where(allowed[:, None], _rgb(colors.ALLOWED), _rgb(colors.FORBIDDEN))
    return surface_mesh(surface, tessellation, paint)


def _rgb(color: int) -> list[float]:
    return [(color >> shift & 0xFF) / 255 for shift in (16, 8, 0)]
