"""How often a surface goes around the places just outside of its own triangles.

It is looked at the middle of every triangle. What has no outside there may still reach out of the parts that it lies in
where these cross it: it is looked at more places.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..arrays import Array, Indices, Integers, Mask
from .winding import Winding

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
        self._around = Winding(vertices, self._faces)

    @cached_property
    def windings(self) -> Array:
        """How often the surface goes around the middle of each outer side, shape (f,): 0 where it bounds the body."""
        return self._looked(np.arange(len(self._faces)), MIDDLE)[:, 0]

    def outer(self) -> Mask:
        """Return which triangles do not lie wholly inside the body, shape (f,)."""
        outer = self.windings < 0.5
        within = np.flatnonzero(~outer)
        outer[within] = (self._looked(within, _places(FEWEST)) < 0.5).any(axis=1)
        within = within[~outer[within]]
        corners = self._vertices[self._faces[within]]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        counts = np.minimum(np.ceil(longest / (APART * self._extent)), MOST).astype(np.intp)
        for count in np.unique(counts[counts > FEWEST]).tolist():
            some = within[counts == count]
            outer[some] = (self._looked(some, _places(count)) < 0.5).any(axis=1)
        return outer

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
        return self._around.numbers(self._beside(picked, shares)).reshape(len(picked), len(shares))


def _places(count: int) -> Array:
    """Return shares of the corners in places all over a triangle, so many along each edge, shape (k, 3)."""
    steps = np.arange(count)
    grid = np.array([(i, j, count - 1 - i - j) for i in steps for j in steps if i + j < count]) + 0.1
    return np.asarray(grid / grid.sum(axis=1, keepdims=True))
