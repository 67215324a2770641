"""A ball: d = |p| - r."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Sphere


class SphereSurface:
    """Geometry of a ball around the origin; at the very centre the gradient is taken along x."""

    def __init__(self, shape: Sphere) -> None:
        self.radius = shape.radius
        self.least_width = 2.0 * shape.radius

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient p / |p| and Hessian (I - n n^T) / |p|."""
        norm = np.sqrt((points * points).sum(axis=1))
        centred = norm == 0.0
        if centred.any():
            points = np.where(centred[:, None], [1.0, 0.0, 0.0], points)
        length = np.where(centred, 1.0, norm)
        normals = points / length[:, None]
        hessians = (np.eye(3) - normals[:, :, None] * normals[:, None, :]) / length[:, None, None]
        return norm - self.radius, normals, hessians

    def extent(self, direction: Array) -> float:
        """Return r |direction|."""
        return float(self.radius * np.linalg.norm(direction))

    def coal_shape(self) -> Any:
        """Return a coal.Sphere."""
        geometry = coal.Sphere(self.radius)
        geometry.computeLocalAABB()
        return geometry
