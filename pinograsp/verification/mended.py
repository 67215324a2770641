"""Triangles of a file as the surface of what they enclose: each once, facing outwards; written apart from `geometry`.

**Copies.** A triangle that is there twice the same way round counts twice in the winding number. Surplus copies that
hang together at edges go, unless that leaves more edges open than there were: where parts share a face, both need it.
Triangles that are there both ways round enclose nothing together and go; but of a part all of whose triangles are, as
where both sides are to be seen, one of each stays.

**Directions.** Triangles of a patch in which neighbours face opposite ways are turned alike. Then the parts, which
share no corner, are turned. One that no other part holds faces outwards. One that others hold belongs to the smallest
of these: it faces as that one does if it does so in the file, and else against it, as the wall of a cavity.
"""

from __future__ import annotations

import igl
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..arrays import Array, Indices, Integers
from .pieces import edges_of


def mended(vertices: Array, faces: Integers) -> Integers:
    """Return the triangles that count, each facing outwards, shape (k, 3).

    Args:
        vertices: one for all triangles that meet there, shape (v, 3), m.
        faces: shape (f, 3), f > 0.
    """
    return _outward(vertices, _facing_alike(vertices, _once(faces, len(vertices))))


def signed_volumes(vertices: Array, faces: Integers) -> Array:
    """Return six times the volumes between triangles and the mean of the vertices, m^3, shape (f,)."""
    a, b, c = (vertices - vertices.mean(axis=0))[faces].transpose(1, 0, 2)
    return np.asarray(np.einsum("ij,ij->i", a, np.cross(b, c)))


def _once(faces: Integers, count: int) -> Integers:
    """Return triangles without surplus copies, and without those that are there both ways round."""
    _, first, same = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_inverse=True)
    same = same.ravel()
    if len(first) == len(faces):
        return faces
    sign = np.where(_is_even(faces), 1, -1)
    net = np.bincount(same, weights=sign).astype(np.int64)
    whole = np.bincount(_parts(faces[first], count), weights=net != 0) == 0  # parts that are there both ways round
    both = whole[_parts(faces[first], count)]
    left = np.where(both, 1, np.abs(net))
    way = np.where(both | (sign[first] == np.sign(net)), 1, -1)
    chosen = np.where((way > 0)[:, None], faces[first], faces[first][:, ::-1])
    return np.repeat(chosen, _needed(chosen, left), axis=0)


def _is_even(faces: Integers) -> Array:
    """Return whether triangles run through their corners as these are numbered, shape (f,)."""
    turned = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    return np.asarray(turned[:, 1] < turned[:, 2])


def _needed(faces: Integers, times: Integers) -> Integers:
    """Return how often triangles, each there so many times, are kept: once if that opens no more edges than it closes.

    It is asked of all surplus copies that hang together at edges.
    """
    surplus = np.flatnonzero(times > 1)
    if not len(surplus):
        return times
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges, edge = edges_of(ends)
    along = np.where(ends[:, 0] < ends[:, 1], 1, -1)
    net = np.bincount(edge, weights=along * np.tile(times, 3), minlength=len(edges)).astype(np.int64)
    of = edge.reshape(3, -1).T[surplus]
    links = coo_matrix(
        (np.ones(of.size), (np.repeat(np.arange(len(surplus)), 3), of.ravel())), shape=(len(surplus), len(edges))
    )
    _, group = connected_components(links @ links.T, directed=False)
    kept = times.copy()
    for number in range(int(group.max()) + 1):
        own = group == number
        less = np.zeros_like(net)
        np.add.at(less, of[own], along.reshape(3, -1).T[surplus[own]] * (times[surplus[own]] - 1)[:, None])
        touched = np.unique(of[own])
        if np.abs(net - less)[touched].sum() <= np.abs(net)[touched].sum():
            kept[surplus[own]], net = 1, net - less
    return kept


def _facing_alike(vertices: Array, faces: Integers) -> Integers:
    """Return the triangles, those of patches in which neighbours face opposite ways turned, so that the patch encloses.

    Neighbours have an edge in common that no other triangle has; they face alike if they run along it in turn.
    """
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    owner = np.tile(np.arange(len(faces)), 3)
    edge = edges_of(ends)[1]
    sides = np.bincount(edge)
    net = np.bincount(edge, weights=np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0))
    wrong = owner[((sides == 2) & (net != 0.0))[edge]]
    if not len(wrong):
        return faces
    alike, patch = (np.asarray(found, dtype=np.int64) for found in igl.bfs_orient(np.ascontiguousarray(faces)))
    inverted = np.bincount(patch, weights=signed_volumes(vertices, alike)) < 0.0
    alike = np.where(inverted[patch][:, None], alike[:, ::-1], alike)
    return np.where(np.isin(patch, patch[wrong])[:, None], alike, faces)


def _outward(vertices: Array, faces: Integers) -> Integers:
    """Return the triangles, those of parts that face the wrong way turned."""
    part = _parts(faces, len(vertices))
    volumes = np.bincount(part, weights=signed_volumes(vertices, faces)).astype(np.float64)
    sign = np.where(volumes < 0.0, -1, 1)
    if (sign > 0).all():
        return faces
    holder, right = _holders(vertices, faces, part, volumes), sign.copy()
    for number in np.argsort(-np.abs(volumes)).tolist():  # holders come before what they hold
        own = holder[number]
        right[number] = 1 if own < 0 else right[own] * sign[own] * sign[number]
    return np.where((right != sign)[part][:, None], faces[:, ::-1], faces)


def _holders(vertices: Array, faces: Integers, part: Indices, volumes: Array) -> Integers:
    """Return which larger part is the smallest one that holds all corners of each part, -1: none; shape (parts,)."""
    count = len(volumes)
    corners = [np.unique(faces[part == number]) for number in range(count)]
    low = np.array([vertices[own].min(axis=0) for own in corners])
    high = np.array([vertices[own].max(axis=0) for own in corners])
    holder = np.full(count, -1)
    for outer in np.argsort(-np.abs(volumes)).tolist():
        within = (low >= low[outer]).all(axis=1) & (high <= high[outer]).all(axis=1)
        some = np.flatnonzero(within & (np.abs(volumes) < abs(volumes[outer])))
        if not len(some):
            continue
        winding = igl.FastWindingNumberBVH()
        winding.init(vertices, np.ascontiguousarray(faces[part == outer]))
        for inner in some.tolist():
            numbers = np.asarray(winding.winding_number(np.ascontiguousarray(vertices[corners[inner]])))
            if (np.abs(numbers) > 0.5).all():
                holder[inner] = outer
    return holder


def _parts(faces: Integers, count: int) -> Indices:
    """Return the number of the part, which shares no corner with others, that each triangle belongs to, shape (f,)."""
    links = coo_matrix(
        (np.ones(2 * len(faces)), (faces[:, :2].T.ravel(), faces[:, 1:].T.ravel())), shape=(count, count)
    )
    _, label = connected_components(links, directed=False)
    return np.asarray(np.unique(label[faces[:, 0]], return_inverse=True)[1])
