"""Exact distances to the surface of a triangle mesh."""

from __future__ import annotations

import coal
import numpy as np

from ..arrays import Array


class MeshSurface:
    """The surface of a mesh; what it encloses does not count.

    Args:
        triangles: shape (n, 3, 3), m.
    """

    def __init__(self, triangles: Array) -> None:
        corners = triangles.reshape(-1, 3)
        self._tree = coal.BVHModelOBBRSS()
        self._tree.beginModel(len(triangles), len(corners))
        self._tree.addVertices(corners)
        self._tree.addTriangles(np.arange(len(corners)).reshape(-1, 3))
        self._tree.endModel()
        self._request = coal.DistanceRequest()
        self._point = coal.Sphere(1e-9)

    def distances(self, points: Array) -> Array:
        """Return the distances of points, shape (n, 3), m, shape (n,)."""
        here, unturned = coal.Transform3s(), np.eye(3)
        places = [coal.Transform3s(unturned, point) for point in points]
        found = [
            coal.distance(self._tree, here, self._point, place, self._request, coal.DistanceResult())
            for place in places
        ]
        return np.maximum(found, 0.0)

    def distance_to(self, other: MeshSurface, pose: Array) -> float:
        """Return the distance to another surface, m, not positive where they intersect.

        Args:
            other: the other surface.
            pose: of the other's frame in this one's, shape (4, 4).
        """
        place, request = coal.Transform3s(pose[:3, :3], pose[:3, 3]), coal.DistanceRequest()
        request.enable_signed_distance = False  # depths of surfaces mean nothing
        here, result = coal.Transform3s(), coal.DistanceResult()
        return float(coal.distance(self._tree, here, other._tree, place, request, result))
