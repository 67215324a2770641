"""The surface of a shape as meshcat draws it: smooth where it is curved, sharp at its edges."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..geometry.shapes import Surface
from ..geometry.tessellation import Tessellation
from .viewer import geometry

INWARD, OUTWARD = 1e-6, 0.01
"""Where normals are taken: off the corner of a triangle towards its middle, as a part of that way, and off the
triangle to the outside, in radii of the shape. So an edge on which the corner lies does not count."""
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
    normals = np.round(_normals(surface, corners), DIGITS) + 0.0  # no -0
    colors = np.zeros_like(normals) if paint is None else np.repeat(paint, 3, axis=0)
    seen = np.column_stack([tessellation.triangles.reshape(-1), normals, colors])
    _, first, joined = np.unique(seen, axis=0, return_index=True, return_inverse=True)
    return _SmoothMesh(
        corners.reshape(-1, 3)[first],
        joined.reshape(-1, 3),
        normals[first],
        None if paint is None else colors[first],
    )


def _normals(surface: Surface, corners: Array) -> Array:
    """Return the surface's normal at every corner of triangles, each seen from its triangle; shape (3 m, 3)."""
    facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.repeat(facets / np.linalg.norm(facets, axis=1, keepdims=True), 3, axis=0)
    inward = (corners + INWARD * (corners.mean(axis=1, keepdims=True) - corners)).reshape(-1, 3)
    for _ in range(2):  # the second time along the surface's own normal: the same for all triangles of a corner
        normals = surface.signed_distance(inward + OUTWARD * surface.radius * normals)[1]
    return normals
