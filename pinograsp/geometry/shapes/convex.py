"""What the surfaces of shapes with a formula have in common."""

from __future__ import annotations

import numpy as np

from ...arrays import Array, Indices


class Exact:
    """A surface whose signed distance is exact, and its gradient what a pad feels."""

    radius: float
    uneven = False

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian."""
        raise NotImplementedError

    def footprint(self, points: Array) -> tuple[Array, Array]:
        """Return gradient and Hessian of the distance."""
        _, normals, hessians = self.signed_distance(points)
        return normals, hessians

    def radius_about(self, point: Array | tuple[float, float, float]) -> float:
        """Return that of the ball around the origin, and the way from there."""
        return self.radius + float(np.linalg.norm(point))

    def exact_distances(self, points: Array) -> Array:
        """Return the distances."""
        return self.signed_distance(points)[0]


class Convex(Exact):
    """A shape that is no compound."""

    edged = True

    def nearest_part(self, points: Array) -> Indices:
        """Return 0 for every point."""
        return np.zeros(len(points), dtype=np.intp)
