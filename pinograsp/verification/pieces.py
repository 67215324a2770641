"""Triangles in pieces without long edges: boxes around needles hold much that is not near them.

Edges are halved, each for all triangles that have it, so that pieces share corners and edges as triangles do. Thousands
of needles side by side would be a hundred pieces each: there, longer edges stay.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Indices, Integers

FOR_EACH, BESIDES = 2, 50_000
"""Pieces at most, for each triangle and besides."""


def edges_of(ends: Integers) -> tuple[Integers, Indices]:
    """Return edges, each once and its lower end first, shape (e, 2), and the number of each one that was given.

    Args:
        ends: of edges, either way round, shape (n, 2).
    """
    low, high = ends.min(axis=1), ends.max(axis=1)
    base = int(high.max(initial=0)) + 1
    found, numbers = np.unique(low * base + high, return_inverse=True)
    return np.column_stack(np.divmod(found, base)), numbers.reshape(-1)


def in_pieces(vertices: Array, faces: Integers, longest: float) -> tuple[Array, Integers, Indices]:
    """Return triangles with no edge longer than a length: corners, faces, and the face that each is a piece of.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
        longest: m; it is doubled until there are no more than 2 f + 50,000 pieces.
    """
    while (found := _divided(vertices, faces, longest, FOR_EACH * len(faces) + BESIDES)) is None:
        longest *= 2.0
    return found


def _divided(vertices: Array, faces: Integers, longest: float, most: int) -> tuple[Array, Integers, Indices] | None:
    """Return triangles in pieces with no longer edge, as `in_pieces`; None if there are more than `most`."""
    owners = np.arange(len(faces))
    while len(faces) <= most:
        ends = faces[:, [[1, 2], [2, 0], [0, 1]]]  # of the edges opposite the corners
        long = np.linalg.norm(vertices[ends[:, :, 1]] - vertices[ends[:, :, 0]], axis=2) > longest
        if not long.any():
            return np.ascontiguousarray(vertices, dtype=np.float64), np.ascontiguousarray(faces, dtype=np.int64), owners
        edges, numbers = edges_of(ends[long])
        middles = np.full(faces.shape, -1)
        middles[long] = len(vertices) + numbers
        vertices = np.vstack([vertices, 0.5 * (vertices[edges[:, 0]] + vertices[edges[:, 1]])])
        count = long.sum(axis=1)
        found, of = [faces[count == 0]], [owners[count == 0]]
        for many in (1, 2, 3):
            chosen = np.flatnonzero(count == many)
            odd = (long if many == 1 else ~long)[chosen].argmax(axis=1)
            order = (odd[:, None] + np.arange(3)) % 3
            corners = np.take_along_axis(faces[chosen], order, axis=1).T
            parts = _parts(many, vertices, corners, np.take_along_axis(middles[chosen], order, axis=1).T)
            found += [np.stack(part, axis=1) for part in parts]
            of += [owners[chosen]] * len(parts)
        faces, owners = np.concatenate(found), np.concatenate(of)
    return None


def _parts(many: int, vertices: Array, corners: Integers, middles: Integers) -> list[tuple[Integers, ...]]:
    """Return the parts of triangles with so many halved edges, as their three corners.

    Args:
        many: number of edges that are halved; a single one, or a single other one, is opposite the first corner.
        vertices: shape (v, 3), m.
        corners: shape (3, n).
        middles: of the edges opposite them, shape (3, n).
    """
    (a, b, c), (bc, ca, ab) = corners, middles
    if many == 1:
        return [(a, b, bc), (a, bc, c)]
    if many == 3:
        return [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    ways = [np.linalg.norm(vertices[q] - vertices[p], axis=1) for p, q in ((ab, c), (b, ca))]
    shorter = ways[0] < ways[1]  # of the diagonals of what is left without the corner a
    return [(a, ab, ca), (ab, b, np.where(shorter, c, ca)), (np.where(shorter, ab, b), c, ca)]
