"""A ball: d = |p| - r."""

from __future__ import annotations

import coal
import numpy as np
import trimesh

from ...arrays import Array
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
        norm = np.sqrt((points * points).sum(axis=1))
        centred = norm == 0.0
        if centred.any():
            points = np.where(centred[:, None], [1.0, 0.0, 0.0], points)
        length = np.where(centred, 1.0, norm)
        normals = points / length[:, None]
        hessians = (np.eye(3) - normals[:, :, None] * normals[:, None, :]) / length[:, None, None]
        return norm - self.radius, normals, hessians

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
