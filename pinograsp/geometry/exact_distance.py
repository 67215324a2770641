"""Exact signed distances to the triangles of a closed body."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..arrays import Array, Integers, Mask
from .triangle_tree import TriangleTree, nearest, triangle_tree
from .winding import Winding


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
    def _tree(self) -> TriangleTree:
        return triangle_tree(self.vertices, self.bounding)

    @cached_property
    def _around(self) -> Winding:
        return Winding(self.vertices, self.faces)

    def unsigned(self, points: Array) -> Array:
        """Return the distances of points, shape (n, 3), to the surface, m, shape (n,)."""
        return nearest(self._tree, points)[0]

    def inside(self, points: Array) -> Mask:
        """Return which of the points, shape (n, 3), are inside: small holes do not spoil it."""
        return np.asarray(self._around.numbers(points) > 0.5)

    def signed(self, points: Array) -> Array:
        """Return the signed distances of points, shape (n, 3), negative inside, m, shape (n,)."""
        return np.where(self.inside(points), -1.0, 1.0) * self.unsigned(points)
