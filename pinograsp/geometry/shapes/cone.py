"""A cone, whole or truncated (see `frustum`)."""

from __future__ import annotations

import math

import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Cone
from ..contact_faces import ContactFace, Ruling
from ..convex_solid import ConvexPiece, convex_solid
from ..tessellation import Tessellation
from .convex import Convex
from .frustum import frustum_distance
from .revolved import cap, revolved

SIDES = 180
"""Sides of the solid around the cone that stands for it where distances to links are measured: 0.015 % wider."""


class ConeSurface(Convex):
    """Geometry of a cone around the z axis, its height centred at the origin."""

    def __init__(self, shape: Cone) -> None:
        self._bottom, self._top, self._half = shape.bottom_radius, shape.top_radius, 0.5 * shape.height
        self._slant = math.hypot(shape.height, self._bottom - self._top)
        widest = max(self._bottom, self._top)
        self.radius = math.hypot(widest, self._half)
        self.least_width = min(shape.height, 2.0 * widest * shape.height / self._slant)

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian; side and ends inside are told apart by the nearer one."""
        return frustum_distance(points, self._bottom, self._top, self._half)

    def contact_face(self, point: Array) -> ContactFace:
        """Return the straight line up the side, or the end, whichever is nearer; an end as a polygon around it.

        A tip is an end of the lines.
        """
        x, y, z = point
        rho, rise, spread = math.hypot(x, y), 2.0 * self._half / self._slant, (self._top - self._bottom) / self._slant
        beside = (rho - self._bottom) * rise - (z + self._half) * spread
        radius, height = (self._top, self._half) if z >= 0.0 else (self._bottom, -self._half)
        if rho > 0.0 and (beside >= abs(z) - self._half or radius == 0.0):
            radial, tangent = np.array([x, y, 0.0]) / rho, np.array([-y, x, 0.0]) / rho
            along = (z + self._half) * rise + (rho - self._bottom) * spread
            direction = spread * radial + np.array([0.0, 0.0, rise])
            bend = spread / rho * np.outer(tangent, tangent)
            return Ruling(direction, -along, self._slant - along, bend=bend)
        return cap(radius, height)

    def extent(self, direction: Array) -> float:
        """Return the larger of what both ends reach."""
        across, up = math.hypot(direction[0], direction[1]), self._half * direction[2]
        return float(max(self._bottom * across - up, self._top * across + up))

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return a convex solid of flat sides around the cone: Coal knows none that are truncated."""
        angles = np.arange(SIDES) * 2.0 * math.pi / SIDES
        circle = np.column_stack([np.cos(angles), np.sin(angles)]) / math.cos(math.pi / SIDES)
        ends = ((self._bottom, -self._half), (self._top, self._half))
        rims = [np.column_stack([r * circle, np.full(SIDES, z)])[: SIDES if r else 1] for r, z in ends]
        return (ConvexPiece(convex_solid(np.concatenate(rims))),)

    def tessellation(self) -> Tessellation:
        """Return triangles in rings about as high as they are wide."""
        return revolved(self._bottom, self._top, self._half)
