"""A ball."""

from __future__ import annotations

import math

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Sphere
from .core import Core, FormulaGeometry


class SphereGeometry(FormulaGeometry):
    """A ball. Its core is next to a point, so that penetration too is exact down to the centre."""

    def __init__(self, shape: Sphere) -> None:
        self._radius = float(shape.radius)
        core = 1e-3 * self._radius
        self.cores: tuple[Core, ...] = (Core(coal.Sphere(core), self._radius - core),)

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        return float(np.linalg.norm(point)) - self._radius

    def inward(self, point: Array) -> Array:
        """Inward unit normal; not a number at the centre."""
        length = float(np.linalg.norm(point))
        return -point / length if length > 0.0 else np.full(3, np.nan)

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        return self._radius + float(np.linalg.norm(point))

    def face(self, point: Array) -> Array:
        """Surface point itself."""
        return np.asarray(-self._radius * self.inward(point))[None]

    def edge(self, point: Array) -> float:
        """Infinite: a sphere has no edges."""
        return math.inf
