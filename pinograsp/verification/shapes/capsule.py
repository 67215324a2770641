"""A capsule."""

from __future__ import annotations

import math

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Capsule
from .core import Core, FormulaGeometry


class CapsuleGeometry(FormulaGeometry):
    """A capsule around z. Its core is a thin rod, so that penetration too is exact down to the axis."""

    def __init__(self, shape: Capsule) -> None:
        self._radius, self._half = float(shape.radius), float(shape.length) / 2
        core = 1e-3 * self._radius
        self.cores: tuple[Core, ...] = (Core(coal.Capsule(core, 2 * self._half), self._radius - core),)

    def _axis_point(self, point: Array) -> Array:
        """Return the nearest point of the rod."""
        return np.array([0.0, 0.0, min(max(float(point[2]), -self._half), self._half)])

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        return float(np.linalg.norm(point - self._axis_point(point))) - self._radius

    def inward(self, point: Array) -> Array:
        """Inward unit normal; not a number on the axis."""
        apart = self._axis_point(point) - point
        length = float(np.linalg.norm(apart))
        return np.asarray(apart / length) if length > 0.0 else np.full(3, np.nan)

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        return math.hypot(math.hypot(point[0], point[1]), abs(float(point[2])) + self._half) + self._radius

    def face(self, point: Array) -> Array:
        """Line along the side between the half balls, or the surface point itself on these."""
        outward = -self._radius * self.inward(point)
        if abs(point[2]) > self._half:
            return np.asarray(self._axis_point(point) + outward)[None]
        return np.array([outward + end * np.array([0.0, 0.0, self._half]) for end in (-1.0, 1.0)])

    def edge(self, point: Array) -> float:
        """Infinite: side and half balls join smoothly."""
        return math.inf
