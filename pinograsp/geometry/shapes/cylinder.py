"""A cylinder: a truncated cone whose radii are equal (see `frustum`)."""

from __future__ import annotations

import math

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Cylinder
from ..contact_faces import ContactFace, Ruling
from ..convex_solid import ConvexPiece
from ..tessellation import Tessellation
from .convex import Convex
from .frustum import frustum_distance
from .revolved import cap, revolved


class CylinderSurface(Convex):
    """Geometry of a cylinder around the origin, axis z; on the axis the radial direction is taken along x."""

    def __init__(self, shape: Cylinder) -> None:
        self._radius = shape.radius
        self._half = 0.5 * shape.height
        self.radius = math.hypot(self._radius, self._half)
        self.least_width = min(2.0 * shape.radius, shape.height)

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian; side and caps inside are told apart by the nearer one."""
        return frustum_distance(points, self._radius, self._radius, self._half)

    def contact_face(self, point: Array) -> ContactFace:
        """Return the straight line of the side, or the cap, whichever is nearer; a cap as a polygon around the disc."""
        x, y, z = point
        if math.hypot(x, y) - self._radius >= abs(z) - self._half:
            return Ruling(np.array([0.0, 0.0, 1.0]), -self._half - z, self._half - z)
        return cap(self._radius, self._half if z >= 0.0 else -self._half)

    def extent(self, direction: Array) -> float:
        """Return r |direction across the axis| + h/2 |direction along it|."""
        across = math.hypot(direction[0], direction[1])
        return float(self._radius * across + self._half * abs(direction[2]))

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return a coal.Cylinder."""
        return (ConvexPiece(coal.Cylinder(self._radius, 2.0 * self._half)),)

    def tessellation(self) -> Tessellation:
        """Return a prism in rings about as high as its sides are wide."""
        return revolved(self._radius, self._radius, self._half)
