"""A cylinder: in the half-plane (radial, axial) through the axis it is a rectangle.

With b = (rho - r, |z| - h/2), the distance is |max(b, 0)| outside and max(b) inside. The gradient n lies in that
half-plane; the Hessian is that of the rectangle there plus (n_rho / rho) t t^T along the tangent t of the circle.
"""

from __future__ import annotations

import math
from typing import Any

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Cylinder


class CylinderSurface:
    """Geometry of a cylinder around the origin, axis z; on the axis the radial direction is taken along x."""

    def __init__(self, shape: Cylinder) -> None:
        self._radius = shape.radius
        self._half = 0.5 * shape.height
        self.radius = math.hypot(self._radius, self._half)
        self.least_width = min(2.0 * shape.radius, shape.height)

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian; side and caps inside are told apart by the nearer one."""
        rho = np.hypot(points[:, 0], points[:, 1])
        length = np.where(rho > 0.0, rho, 1.0)
        radial = np.zeros((len(points), 3))
        radial[:, 0] = np.where(rho > 0.0, points[:, 0] / length, 1.0)
        radial[:, 1] = points[:, 1] / length
        axial = np.zeros((len(points), 3))
        axial[:, 2] = np.where(points[:, 2] < 0.0, -1.0, 1.0)
        beyond = np.column_stack([rho - self._radius, np.abs(points[:, 2]) - self._half])
        over = np.maximum(beyond, 0.0)
        outside = np.hypot(over[:, 0], over[:, 1])
        distances = np.where(outside > 0.0, outside, beyond.max(axis=1))
        scale = np.where(outside > 0.0, outside, 1.0)[:, None]
        nearer = np.eye(2)[beyond.argmax(axis=1)]
        parts = np.where(outside[:, None] > 0.0, over / scale, nearer)
        gradients = parts[:, :1] * radial + parts[:, 1:] * axial
        tangents = np.column_stack([-radial[:, 1], radial[:, 0], np.zeros(len(points))])
        hessians = (parts[:, 0] / length)[:, None, None] * _outer(tangents)
        corner = (over > 0.0).all(axis=1)
        if corner.any():
            plane = _outer(radial) + _outer(axial) - _outer(gradients)
            hessians += np.where(corner, 1.0 / scale[:, 0], 0.0)[:, None, None] * plane
        return distances, gradients, hessians

    def extent(self, direction: Array) -> float:
        """Return r |direction across the axis| + h/2 |direction along it|."""
        across = math.hypot(direction[0], direction[1])
        return float(self._radius * across + self._half * abs(direction[2]))

    def coal_shape(self) -> Any:
        """Return a coal.Cylinder."""
        geometry = coal.Cylinder(self._radius, 2.0 * self._half)
        geometry.computeLocalAABB()
        return geometry


def _outer(vectors: Array) -> Array:
    return np.asarray(vectors[:, :, None] * vectors[:, None, :])
