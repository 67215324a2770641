"""A cylinder."""

from __future__ import annotations

import math

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Cylinder
from .circle import circle
from .core import PENETRATION, Core, FormulaGeometry


class CylinderGeometry(FormulaGeometry):
    """A cylinder around z. Its second core is the cylinder less the penetration that is allowed."""

    def __init__(self, shape: Cylinder) -> None:
        self._radius, self._half = float(shape.radius), float(shape.height) / 2
        cores = [Core(coal.Cylinder(self._radius, 2 * self._half), 0.0)]
        if min(self._radius, self._half) > PENETRATION:
            inner = coal.Cylinder(self._radius - PENETRATION, 2 * (self._half - PENETRATION))
            cores.append(Core(inner, PENETRATION))
        self.cores = tuple(cores)

    def _beyond(self, point: Array) -> tuple[float, float]:
        """Return how far a point is beyond the side and beyond the nearer cap."""
        return math.hypot(point[0], point[1]) - self._radius, abs(float(point[2])) - self._half

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        side, cap = self._beyond(point)
        return math.hypot(max(side, 0.0), max(cap, 0.0)) + min(max(side, cap), 0.0)

    def inward(self, point: Array) -> Array:
        """Inward unit normal of side or cap, whichever is nearer (farther beyond, at an edge)."""
        side, cap = self._beyond(point)
        if cap > side:
            return np.array([0.0, 0.0, -math.copysign(1.0, point[2])])
        across = np.array([point[0], point[1], 0.0])
        length = float(np.linalg.norm(across))
        return -across / length if length > 0.0 else np.full(3, np.nan)

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        return math.hypot(math.hypot(point[0], point[1]) + self._radius, abs(float(point[2])) + self._half)

    def face(self, point: Array) -> Array:
        """Line along the side from cap to cap, or a cap as a polygon with its corners on the circle."""
        side, cap = self._beyond(point)
        if cap > side:
            return circle(self._radius, math.copysign(self._half, point[2]))
        angle = math.atan2(point[1], point[0])
        x, y = self._radius * math.cos(angle), self._radius * math.sin(angle)
        return np.array([[x, y, -self._half], [x, y, self._half]])

    def edge(self, point: Array) -> float:
        """Distance to the nearer cap's circle."""
        side, cap = self._beyond(point)
        return -min(side, cap)
