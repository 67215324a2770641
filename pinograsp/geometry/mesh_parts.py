"""What triangles share: corners, edges, and the parts that hold together."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..arrays import Array, Integers, Mask


def corners_of(faces: Integers, count: int) -> Mask:
    """Return which of a number of vertices triangles have."""
    used = np.zeros(count, dtype=bool)
    used[faces] = True
    return used


def components(pairs: Integers, count: int) -> Integers:
    """Return the number of the connected part of each node of a graph."""
    graph = coo_matrix((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def edges_of(faces: Integers) -> tuple[Integers, Integers, Integers, Integers]:
    """Return the edges, of each side of a triangle the edge and the direction, and how many sides each edge has.

    Ends of edges are in order, shape (e, 2); sides go triangle by triangle, shape (3 f,); a direction is 1 or -1.
    """
    start, end = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    size = int(faces.max()) + 1
    sides = np.minimum(start, end) * size + np.maximum(start, end)
    keys, edge, counts = np.unique(sides, return_inverse=True, return_counts=True)
    return np.stack(np.divmod(keys, size), axis=1), edge, np.where(start < end, 1, -1), counts


def parts_of(faces: Integers, count: int) -> Integers:
    """Return the number of the part of each triangle: triangles that share corners are of one."""
    label = components(np.concatenate([faces[:, :2], faces[:, 1:]]), count)
    return np.unique(label[faces[:, 0]], return_inverse=True)[1]


def signed_volumes(vertices: Array, faces: Integers, part: Integers) -> Array:
    """Return the signed volumes between triangles and the mean corner of their parts, shape (f,), m^3."""
    corners = vertices[faces]
    counts = np.maximum(np.bincount(part), 1)
    means = np.stack([np.bincount(part, weights=column) / counts for column in corners.mean(axis=1).T], axis=1)
    a, b, c = (corners - means[part][:, None]).transpose(1, 0, 2)
    return np.asarray(np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0)
