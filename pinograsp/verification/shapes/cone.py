"""A cone, whole or truncated."""

from __future__ import annotations

import math

import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Cone
from .circle import circle, turned
from .core import PENETRATION, Core, FormulaGeometry


class ConeGeometry(FormulaGeometry):
    """A cone around z, whole or truncated.

    Coal knows none that are truncated: its cores are solids of so many flat sides within it that they are nowhere
    more than `_ARC` away from it.
    """

    def __init__(self, shape: Cone) -> None:
        self._half = float(shape.height) / 2
        self._rims = np.array([[shape.bottom_radius, -self._half], [shape.top_radius, self._half]])
        slope = self._rims[1] - self._rims[0]
        self._length = float(np.linalg.norm(slope))
        self._up = slope / self._length
        self._out = np.array([self._up[1], -self._up[0]])
        cores = [Core(turned(self._rims), 0.0)]
        inner = self._inset(PENETRATION)
        if inner is not None:
            cores.append(Core(turned(inner), PENETRATION))
        self.cores = tuple(cores)

    def _inset(self, depth: float) -> Array | None:
        """Return the rims of the cone less what is nearer than `depth` to its surface; None if nothing is left."""
        heights = np.array([-self._half + depth, self._half - depth])
        offset = float(self._out @ self._rims[0]) - depth
        radii = (offset - self._out[1] * heights) / self._out[0]
        if (radii <= 0.0).any():  # towards a tip it ends before
            tip = offset / self._out[1]
            heights, radii = np.where(radii > 0.0, heights, tip), np.maximum(radii, 0.0)
        inner = np.column_stack([radii, heights])
        return inner if radii.max() > 0.0 and heights[0] < heights[1] else None

    def _flat(self, point: Array) -> Array:
        """Return radius and height of a point."""
        return np.array([math.hypot(point[0], point[1]), float(point[2])])

    def _depths(self, point: Array) -> tuple[float, float]:
        """Return how far a point is beyond the side and beyond the nearer end."""
        flat = self._flat(point)
        return float(self._out @ (flat - self._rims[0])), abs(float(flat[1])) - self._half

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        side, end = self._depths(point)
        if side <= 0.0 and end <= 0.0:
            return max(side, end)
        flat, low, high = self._flat(point), [0.0, -self._half], [0.0, self._half]
        pieces = ((low, self._rims[0]), (self._rims[0], self._rims[1]), (self._rims[1], high))
        return min(_from_segment(flat, np.asarray(a), np.asarray(b)) for a, b in pieces)

    def inward(self, point: Array) -> Array:
        """Inward unit normal of side or end, whichever is nearer (farther beyond, at an edge)."""
        side, end = self._depths(point)
        if end > side:
            return np.array([0.0, 0.0, -math.copysign(1.0, point[2])])
        rho = math.hypot(point[0], point[1])
        if rho == 0.0:
            return np.full(3, np.nan)
        return -np.array([self._out[0] * point[0] / rho, self._out[0] * point[1] / rho, self._out[1]])

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        flat = self._flat(point)
        return max(math.hypot(flat[0] + radius, flat[1] - height) for radius, height in self._rims)

    def face(self, point: Array) -> Array:
        """Line up the side, or an end as a polygon with its corners on the circle."""
        side, end = self._depths(point)
        if end > side:
            radius, height = self._rims[1 if point[2] > 0.0 else 0]
            return circle(float(radius), float(height))
        rho = math.hypot(point[0], point[1])
        x, y = point[0] / rho, point[1] / rho
        return np.array([[radius * x, radius * y, height] for radius, height in self._rims])

    def edge(self, point: Array) -> float:
        """Distance from the circle around the end, or, on the side, from the nearer one along it."""
        side, end = self._depths(point)
        flat = self._flat(point)
        if end > side:
            return float(self._rims[1 if point[2] > 0.0 else 0, 0] - flat[0])
        along = float(self._up @ (flat - self._rims[0]))
        return min(along, self._length - along)


def _from_segment(point: Array, start: Array, end: Array) -> float:
    """Return the distance of a point of the plane from a segment."""
    along = end - start
    share = min(max(float((point - start) @ along) / max(float(along @ along), 1e-300), 0.0), 1.0)
    return float(np.linalg.norm(point - start - share * along))
