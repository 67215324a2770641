"""Geometry of the shapes of a scene: one file a shape, registered here.

A surface gives, in the shape's own frame, the exact signed distance of points with gradient and Hessian, the
least width of the shape, the radius of a ball around its origin that contains it, and its Coal geometry.
"""

from __future__ import annotations

from typing import Any, Protocol

from ...arrays import Array
from ...descriptions import shapes as described
from .box import BoxSurface
from .cylinder import CylinderSurface
from .sphere import SphereSurface


class Surface(Protocol):
    """A convex shape."""

    least_width: float
    """Least distance between two parallel planes that hold the shape between them, m."""
    radius: float
    """Of a ball around the frame's origin that contains the shape, m."""

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance (n,), gradient (n, 3) and Hessian (n, 3, 3) at points (n, 3); negative inside.

        The gradient on the surface is the outward normal.
        """
        ...

    def extent(self, direction: Array) -> float:
        """Return the support function max_p direction . p over the shape, m."""
        ...

    def coal_shape(self) -> Any:
        """Return the Coal geometry, its local bounding volume computed."""
        ...


_SURFACES: dict[type, Any] = {
    described.Sphere: SphereSurface,
    described.Box: BoxSurface,
    described.Cylinder: CylinderSurface,
}


def surface_of(shape: described.Shape) -> Surface:
    """Return the geometry of a described shape."""
    surface: Surface = _SURFACES[type(shape)](shape)
    return surface
