"""Convex pieces of an object that is given as triangles, and how far they stand off it where pads touch.

MuJoCo collides convex solids. Where the surface is convex the pieces of a fine cover follow it exactly; in hollows,
such as the inner side of a handle, they stand off it. So the distance is measured at each grasp's contacts.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from ..descriptions.shapes import Mesh
from ..geometry.cover_cache import body_cover
from ..geometry.filled import filled
from ..geometry.hulls import Hull, areas, spread
from ..geometry.object_mesh import object_mesh

PIECES, TOLERANCE = 64, 2e-4
"""Largest number of pieces, and distance to the mesh below which a piece is not divided any more, m."""
NEAR, FACING = 0.01, 0.5
"""What is looked at around a contact, m, and the cosine of the largest angle between it and the contact's normal."""
_SAMPLES = 60_000
_ALONG, _BESIDE = 1e-6, 1e-9
"""Cosine below which a facet is along a direction, and how far points beside a piece count as in it, m."""


def object_pieces(shape: Mesh) -> tuple[Array, ...]:
    """Return the vertices of convex pieces that together hold the body, each of shape (k, 3), its frame, m.

    Raises:
        FileError: the file cannot be read, has changed since it was described, or encloses no body.
    """
    return body_cover(shape.file.stem, object_mesh(shape).triangles, PIECES, TOLERANCE)


def filled_inertia(shape: Mesh) -> Array:
    """Return the inertia of the body filled evenly about its centre of mass per mass, m^2, shape (3, 3).

    It is that of tetrahedra between the triangles and the centre, with signed volumes: what parts share counts in each.
    """
    a, b, c = (object_mesh(shape).triangles - filled(shape).centroid).transpose(1, 0, 2)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    # The integral of x x^T over a tetrahedron with a corner at 0: V / 20 (aa + bb + cc + ss), s = a + b + c.
    squares = sum(np.einsum("i,ij,ik->jk", volumes, p, p) for p in (a, b, c, a + b + c))
    second = np.asarray(squares) / (20.0 * volumes.sum())
    return np.asarray(np.trace(second) * np.eye(3) - second)


class Standoff:
    """Measures how far convex pieces stand off the surface that they hold.

    Args:
        triangles: of the surface, shape (f, 3, 3), m.
        pieces: vertices of each piece, same frame.
    """

    def __init__(self, triangles: Array, pieces: Sequence[Array]) -> None:
        corners = triangles.transpose(1, 0, 2)
        across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normals = across / np.linalg.norm(across, axis=1, keepdims=True)
        sizes = areas(triangles)
        # Every point of a spread carries the normal of its triangle: triangles are spread alike with these as corners.
        self._points = spread(triangles, sizes, _SAMPLES)
        self._normals = spread(np.repeat(normals[:, None], 3, axis=1), sizes, _SAMPLES)
        hulls = [Hull(piece) for piece in pieces]
        self._planes = [(hull.normals, (hull.normals * hull.triangles[:, 0]).sum(axis=1)) for hull in hulls]

    def at(self, point: Array, normal: Array, depth: float) -> float:
        """Return by how much the pieces stand off what a pad touches, along the contact's normal, m.

        Args:
            point: contact point, shape (3,).
            normal: outward normal of the surface there, shape (3,).
            depth: how far the pad's rubber yields, m.
        """
        arms = self._points - point
        near = (np.linalg.norm(arms, axis=1) < NEAR) & (np.abs(arms @ normal) <= depth)
        touched = np.vstack([point, self._points[near & (self._normals @ normal > FACING)]])
        return max(float(_through(touched, normal, *planes).max()) for planes in self._planes)


def _through(points: Array, direction: Array, normals: Array, offsets: Array) -> Array:
    """Return how far it is along a direction out of a convex piece, 0 from points that are not in it, m, shape (n,)."""
    depths = offsets - points @ normals.T
    slopes = normals @ direction
    ways = np.where(slopes > _ALONG, np.maximum(depths, 0.0) / np.maximum(slopes, _ALONG), np.inf).min(axis=1)
    return np.where(depths.min(axis=1) > -_BESIDE, ways, 0.0)
