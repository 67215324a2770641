"""A cylinder: in the half-plane (radial, axial) through the axis it is a rectangle.

With b = (rho - r, |z| - h/2), the distance is |max(b, 0)| outside and max(b) inside. The gradient n lies in that
half-plane; the Hessian is that of the rectangle there plus (n_rho / rho) t t^T along the tangent t of the circle.
"""

from __future__ import annotations

import math
from typing import Any

import coal
import numpy as np
import trimesh

from ...arrays import Array
from ...compiled import compiled
from ...descriptions.shapes import Cylinder
from ..contact_faces import ContactFace, Flat, Ruling
from ..tessellation import Tessellation, tessellation_of

SECTIONS = 48
"""Sides of the prism that stands for a cylinder in a tessellation, and of the polygon around a cap."""
MOST_RINGS, CAP_RINGS = 24, 4
"""Rings of its side at most, and of each cap: slender triangles would fall into a great many small ones."""


class CylinderSurface:
    """Geometry of a cylinder around the origin, axis z; on the axis the radial direction is taken along x."""

    def __init__(self, shape: Cylinder) -> None:
        self._radius = shape.radius
        self._half = 0.5 * shape.height
        self.radius = math.hypot(self._radius, self._half)
        self.least_width = min(2.0 * shape.radius, shape.height)

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian; side and caps inside are told apart by the nearer one."""
        return _signed_distance(points, self._radius, self._half)

    def contact_face(self, point: Array) -> ContactFace:
        """Return the straight line of the side, or the cap, whichever is nearer; a cap as a polygon around the disc."""
        x, y, z = point
        if math.hypot(x, y) - self._radius >= abs(z) - self._half:
            return Ruling(np.array([0.0, 0.0, 1.0]), -self._half - z, self._half - z)
        top = 1.0 if z >= 0.0 else -1.0
        angles = top * (np.arange(SECTIONS) + 0.5) * 2.0 * math.pi / SECTIONS
        radius = self._radius / math.cos(math.pi / SECTIONS)
        rim = [radius * np.cos(angles), radius * np.sin(angles), np.full(SECTIONS, top * self._half)]
        return Flat(np.column_stack(rim), np.array([0.0, 0.0, top]))

    def extent(self, direction: Array) -> float:
        """Return r |direction across the axis| + h/2 |direction along it|."""
        across = math.hypot(direction[0], direction[1])
        return float(self._radius * across + self._half * abs(direction[2]))

    def solids(self) -> tuple[Any, ...]:
        """Return a coal.Cylinder."""
        return (coal.Cylinder(self._radius, 2.0 * self._half),)

    def tessellation(self) -> Tessellation:
        """Return a prism of `SECTIONS` sides in rings about as high as its sides are wide."""
        width = 2.0 * self._radius * math.sin(math.pi / SECTIONS)
        rings = min(math.ceil(2.0 * self._half / width), MOST_RINGS)
        side = [(self._radius, z) for z in np.linspace(-self._half, self._half, rings + 1)]
        cap = np.linspace(0.0, self._radius, CAP_RINGS, endpoint=False)
        profile = [*((r, -self._half) for r in cap), *side, *((r, self._half) for r in cap[::-1])]
        return tessellation_of(trimesh.creation.revolve(np.array(profile), sections=SECTIONS))


@compiled
def _signed_distance(points: Array, radius: float, half: float) -> tuple[Array, Array, Array]:
    n = len(points)
    distances, gradients, hessians = np.empty(n), np.empty((n, 3)), np.empty((n, 3, 3))
    for i in range(n):
        x, y, z = points[i]
        rho = math.hypot(x, y)
        radial = (x / rho, y / rho, 0.0) if rho > 0.0 else (1.0, 0.0, 0.0)
        tangent = (-radial[1], radial[0], 0.0)
        axial = (0.0, 0.0, -1.0 if z < 0.0 else 1.0)
        b_rho, b_z = rho - radius, abs(z) - half
        corner = b_rho > 0.0 and b_z > 0.0
        if corner:
            distances[i] = math.hypot(b_rho, b_z)
            n_rho, n_z = b_rho / distances[i], b_z / distances[i]
        else:
            distances[i] = max(b_rho, b_z)
            n_rho, n_z = (1.0, 0.0) if b_rho >= b_z else (0.0, 1.0)
        for j in range(3):
            gradients[i, j] = n_rho * radial[j] + n_z * axial[j]
        around = n_rho / rho if rho > 0.0 else n_rho
        for j in range(3):
            for k in range(3):
                hessians[i, j, k] = around * tangent[j] * tangent[k]
                if corner:
                    plane = radial[j] * radial[k] + axial[j] * axial[k] - gradients[i, j] * gradients[i, k]
                    hessians[i, j, k] += plane / distances[i]
    return distances, gradients, hessians
