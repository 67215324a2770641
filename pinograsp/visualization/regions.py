"""The object's surface painted by where contact is allowed (green) and forbidden (red)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import trimesh

from ..descriptions.regions import Region
from ..descriptions.shapes import Box, Cylinder, Sphere
from ..verification.regions import depth
from . import colors
from .viewer import geometry

TRIANGLE = 0.003
"""Longest edge of a painted triangle, m: borders of regions are drawn this well."""

MESHES: dict[type, Callable[[Any], trimesh.Trimesh]] = {
    Sphere: lambda shape: trimesh.creation.icosphere(subdivisions=3, radius=shape.radius),
    Box: lambda shape: trimesh.creation.box(extents=shape.size),
    Cylinder: lambda shape: trimesh.creation.cylinder(radius=shape.radius, height=shape.height, sections=96),
}
"""A mesh of each shape of the scene file, in its own frame."""


def painted_surface(shape: Any, region: Region) -> Any:
    """Return a meshcat geometry of a shape whose triangles have the colour of their middle."""
    mesh = MESHES[type(shape)](shape).subdivide_to_size(TRIANGLE)
    allowed = np.array([depth(region, middle) >= 0.0 for middle in mesh.triangles_center])
    paint = np.where(allowed[:, None], _rgb(colors.ALLOWED), _rgb(colors.FORBIDDEN))
    vertices = mesh.triangles.reshape(-1, 3)
    faces = np.arange(len(vertices)).reshape(-1, 3)
    return geometry.TriangularMeshGeometry(vertices, faces, np.repeat(paint, 3, axis=0))


def _rgb(color: int) -> list[float]:
    return [(color >> shift & 0xFF) / 255 for shift in (16, 8, 0)]
