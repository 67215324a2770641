"""A ball: d = |p| - r."""

from __future__ import annotations

import math

import coal
import numpy as np
import trimesh

from ...arrays import Array
from ...compiled import compiled
from ...descriptions.shapes import Sphere
from ..contact_faces import ContactFace, Spot
from ..convex_solid import ConvexPiece
from ..tessellation import Tessellation, tessellation_of
from .convex import Convex

SUBDIVISIONS = 3
"""Halvings of an icosahedron's triangles for a tessellation: 1280 triangles."""


class SphereSurface(Convex):
    """Geometry of a ball around the origin; at the very centre the gradient is taken along x."""

    edged = False

    def __init__(self, shape: Sphere) -> None:
        self.radius = shape.radius
        self.least_width = 2.0 * shape.radius

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient p / |p| and Hessian (I - n n^T) / |p|."""
        return _signed_distance(points, self.radius)

    def contact_face(self, point: Array) -> ContactFace:
        """Return a spot."""
        return Spot()

    def extent(self, direction: Array) -> float:
        """Return r |direction|."""
        return float(self.radius * np.linalg.norm(direction))

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return a coal.Sphere."""
        return (ConvexPiece(coal.Sphere(self.radius)),)

    def tessellation(self) -> Tessellation:
        """Return an icosahedron whose triangles are halved `SUBDIVISIONS` times; its corners lie on the ball."""
        return tessellation_of(trimesh.creation.icosphere(subdivisions=SUBDIVISIONS, radius=self.radius))


@compiled
def _signed_distance(points: Array, radius: float) -> tuple[Array, Array, Array]:
    n = len(points)
    distances, normals, hessians = np.empty(n), np.empty((n, 3)), np.empty((n, 3, 3))
    for i in range(n):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        length = math.sqrt(x * x + y * y + z * z)
        distances[i] = length - radius
        for k in range(3):
            normals[i, k] = points[i, k] / length if length > 0.0 else (1.0 if k == 0 else 0.0)
        for j in range(3):
            for k in range(3):
                across = (1.0 if j == k else 0.0) - normals[i, j] * normals[i, k]
                hessians[i, j, k] = across / length if length > 0.0 else across
    return distances, normals, hessians
