"""An ellipsoid: the exact distance from its nearest point, with the curvatures there.

With the semi-axes a_k, the point q of the surface that is nearest to p has q_k = a_k^2 p_k / (t + a_k^2), where t is
the largest root of F(t) = sum_k (a_k p_k / (t + a_k^2))^2 - 1. F falls and is convex right of -min a_k^2, so that
Newton's method goes up to the root from where F is positive. On the surface, with g_k = q_k / a_k^2 and n = g / |g|,
the shape operator is S = P diag(1 / a_k^2) P / |g|, P = I - n n^T; at the distance d the Hessian is (I + d S)^-1 S,
which is (S + d e P) / (1 + d t + d^2 e) with the sum t and the product e of the two principal curvatures.
"""

from __future__ import annotations

import math

import coal
import numpy as np
import trimesh

from ...arrays import Array
from ...compiled import compiled
from ...descriptions.shapes import Ellipsoid
from ..contact_faces import ContactFace, Spot
from ..convex_solid import ConvexPiece
from ..tessellation import Tessellation, tessellation_of
from .convex import Convex

SUBDIVISIONS = 3
"""Halvings of an icosahedron's triangles for a tessellation: 1280 triangles."""
_TINY = 1e-9
"""Points count as this much off the planes of symmetry, in parts of a semi-axis: inside, two points may be nearest."""
_STEPS = 60


class EllipsoidSurface(Convex):
    """Geometry of an ellipsoid around the origin, semi-axes along the axes."""

    edged = False

    def __init__(self, shape: Ellipsoid) -> None:
        self._axes = np.array(shape.semi_axes)
        self.radius = float(self._axes.max())
        self.least_width = 2.0 * float(self._axes.min())

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian; far inside, where the nearest point jumps, the Hessian is capped."""
        return _signed_distance(points, self._axes)

    def contact_face(self, point: Array) -> ContactFace:
        """Return a spot."""
        return Spot()

    def extent(self, direction: Array) -> float:
        """Return |a_k direction_k|."""
        return float(np.linalg.norm(self._axes * direction))

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return a coal.Ellipsoid."""
        return (ConvexPiece(coal.Ellipsoid(*self._axes)),)

    def tessellation(self) -> Tessellation:
        """Return a ball's triangles, stretched; their corners lie on the ellipsoid."""
        ball = trimesh.creation.icosphere(subdivisions=SUBDIVISIONS)
        ball.vertices *= self._axes
        return tessellation_of(ball)


@compiled
def _signed_distance(points: Array, axes: Array) -> tuple[Array, Array, Array]:
    n = len(points)
    distances, gradients, hessians = np.empty(n), np.empty((n, 3)), np.empty((n, 3, 3))
    least, bends = axes.min(), 1.0 / (axes * axes)
    p, normal = np.empty(3), np.empty(3)
    for i in range(n):
        within = -1.0
        for k in range(3):
            size = max(abs(points[i, k]), _TINY * axes[k])
            p[k] = -size if points[i, k] < 0.0 else size
            within += (p[k] / axes[k]) ** 2
        t = -least * least
        for k in range(3):
            t = max(t, axes[k] * abs(p[k]) - axes[k] * axes[k])
        for _ in range(_STEPS):
            value, slope = -1.0, 0.0
            for k in range(3):
                share = axes[k] * p[k] / (t + axes[k] * axes[k])
                value += share * share
                slope -= 2.0 * share * share / (t + axes[k] * axes[k])
            step = -value / slope
            t += step
            if step <= 1e-15 * axes.max() ** 2:
                break
        size, apart = 0.0, 0.0
        for k in range(3):
            foot = axes[k] * axes[k] * p[k] / (t + axes[k] * axes[k])
            normal[k] = foot / (axes[k] * axes[k])
            size += normal[k] * normal[k]
            apart += (p[k] - foot) ** 2
        size = math.sqrt(size)
        distances[i] = math.copysign(math.sqrt(apart), within)
        along, total, product = 0.0, 0.0, 0.0
        for k in range(3):
            normal[k] /= size
            gradients[i, k] = normal[k]
            along += normal[k] * normal[k] * bends[k]
            total += bends[k]
            product += normal[k] * normal[k] * bends[k - 1] * bends[k - 2]
        total, product = (total - along) / size, product / (size * size)
        # Inside, I + d S is singular where spheres of curvature meet; no contact is there.
        norm = math.sqrt(max(total * total - 2.0 * product, 0.0))
        d = max(distances[i], -0.9 / norm)
        for j in range(3):
            for k in range(3):
                P = (1.0 if j == k else 0.0) - normal[j] * normal[k]
                S = (bends[j] if j == k else 0.0) - normal[j] * normal[k] * (bends[j] + bends[k] - along)
                hessians[i, j, k] = (S / size + d * product * P) / (1.0 + d * total + d * d * product)
    return distances, gradients, hessians
