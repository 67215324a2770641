"""A capsule: the distance from a part of the z axis, less the radius."""

from __future__ import annotations

import coal
import numpy as np
import trimesh

from ...arrays import Array
from ...descriptions.shapes import Capsule
from ..contact_faces import ContactFace, Ruling, Spot
from ..convex_solid import ConvexPiece
from ..tessellation import Tessellation, tessellation_of
from .convex import Convex

SECTIONS = 32
"""Sides of its tessellation, and rings of its two half balls."""


class CapsuleSurface(Convex):
    """Geometry of a capsule around the z axis; on the axis the normal is taken along x."""

    edged = False

    def __init__(self, shape: Capsule) -> None:
        self._radius, self._half = shape.radius, 0.5 * shape.length
        self.radius = self._half + self._radius
        self.least_width = 2.0 * shape.radius

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian; beside the axis nothing bends along it."""
        apart = points.copy()
        apart[:, 2] -= np.clip(points[:, 2], -self._half, self._half)
        length = np.sqrt((apart * apart).sum(axis=1))
        apart[length == 0.0] = [1.0, 0.0, 0.0]
        divisor = np.where(length > 0.0, length, 1.0)
        normals = apart / divisor[:, None]
        hessians = np.eye(3) - normals[:, :, None] * normals[:, None, :]
        hessians[np.abs(points[:, 2]) <= self._half, 2, 2] = 0.0
        return length - self._radius, normals, hessians / divisor[:, None, None]

    def contact_face(self, point: Array) -> ContactFace:
        """Return the straight line of the side, which ends where the half balls begin, or a spot of these."""
        if abs(point[2]) > self._half:
            return Spot()
        return Ruling(np.array([0.0, 0.0, 1.0]), -self._half - point[2], self._half - point[2], sharp=(False, False))

    def extent(self, direction: Array) -> float:
        """Return r |direction| + l/2 |direction along the axis|."""
        return float(self._radius * np.linalg.norm(direction) + self._half * abs(direction[2]))

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return a coal.Capsule."""
        return (ConvexPiece(coal.Capsule(self._radius, 2.0 * self._half)),)

    def tessellation(self) -> Tessellation:
        """Return triangles whose corners lie on the capsule."""
        return tessellation_of(trimesh.creation.capsule(2.0 * self._half, self._radius, count=[SECTIONS, SECTIONS]))
