"""Which triangles of a body others cross, and which ways on a triangle they leave free.

What lies on a triangle, within `LAYER` of its plane, does not cross it; what comes nearer to it from elsewhere than
that does, but for corners and edges that they share. Triangles whose boxes meet are found in a tree of boxes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from ..arrays import Array, Indices, Integers, Mask
from ..threads import on_all_cores
from .crossing_kernels import LAYER, are_avoided, are_free, boxes_around, pairs_that_cross

AT_ONCE = 4096
"""Triangles that a thread takes at a time."""
_BITS = 10
"""Of a coordinate, by which triangles are put in an order that keeps neighbours together."""


@dataclass(frozen=True)
class Crossings:
    """Triangles, each with those that cross it."""

    corners: Array
    """Shape (f, 3 corners, 3), m."""
    normals: Array
    """Unit length, shape (f, 3)."""
    starts: Indices
    """Where those that cross a triangle begin in `others`, and after the last one, shape (f + 1,)."""
    others: Indices
    """Those that cross the first one, the second one and so on, shape (n,)."""

    @property
    def crossed(self) -> Mask:
        """Which triangles others cross, shape (f,)."""
        return np.asarray(self.starts[1:] > self.starts[:-1])

    def free(self, numbers: Indices, starts: Array, ends: Array) -> Mask:
        """Return which straight ways on triangles are clear of all that cross these, shape (n,).

        Args:
            numbers: of the triangles, shape (n,).
            starts: shape (n, 3), m.
            ends: shape (n, 3), m.
        """
        return are_free(numbers, starts, ends, self.corners, self.normals, self.starts, self.others)


@dataclass(frozen=True)
class Around:
    """All triangles in a tree of boxes around them."""

    corners: Array
    """In the order of the tree, shape (f, 3 corners, 3), m."""
    normals: Array
    """Unit length, shape (f, 3)."""
    boxes: tuple[Array, Array, int]
    """As of `boxes_around`."""

    def avoided(self, starts: Array, ends: Array) -> Mask:
        """Return which straight ways, shape (n, 3), m, are clear of all triangles, shape (n,)."""
        return are_avoided(starts, ends, self.corners, self.normals, *self.boxes)


def crossings_of(
    vertices: Array, faces: Integers, normals: Array, looks: Array, within: float
) -> tuple[Crossings, Around, Mask]:
    """Return what crosses each triangle, all triangles, and which looks another one may be near to, shape (f, 2).

    What lies on a triangle is not near to looks at it.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
        normals: of the triangles, unit length, shape (f, 3).
        looks: points beside each triangle, no farther from it than twice `within`, shape (f, 2, 3), m.
        within: how near another triangle has to be to a look to count, m.
    """
    corners = np.ascontiguousarray(vertices[faces])
    order = _order(corners.mean(axis=1))
    ordered, seen = np.ascontiguousarray(faces[order]), looks[order]
    around = Around(corners[order], normals[order], boxes_around(corners[order], 2.0 * within + LAYER))
    close = np.zeros((len(faces), 2), dtype=bool)

    def pairs_from(start: int) -> Integers:
        end = min(start + AT_ONCE, len(faces))
        return pairs_that_cross(around.corners, around.normals, ordered, seen, within, *around.boxes, start, end, close)

    pairs = np.concatenate(on_all_cores([partial(pairs_from, start) for start in range(0, len(faces), AT_ONCE)]))
    near = np.empty_like(close)
    near[order] = close
    one, other = order[pairs[:, 0]], order[pairs[:, 1]]
    starts = np.concatenate([[0], np.bincount(one, minlength=len(faces)).cumsum()])
    crossings = Crossings(corners, normals, starts.astype(np.intp), other[one.argsort(kind="stable")])
    return crossings, around, near


def _order(points: Array) -> Indices:
    """Return an order of points, shape (n, 3), in which neighbours are near each other: that of Morton."""
    low, size = points.min(axis=0), max(float(np.ptp(points, axis=0).max()), 1e-300)
    cells = ((points - low) / size * (2**_BITS - 1)).astype(np.int64)
    place = np.zeros(len(points), dtype=np.int64)
    for bit in range(_BITS):
        for axis in range(3):
            place |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return place.argsort(kind="stable")
