"""A box: outside, the distance to the nearest point of it; inside, minus the depth below the nearest face."""

from __future__ import annotations

import coal
import numpy as np
import trimesh

from ...arrays import Array
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
        over = np.abs(points) - self._half
        signs = np.where(points < 0, -1.0, 1.0)
        beyond = np.maximum(over, 0.0)
        outside = np.sqrt((beyond * beyond).sum(axis=1))
        distances = np.where(outside > 0, outside, over.max(axis=1))
        nearest_face = np.eye(3)[over.argmax(axis=1)]
        length = np.where(outside > 0, outside, 1.0)[:, None]
        gradients = signs * np.where(outside[:, None] > 0, beyond / length, nearest_face)
        active = (beyond > 0).astype(float)
        hessians = active[:, :, None] * np.eye(3) - gradients[:, :, None] * gradients[:, None, :]
        hessians *= np.where(outside > 0, 1.0 / length[:, 0], 0.0)[:, None, None]
        return distances, gradients, hessians

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
