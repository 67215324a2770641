"""Exact distances of points to a triangle mesh."""

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
