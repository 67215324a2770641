"""A body that the triangles of a file enclose, convex or not."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ...arrays import Array
from ...descriptions.mesh_contact import TURN
from ...descriptions.shapes import Mesh
from ..footprint import tangents
from ..object_mesh import object_mesh
from ..outlines import Rubber
from .core import PENETRATION, Core, Geometry, Limits

GAP = 5e-5
"""Distance of a contact point from the triangles, m."""
TOUCHED = PENETRATION
"""What is so near to the tangent plane of a contact is touched by a rigid pad, m."""
_SLIVER = 1e-6
_FACING = 0.5
"""Cosine of the largest angle between what is touched and the face of the pad."""


class MeshGeometry:
    """The triangles of a file, as they are, and the mean normal that rubber feels on them.

    Pads yield: a facet's normal is not the surface's, and no plane is tangent to the corners of a polyhedron.
    """

    limits: Limits = Limits(gap=GAP, region=5e-5, margin=2e-4, turn=TURN, yields=True)

    def __init__(self, shape: Mesh) -> None:
        self._body = object_mesh(shape)
        self.cores: tuple[Core, ...] = (Core(self._body.solid, 0.0),)
        self.hull = Core(self._body.hull, 0.0)
        self.members, self.vertices, self.middle = self._body.members, self._body.vertices, self._body.middle

    @property
    def parts(self) -> tuple[tuple[Geometry, Array], ...]:
        """The body itself."""
        return ((self, np.eye(4)),)

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the nearest triangle."""
        return float(self._body.distances(point[None])[0])

    def distances(self, points: Array, below: float = math.inf) -> Array:
        """Signed distances of points, shape (n, 3), to the nearest triangles, shape (n,).

        Those that are not less than `below` (m) may come as anything that is not less than it.
        """
        return self._body.distances(points, below)

    def surrounds(self, points: Array) -> bool:
        """Whether one of the points, shape (n, 3), is inside: trees of triangles do not tell."""
        return bool(self._body.contains(points).any())

    def inward(self, point: Array) -> Array:
        """Inward footprint normal at `point`."""
        return -self._body.outward(point)

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds all triangles."""
        return float(np.linalg.norm(self._body.vertices - point, axis=1).max())

    def face(self, point: Array) -> Array:
        """Point itself: what else is in its plane is a matter of how exactly that is known (see `footprint`)."""
        return point[None]

    def footprint(self, pad_face: Array, point: Array, normal: Array) -> Array:
        """Return the hull of what of the surface is within `TOUCHED` of the tangent plane, and of the contact point."""
        if len(pad_face) == 1:
            return point[None]
        axes = tangents(normal)
        sides, offsets = _sides((pad_face - point) @ axes.T)
        normals = np.vstack([sides @ axes, normal, -normal])
        triangles, _ = self._body.clipped(normals, normals @ point + [*offsets, TOUCHED, TOUCHED])
        flat = np.vstack([(triangles.reshape(-1, 3) - point) @ axes.T, np.zeros(2)])
        try:
            hull = flat[ConvexHull(flat).vertices]
        except QhullError:  # all in a line: the body is touched by an edge
            hull = flat[_ends(flat)]
        return np.asarray(point + hull @ axes)

    def touched(self, rubber: Rubber) -> Array:
        """Return all within the rubber's rectangle that is no farther than its depth from the pad's face, and faces it.

        What is turned off by more than 60 degrees is not touched, as the top of a can whose side is held at the rim.
        """
        x, y, outward = rubber.rotation.T
        low, high = rubber.low - _SLIVER, rubber.high + _SLIVER
        normals = np.array([-x, -y, x, y, outward, -outward])
        offsets = normals @ rubber.origin + [*-low, *high, rubber.depth, rubber.depth]
        found, numbers = self._body.clipped(normals, offsets)
        a, b, c = self._body.vertices[self._body.faces[numbers]].transpose(1, 0, 2)
        across = np.cross(b - a, c - a)
        facing = across @ outward < -_FACING * np.linalg.norm(across, axis=1)
        return np.asarray(found[facing])

    def edge(self, point: Array) -> float:
        """Infinite: where faces end is not known of a mesh; the rubber's depth limits what is at its edges."""
        return math.inf


def _sides(polygon: Array) -> tuple[Array, Array]:
    """Return outward unit normals and offsets of a convex polygon of the plane, or of a sliver about a line."""
    if len(polygon) == 2:
        along = (polygon[1] - polygon[0]) / np.linalg.norm(polygon[1] - polygon[0])
        across = np.array([-along[1], along[0]])
        normals = np.array([along, -along, across, -across])
        return normals, (normals @ polygon.T).max(axis=1) + _SLIVER
    edges = np.roll(polygon, -1, axis=0) - polygon
    normals = np.column_stack([edges[:, 1], -edges[:, 0]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    if float((normals @ (polygon.mean(axis=0) - polygon[0]))[0]) > 0.0:
        normals = -normals
    return normals, (normals * polygon).sum(axis=1) + _SLIVER


def _ends(points: Array) -> list[int]:
    """Return the numbers of the two points of a line, or about one, that are farthest apart; one if all are one."""
    spread = points - points.mean(axis=0)
    along = spread @ np.linalg.svd(spread)[2][0]
    ends = [int(along.argmin()), int(along.argmax())]
    return ends if np.ptp(along) > _SLIVER else ends[:1]
