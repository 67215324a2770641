"""A triangle mesh and what it encloses."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import trimesh

from ..arrays import Array, Mask
from .hulls import Hull
from .mesh_surface import MeshSurface

_AT_ONCE = 200_000
"""Triangles of which solid angles are computed at once: more would take memory."""


class TriangleMesh:
    """Triangles of one body, closed or not.

    Args:
        triangles: corners counter-clockwise seen from outside, any frame, shape (n, 3, 3), m.
    """

    def __init__(self, triangles: Array) -> None:
        self.triangles = triangles

    @property
    def corners(self) -> Array:
        """Corners of all triangles, shape (3 n, 3), m."""
        return self.triangles.reshape(-1, 3)

    @cached_property
    def surface(self) -> MeshSurface:
        """The surface alone, to measure distances."""
        return MeshSurface(self.triangles)

    @cached_property
    def closed(self) -> bool:
        """Whether every edge belongs to two triangles."""
        return bool(self._merged.is_watertight)

    @cached_property
    def members(self) -> Array:
        """One corner of every connected part, shape (parts, 3), m."""
        groups = trimesh.graph.connected_components(self._merged.edges, nodes=self._merged.faces.ravel())
        return np.array([self._merged.vertices[group[0]] for group in groups], dtype=np.float64)

    def surrounds(self, points: Array) -> Mask:
        """Return which of the points, shape (n, 3), m, the mesh encloses; small holes do not spoil it.

        Raises:
            FlatError: the mesh lies in one plane.
        """
        inside = self._hull.holds(points)
        inside[inside] = [abs(winding_number(self.triangles, point)) > 0.5 for point in points[inside]]
        return inside

    def overlaps(self, other: TriangleMesh, pose: Array) -> bool:
        """Whether two surfaces intersect, or a part of one lies in what the other encloses.

        Args:
            other: the other mesh.
            pose: of the other's frame in this one's, shape (4, 4).

        Raises:
            FlatError: a mesh lies in one plane.
        """
        R, p = pose[:3, :3], pose[:3, 3]
        return (
            self.surface.distance_to(other.surface, pose) <= 0.0
            or bool(self.surrounds(other.members @ R.T + p).any())
            or bool(other.surrounds((self.members - p) @ R).any())
        )

    @cached_property
    def _hull(self) -> Hull:
        return Hull(self.corners)

    @cached_property
    def _merged(self) -> Any:
        """The mesh with corners at one place made one."""
        return trimesh.Trimesh(self.corners, np.arange(len(self.corners)).reshape(-1, 3), process=True)


def winding_number(triangles: Array, point: Array) -> float:
    """Return how often a surface goes around a point: its solid angle over 4 pi (van Oosterom and Strackee 1983).

    Small holes in the surface change it little.

    Args:
        triangles: shape (n, 3, 3), m.
        point: shape (3,), m.
    """
    if len(triangles) > _AT_ONCE:
        rest = range(0, len(triangles), _AT_ONCE)
        return sum(winding_number(triangles[first : first + _AT_ONCE], point) for first in rest)
    a, b, c = (triangles - point).transpose(1, 0, 2)
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volumes = (a * np.cross(b, c)).sum(axis=1)
    ab, bc, ca = ((one * other).sum(axis=1) for one, other in ((a, b), (b, c), (c, a)))
    return float(np.arctan2(volumes, la * lb * lc + ab * lc + bc * la + ca * lb).sum() / (2.0 * np.pi))
