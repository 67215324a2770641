"""An ellipsoid."""

from __future__ import annotations

import math

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Ellipsoid
from .core import PENETRATION, Core, FormulaGeometry


class EllipsoidGeometry(FormulaGeometry):
    """An ellipsoid. Its second core holds all of it that is deeper than the penetration that is allowed."""

    def __init__(self, shape: Ellipsoid) -> None:
        self._axes = np.array(shape.semi_axes, dtype=np.float64)
        cores = [Core(coal.Ellipsoid(*self._axes), 0.0)]
        if self._axes.min() > PENETRATION:
            cores.append(Core(coal.Ellipsoid(*(self._axes - PENETRATION)), PENETRATION))
        self.cores = tuple(cores)

    def _nearest(self, point: Array) -> Array:
        """Return the nearest point of the surface, found by bisection of the multiplier.

        With F(t) = sum of (a p / (t + a^2))^2, the largest root of F = 1 is between max(a |p| - a^2) and
        |a p| - min a^2.
        """
        squares, loads = self._axes**2, self._axes * np.maximum(np.abs(point), 1e-9 * self._axes)
        low, high = float((loads - squares).max()), float(np.linalg.norm(loads) - squares.min())
        for _ in range(200):
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
            if ((loads / (middle + squares)) ** 2).sum() > 1.0:
                low = middle
            else:
                high = middle
        there = self._axes * loads / (0.5 * (low + high) + squares)
        return np.asarray(np.copysign(there, point))

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        apart = float(np.linalg.norm(point - self._nearest(point)))
        return apart if ((point / self._axes) ** 2).sum() > 1.0 else -apart

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the surface at its point nearest to `point`."""
        slope = self._nearest(point) / self._axes**2
        return np.asarray(-slope / np.linalg.norm(slope))

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape; a little more off the origin."""
        return float(self._axes.max() + np.linalg.norm(point))

    def face(self, point: Array) -> Array:
        """Surface point itself."""
        return self._nearest(point)[None]

    def edge(self, point: Array) -> float:
        """Infinite: an ellipsoid has no edges."""
        return math.inf
