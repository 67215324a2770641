"""A box: outside, the distance to the nearest point of it; inside, minus the depth below the nearest face."""

from __future__ import annotations

import math

import coal
import numpy as np
import trimesh

from ...arrays import Array
from ...compiled import compiled
from ...descriptions.shapes import Box
from ..contact_faces import ContactFace, Flat
from ..convex_solid import ConvexPiece
from ..tessellation import Tessellation, tessellation_of
from .convex import Convex


class BoxSurface(Convex):
    """Geometry of a box around the origin, edges along the axes."""

    def __init__(self, shape: Box) -> None:
        self._half = 0.5 * np.array(shape.size)
        self.radius = float(np.linalg.norm(self._half))
        self.least_width = min(shape.size)

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian; the Hessian is not zero only outside, off edges and corners."""
        return _signed_distance(points, self._half)

    def contact_face(self, point: Array) -> ContactFace:
        """Return the face that is nearest to the point, of those at an edge one."""
        axis = int((np.abs(point) - self._half).argmax())
        sign = -1.0 if point[axis] < 0.0 else 1.0
        first, second = ((axis + 1) % 3, (axis + 2) % 3) if sign > 0.0 else ((axis + 2) % 3, (axis + 1) % 3)
        corners = np.empty((4, 3))
        corners[:, axis] = sign * self._half[axis]
        corners[:, first] = self._half[first] * np.array([-1.0, 1.0, 1.0, -1.0])
        corners[:, second] = self._half[second] * np.array([-1.0, -1.0, 1.0, 1.0])
        return Flat(corners, sign * np.eye(3)[axis])

    def extent(self, direction: Array) -> float:
        """Return the sum of half edges times |direction|."""
        return float(self._half @ np.abs(direction))

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return a coal.Box."""
        return (ConvexPiece(coal.Box(*(2.0 * self._half))),)

    def tessellation(self) -> Tessellation:
        """Return twelve triangles."""
        return tessellation_of(trimesh.creation.box(extents=2.0 * self._half))


@compiled
def _signed_distance(points: Array, half: Array) -> tuple[Array, Array, Array]:
    n = len(points)
    distances, gradients, hessians = np.empty(n), np.zeros((n, 3)), np.zeros((n, 3, 3))
    for i in range(n):
        square, farthest = 0.0, 0
        for k in range(3):
            beyond = abs(points[i, k]) - half[k]
            if beyond > 0.0:
                square += beyond * beyond
            if beyond > abs(points[i, farthest]) - half[farthest]:
                farthest = k
        if square == 0.0:
            distances[i] = abs(points[i, farthest]) - half[farthest]
            gradients[i, farthest] = -1.0 if points[i, farthest] < 0.0 else 1.0
            continue
        distances[i] = math.sqrt(square)
        for k in range(3):
            beyond = abs(points[i, k]) - half[k]
            if beyond > 0.0:
                gradients[i, k] = math.copysign(beyond / distances[i], points[i, k])
        for k in range(3):
            for m in range(3):
                active = 1.0 if k == m and abs(points[i, k]) > half[k] else 0.0
                hessians[i, k, m] = (active - gradients[i, k] * gradients[i, m]) / distances[i]
    return distances, gradients, hessians
