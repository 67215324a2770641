"""Geometry of the shapes of a scene: one file a shape, registered in `SURFACES`.

A surface gives, in the shape's own frame, the signed distance of points with gradient and Hessian, its contact
faces, the normals that pads feel on it, how large the shape is, its solids for Coal, and triangles. Shapes of one part
with a formula are `convex.Convex`. The body within a mesh is uneven: pads yield to it, and points of the links are
measured instead of solids.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from ...arrays import Array, Indices
from ...descriptions import shapes as described
from ..contact_faces import ContactFace
from ..convex_solid import ConvexPiece
from ..point_trees import PointTrees
from ..tessellation import Tessellation
from .box import BoxSurface
from .capsule import CapsuleSurface
from .compound import CompoundSurface
from .cone import ConeSurface
from .cylinder import CylinderSurface
from .ellipsoid import EllipsoidSurface
from .mesh import body_surface
from .sphere import SphereSurface


class Surface(Protocol):
    """A shape: convex, a compound, or the body within a mesh."""

    radius: float
    """Of a ball around the frame's origin that contains the shape, m."""
    edged: bool
    """Whether some of its contact faces have edges."""
    uneven: bool
    """Whether pads lie on the mean of what is below them, tilted and pressed in a little, instead of tangent to it."""

    @property
    def least_width(self) -> float:
        """Least distance between two parallel planes that hold the shape, or a part of a compound, between them, m.

        0 if parts of it may be narrower that are not known.
        """
        ...

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance (n,), gradient (n, 3) and Hessian (n, 3, 3) at points (n, 3); negative inside.

        The gradient on the surface is the outward normal.
        """
        ...

    def footprint(self, points: Array) -> tuple[Array, Array]:
        """Return the outward unit normals (n, 3) that a pad feels at points (n, 3), and their derivatives (n, 3, 3)."""
        ...

    def exact_distances(self, points: Array) -> Array:
        """Return the signed distances (n,) of points (n, 3) as exactly as they can be had, slowly."""
        ...

    def radius_about(self, point: Array | tuple[float, float, float]) -> float:
        """Return the radius of a ball around a point that contains the shape, m."""
        ...

    def nearest_part(self, points: Array) -> Indices:
        """Return the part of a compound that each point, shape (n, 3), is nearest to; 0 in other shapes."""
        ...

    def contact_face(self, point: Array) -> ContactFace:
        """Return the part of the surface in its tangent plane at the surface point nearest to `point`, shape (3,)."""
        ...

    def extent(self, direction: Array) -> float:
        """Return the support function max_p direction . p over the shape, m."""
        ...

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return convex pieces that together are the shape."""
        ...

    def tessellation(self) -> Tessellation:
        """Return triangles whose corners lie on the surface, fine enough to be drawn."""
        ...


class UnevenSurface(Surface, Protocol):
    """A surface whose `uneven` is true: links are kept off it by points, since Coal does not measure it."""

    def nearest_points(
        self, sets: PointTrees, rotations: Array, translations: Array, least: Array, caps: Array
    ) -> tuple[Indices, Array, Array, Array]:
        """Return which sets of points are nearer than their cap, with distances, points and gradients there.

        A distance may be too large by a tenth of what it lacks to the one that is wanted, or by most of what it has
        above that.

        Args:
            sets: points that are fixed to bodies.
            rotations: of the bodies' frames in that of the surface, shape (bodies, 3, 3).
            translations: of these, m, shape (bodies, 3).
            least: distances of each set that are wanted, m, shape (sets,).
            caps: distances of each set from which on they do not matter, m, shape (sets,).

        Returns:
            Indices of sets, ascending, shape (k,); signed distances, m, shape (k,); points in the frame of the surface
            and gradients there, shapes (k, 3).
        """
        ...

    def deepest_point(self, normals: Array, offsets: Array) -> tuple[float, Array, int]:
        """Return how deep the surface is in a convex solid, negative, m, its point there, and the facet.

        Args:
            normals: outward unit normals of the solid's facets in the surface's frame, shape (k, 3).
            offsets: normal . p on the facets, m, shape (k,).
        """
        ...


SURFACES: dict[type[described.ShapeDescription], Callable[[Any], Surface]] = {
    described.Sphere: SphereSurface,
    described.Box: BoxSurface,
    described.Cylinder: CylinderSurface,
    described.Capsule: CapsuleSurface,
    described.Cone: ConeSurface,
    described.Ellipsoid: EllipsoidSurface,
    described.Mesh: body_surface,
    described.Compound: lambda shape: CompoundSurface(shape, surface_of),
}
"""The surface of each described shape, made from its description. A new shape is registered here."""


def surface_of(shape: described.Shape) -> Surface:
    """Return the geometry of a described shape."""
    return SURFACES[type(shape)](shape)
