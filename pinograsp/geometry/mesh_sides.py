"""How often a surface goes around the places just outside of its own triangles.

The winding number is the same at both ends of a way that meets no triangle. So it is the same beside all triangles that
hang together by edges of two, as long as no other triangle crosses them or comes nearer than the way is off: one look
tells of all of these. What others cross or come near to is looked at triangle by triangle.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import igl
import igl.predicates
import numpy as np

from ..arrays import Array, Indices, Integers, Mask
from .mesh_parts import components, edges_of

OFF = 1e-5
"""How far from a triangle it is looked, in parts of the mesh's extent."""
FEWEST, MOST = 2, 6
"""Places along each edge of a triangle at which it is looked for an outside, where others cross it."""
APART = 0.002
"""How far apart these are, in parts of the mesh's extent, unless they are the fewest or the most."""
MIDDLE = np.full((1, 3), 1.0 / 3.0)
"""Share of each corner in the middle of a triangle."""


class OuterSides:
    """The outer sides of triangles.

    Args:
        vertices: shape (v, 3), m.
        faces: counter-clockwise seen from outside, shape (f, 3).
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        self._vertices, self._faces = vertices, np.ascontiguousarray(faces)
        self._extent = float(np.ptp(vertices, axis=0).max())
        a, b, c = (vertices - vertices.min(axis=0))[faces].transpose(1, 0, 2)
        self._normals = np.cross(b - a, c - a)
        lengths = np.linalg.norm(self._normals, axis=1)
        self._normals /= np.where(lengths > 0.0, lengths, 1.0)[:, None]
        self.areas = 0.5 * lengths
        """Of the triangles, m^2, shape (f,)."""
        self._around = igl.FastWindingNumberBVH()
        self._around.init(vertices, self._faces)

    @cached_property
    def windings(self) -> Array:
        """How often the surface goes around the middle of each outer side, shape (f,): 0 where it bounds the body."""
        patch = components(self._pairs[self._plain[self._pairs].all(axis=1)], len(self._faces))
        order = np.argsort(self.areas, kind="stable")
        largest = np.zeros(int(patch.max()) + 1, dtype=np.intp)
        largest[patch[order]] = order  # the last one counts
        return np.asarray(self._looked(largest, MIDDLE)[:, 0][patch])

    def outer(self) -> Mask:
        """Return which triangles do not lie wholly inside the body, shape (f,)."""
        outer = self.windings < 0.5
        within = np.flatnonzero(~outer & ~self._plain)
        outer[within] = (self._looked(within, _places(FEWEST)) < 0.5).any(axis=1)
        within = within[~outer[within]]
        corners = self._vertices[self._faces[within]]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        counts = np.minimum(np.ceil(longest / (APART * self._extent)), MOST).astype(np.intp)
        for count in np.unique(counts[counts > FEWEST]).tolist():
            some = within[counts == count]
            outer[some] = (self._looked(some, _places(count)) < 0.5).any(axis=1)
        return outer

    @cached_property
    def _plain(self) -> Mask:
        """Which triangles no other one crosses or touches, but at common corners and edges, or comes near to."""
        plain = np.ones(len(self._faces), dtype=bool)
        _, pairs, _ = igl.predicates.find_self_intersections(self._vertices, self._faces)
        plain[pairs] = False
        tree: Any = igl.AABB()
        tree.init(self._vertices, self._faces)
        asked = np.flatnonzero(plain)
        nearest = tree.squared_distance(self._vertices, self._faces, self._beside(asked, MIDDLE))[1]
        plain[asked[nearest != asked]] = False
        return plain

    @cached_property
    def _pairs(self) -> Integers:
        """Triangles that have an edge in common which is that of no other one, and face the same way, shape (n, 2)."""
        _, edge, direction, counts = edges_of(self._faces)
        joined = (counts == 2) & (np.bincount(edge, weights=direction) == 0.0)
        sides = np.argsort(edge, kind="stable")
        return np.asarray(sides[joined[edge[sides]]].reshape(-1, 2) // 3)

    def _beside(self, picked: Indices, shares: Array) -> Array:
        """Return places on the outer sides of triangles, shape (n k, 3), m.

        Args:
            picked: their numbers, shape (n,).
            shares: of their corners in the places, shape (k, 3).
        """
        corners = self._vertices[self._faces[picked]]
        places = np.einsum("kc,nci->nki", shares, corners) + OFF * self._extent * self._normals[picked][:, None]
        return np.ascontiguousarray(places.reshape(-1, 3))

    def _looked(self, picked: Indices, shares: Array) -> Array:
        """Return the winding numbers at these places, shape (n, k)."""
        windings = self._around.winding_number(self._beside(picked, shares))
        return np.asarray(windings).reshape(len(picked), len(shares))


def _places(count: int) -> Array:
    """Return shares of the corners in places all over a triangle, so many along each edge, shape (k, 3)."""
    steps = np.arange(count)
    grid = np.array([(i, j, count - 1 - i - j) for i in steps for j in steps if i + j < count]) + 0.1
    return np.asarray(grid / grid.sum(axis=1, keepdims=True))
