"""A box."""

from __future__ import annotations

import math

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Box
from .core import PENETRATION, Core, FormulaGeometry

_CORNERS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


class BoxGeometry(FormulaGeometry):
    """A box. Its second core is the box less the penetration that is allowed."""

    def __init__(self, shape: Box) -> None:
        self._half = np.array(shape.size, dtype=np.float64) / 2
        cores = [Core(coal.Box(*map(float, shape.size)), 0.0)]
        if self._half.min() > PENETRATION:
            inner = 2 * (self._half - PENETRATION)
            cores.append(Core(coal.Box(*map(float, inner)), PENETRATION))
        self.cores = tuple(cores)

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        beyond = np.abs(point) - self._half
        return float(np.linalg.norm(np.maximum(beyond, 0.0)) + min(beyond.max(), 0.0))

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the nearest face (of the face farthest beyond, at an edge)."""
        axis = int(np.argmax(np.abs(point) - self._half))
        normal = np.zeros(3)
        normal[axis] = -1.0 if point[axis] > 0.0 else 1.0
        return normal

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        return float(np.linalg.norm(np.abs(point) + self._half))

    def face(self, point: Array) -> Array:
        """Corners of the side that is nearest (farthest beyond, at an edge)."""
        axis = int(np.argmax(np.abs(point) - self._half))
        corners = np.empty((4, 3))
        corners[:, axis] = math.copysign(self._half[axis], point[axis])
        corners[:, [i for i in range(3) if i != axis]] = _CORNERS * np.delete(self._half, axis)
        return corners

    def edge(self, point: Array) -> float:
        """Distance to the nearest side of the rectangle."""
        beyond = np.abs(point) - self._half
        return float(-np.delete(beyond, int(np.argmax(beyond))).max())
