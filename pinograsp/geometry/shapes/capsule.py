"""A capsule: the distance from a part of the z axis, less the radius."""

from __future__ import annotations

import math

import coal
import numpy as np
import trimesh

from ...arrays import Array
from ...compiled import compiled
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
        return _signed_distance(points, self._radius, self._half)

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


@compiled
def _signed_distance(points: Array, radius: float, half: float) -> tuple[Array, Array, Array]:
    n = len(points)
    distances, gradients, hessians = np.empty(n), np.empty((n, 3)), np.empty((n, 3, 3))
    for i in range(n):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        normal = np.array([x, y, z - min(max(z, -half), half)])
        length = math.sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2])
        divisor = length if length > 0.0 else 1.0
        if length == 0.0:
            normal[0] = 1.0
        normal /= divisor
        distances[i], gradients[i] = length - radius, normal
        for k in range(3):
            for m in range(3):
                hessians[i, k, m] = ((1.0 if k == m else 0.0) - normal[k] * normal[m]) / divisor
        if abs(z) <= half:
            hessians[i, 2, 2] = 0.0
    return distances, gradients, hessians
