"""The surface of a shape as meshcat draws it: smooth where it is curved, sharp at its edges."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..geometry.shapes import Surface
from ..geometry.tessellation import Tessellation
from .viewer import geometry

INTO_FACET = 1e-3
"""How far from a triangle's corner to its middle the normal is taken: off the edge that the corner may lie on."""
DIGITS = 3
"""Decimals of normals; corners of one vertex that agree in them are joined."""


class _SmoothMesh(geometry.TriangularMeshGeometry):  # type: ignore[misc]
    """Triangles with the normals of the surface that they stand for; three.js shades flat facets otherwise."""

    def __init__(self, vertices: Array, triangles: Any, normals: Array, paint: Array | None) -> None:
        super().__init__(vertices, triangles, paint)
        self.normals = normals

    def lower(self, object_data: Any) -> Any:
        """Return the geometry as three.js reads it."""
        data = super().lower(object_data)
        attributes = data["data"]["attributes"]
        attributes["normal"] = geometry.pack_numpy_array(self.normals.T)
        return data


def surface_mesh(surface: Surface, tessellation: Tessellation, paint: Array | None = None) -> Any:
    """Return a meshcat geometry of a tessellated surface.

    Args:
        surface: gives the normals.
        tessellation: its triangles, m of them.
        paint: colour of every triangle, red, green and blue in [0, 1], shape (m, 3); none if not given.
    """
    corners = tessellation.corners
    beside = corners + INTO_FACET * (corners.mean(axis=1, keepdims=True) - corners)
    normals = np.round(surface.signed_distance(beside.reshape(-1, 3))[1], DIGITS) + 0.0  # no -0
    colors = np.zeros_like(normals) if paint is None else np.repeat(paint, 3, axis=0)
    seen = np.column_stack([tessellation.triangles.reshape(-1), normals, colors])
    _, first, joined = np.unique(seen, axis=0, return_index=True, return_inverse=True)
    return _SmoothMesh(
        corners.reshape(-1, 3)[first],
        joined.reshape(-1, 3),
        normals[first],
        None if paint is None else colors[first],
    )
