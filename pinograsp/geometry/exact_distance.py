"""Exact signed distances to the triangles of a closed body."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import igl
import numpy as np

from ..arrays import Array, Integers, Mask


class ExactDistance:
    """Distances to triangles; a point is inside if the surface goes around it. Trees are made when first asked for.

    Args:
        vertices: shape (v, 3), m.
        faces: corners counter-clockwise seen from outside, shape (f, 3).
        outer: which faces bound the body, shape (f,): where parts overlap, some lie inside. All if not given.
    """

    def __init__(self, vertices: Array, faces: Integers, outer: Mask | None = None) -> None:
        self.vertices = np.ascontiguousarray(vertices, dtype=np.float64)
        self.faces = np.ascontiguousarray(faces, dtype=np.int64)
        self.bounding = self.faces if outer is None or outer.all() else self.faces[outer]
        """The faces to which distances are measured, shape (g, 3)."""

    @cached_property
    def _tree(self) -> Any:
        tree = igl.AABB()
        tree.init(self.vertices, self.bounding)
        return tree

    @cached_property
    def _around(self) -> Any:
        around = igl.FastWindingNumberBVH()
        around.init(self.vertices, self.faces)
        return around

    def unsigned(self, points: Array) -> Array:
        """Return the distances of points, shape (n, 3), to the surface, m, shape (n,)."""
        squares = self._tree.squared_distance(self.vertices, self.bounding, np.ascontiguousarray(points))[0]
        return np.asarray(np.sqrt(squares))

    def inside(self, points: Array) -> Mask:
        """Return which of the points, shape (n, 3), are inside: small holes do not spoil it."""
        return np.asarray(self._around.winding_number(np.ascontiguousarray(points)) > 0.5)

    def signed(self, points: Array) -> Array:
        """Return the signed distances of points, shape (n, 3), negative inside, m, shape (n,)."""
        return np.where(self.inside(points), -1.0, 1.0) * self.unsigned(points)
