"""The body that a mesh encloses: see `distance_field`.

Its faces are what somebody measured or modelled, so that neither one facet nor its edges say what a pad feels: contact
faces are spots, and pads lie on the mean of the surface below them.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...arrays import Array, Indices
from ...descriptions.shapes import Mesh
from ...memo import remembered
from ..contact_faces import ContactFace, Spot
from ..convex_solid import ConvexPiece, convex_solid
from ..cover_cache import body_cover
from ..distance_field import APART, DistanceField
from ..exact_distance import ExactDistance
from ..field_bounds import Bounds, bounds_of
from ..field_cache import mesh_field
from ..field_kernels import field_distances, field_normals, nearest_points
from ..hulls import Hull
from ..object_mesh import object_mesh
from ..point_trees import PointTrees, deepest_point, point_trees
from ..tessellation import Tessellation, refined

PIECES, TOLERANCE = 12, 0.002
"""Of the cover that stands for the body as an obstacle: largest number of pieces, and distance to the mesh below which
a piece is not divided any more, m."""
SPACING = 0.003
"""Longest edge between points of the surface that are looked for in links, m."""
CONVEX = 0.99
"""Share of its convex hull that a body fills if it counts as convex."""


class BodySurface:
    """Geometry of the body within a mesh, in the mesh's frame."""

    uneven = True
    edged = False

    def __init__(self, shape: Mesh) -> None:
        mesh = object_mesh(shape)
        self._name, self._vertices, self._faces, self._outer = shape.file.stem, mesh.vertices, mesh.faces, mesh.outer
        self.radius = float(np.linalg.norm(mesh.vertices, axis=1).max())

    @cached_property
    def field(self) -> DistanceField:
        """Signed distance and footprint normals as functions of space."""
        return mesh_field(self._name, self._exact)

    @cached_property
    def _bounds(self) -> Bounds:
        return bounds_of(self.field.distance, self.field.above, APART)

    @cached_property
    def _exact(self) -> ExactDistance:
        return ExactDistance(self._vertices, self._faces, self._outer)

    @cached_property
    def least_width(self) -> float:
        """That of the convex hull, between a facet and what is opposite; 0 of a body that is not convex, m.

        Parts of such a body, a handle or a rim, may be narrower than its hull.
        """
        a, b, c = self._vertices[self._faces].transpose(1, 0, 2)
        volume, hull = float((a * np.cross(b, c)).sum()) / 6.0, Hull(self._vertices)
        if volume < CONVEX * hull.volume:
            return 0.0
        heights = hull.vertices @ hull.normals.T
        return float(np.ptp(heights, axis=0).min())

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian: next to exact near the surface, about right elsewhere."""
        return field_distances(self.field, points)

    def footprint(self, points: Array) -> tuple[Array, Array]:
        """Return the normals of the smoothed distance and their derivatives."""
        return field_normals(self.field, points)

    def nearest_points(
        self, sets: PointTrees, rotations: Array, translations: Array, least: Array, caps: Array
    ) -> tuple[Indices, Array, Array, Array]:
        """Return which sets of points are nearer than their cap, with distances, points and gradients there."""
        return nearest_points(sets, self.field, self._bounds, rotations, translations, least, caps)

    def deepest_point(self, normals: Array, offsets: Array) -> tuple[float, Array, int]:
        """Return how deep the surface is in a convex solid, the point there of those `SPACING` apart, and the facet."""
        return deepest_point(self._points, normals, offsets)

    @cached_property
    def _points(self) -> PointTrees:
        return point_trees([refined(self.tessellation(), SPACING).vertices], [0])

    def exact_distances(self, points: Array) -> Array:
        """Return the signed distances to the triangles."""
        return self._exact.signed(points)

    def radius_about(self, point: Array | tuple[float, float, float]) -> float:
        """Return the distance of the corner that is farthest from the point."""
        return float(np.linalg.norm(self._vertices - point, axis=1).max())

    def nearest_part(self, points: Array) -> Indices:
        """Return 0 for every point."""
        return np.zeros(len(points), dtype=np.intp)

    def contact_face(self, point: Array) -> ContactFace:
        """Return a spot."""
        return Spot()

    def extent(self, direction: Array) -> float:
        """Return what the corner reaches that is farthest along the direction."""
        return float((self._vertices @ direction).max())

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return the pieces of a cover: convex, they hold the body together and stand off it a little."""
        pieces = body_cover(self._name, self._vertices[self._faces], PIECES, TOLERANCE)
        return tuple(ConvexPiece(convex_solid(vertices)) for vertices in pieces)

    def tessellation(self) -> Tessellation:
        """Return the triangles of the mesh."""
        return Tessellation(self._vertices, self._faces)


@remembered
def body_surface(shape: Mesh) -> BodySurface:
    """Return the surface of a described mesh, made once."""
    return BodySurface(shape)
