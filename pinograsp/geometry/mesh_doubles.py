"""Triangles that are there several times."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Indices, Integers, Mask
from .mesh_parts import components, edges_of, parts_of


def once(vertices: Array, faces: Integers, largest_hole: float) -> tuple[Integers, Indices, int]:
    """Return triangles once that are there several times, and not those of both directions, which enclose nothing.

    Copies stay that others need: where two parts share a face, it closes both. And of a part all of whose triangles
    are there from both sides, to be seen from both, one of each is kept if these enclose something, or if that is all.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
        largest_hole: diameter up to which holes are closed, m.

    Returns:
        Triangles, their indices in those given, and how many were left out, those with two corners at one place not
        counted.
    """
    real = np.flatnonzero((faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0]))
    ordered = np.sort(faces[real], axis=1)
    shifts = np.argmin(faces[real], axis=1)
    second = np.take_along_axis(faces[real], ((shifts + 1) % 3)[:, None], axis=1)[:, 0]
    sign = np.where(second == ordered[:, 1], 1, -1)
    size = int(faces.max()) + 1
    key = np.unique(ordered[:, 0] * size + ordered[:, 1], return_inverse=True)[1] * size + ordered[:, 2]
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    net = np.bincount(group, weights=sign).astype(np.int64)
    copies = _needed(ordered[first], net)
    both = _seen_from_both(vertices, ordered[first], net, largest_hole)
    rest = np.flatnonzero(sign == np.sign(net)[group])
    rest = rest[np.argsort(group[rest], kind="stable")]
    of = group[rest]
    number = np.arange(len(of)) - np.searchsorted(of, of)  # of a copy among those of its triangle
    chosen = np.sort(np.concatenate([rest[number < np.abs(copies)[of]], first[both]]))
    return faces[real[chosen]], real[chosen], len(real) - len(chosen)


def _needed(triangles: Integers, net: Integers) -> Integers:
    """Return how often triangles are kept: once, unless that leaves more edges open than there are.

    What is there a number of times as a whole is taken once. Then are looked at all triangles that are there most
    often, those that are there at least second most often, and so on; those that hang together at edges lose the copies
    that they have beyond the next, or none.

    Args:
        triangles: shape (n, 3).
        net: how often they are there, less how often the other way round, shape (n,).
    """
    if np.abs(net).max(initial=0) < 2:
        return net
    ends, edge, direction, _ = edges_of(triangles)
    edges, sign = edge.reshape(-1, 3), np.sign(net)
    times = _without_common_factor(edges, np.abs(net), len(ends))
    along = direction.reshape(-1, 3) * sign[:, None]
    copies, levels = times.copy(), np.union1d(times[times > 0], [1])
    balance = np.bincount(edge, weights=(along * times[:, None]).ravel())
    for high, low in zip(levels[:0:-1].tolist(), levels[-2::-1].tolist(), strict=True):
        some = np.flatnonzero(times >= high)
        part = parts_of(edges[some], len(ends))
        change = np.bincount(edges[some].ravel(), (high - low) * along[some].ravel(), len(ends))
        touched, at = np.unique(edges[some], return_index=True)
        owner = part[at // 3]
        opened = ((balance - change)[touched] != 0).astype(np.int64) - (balance[touched] != 0)
        left_out = np.bincount(owner, weights=opened) <= 0
        copies[some] -= np.where(left_out[part], high - low, 0)
        balance[touched] -= np.where(left_out[owner], change[touched], 0.0)
    return copies * sign


def _without_common_factor(edges: Integers, times: Integers, count: int) -> Integers:
    """Return how often triangles are there, divided by what is common to all that hang together at edges."""
    there = np.flatnonzero(times)
    part = parts_of(edges[there], count)
    order = np.argsort(part, kind="stable")
    common = np.gcd.reduceat(times[there][order], np.searchsorted(part[order], np.arange(int(part.max()) + 1)))
    divided = times.copy()
    divided[there] //= common[part]
    return divided


def _seen_from_both(vertices: Array, triangles: Integers, net: Integers, largest_hole: float) -> Mask:
    """Return which triangles are of parts that are there from both sides and enclose something, or are all.

    A part encloses something if its holes are closed, and are not as large as half of itself, as those of sheets.
    """
    none = net == 0
    if none.all() or not none.any():
        return np.asarray(none)
    part = parts_of(triangles, len(vertices))
    wholly = np.bincount(part, weights=~none) == 0
    ends, edge, _, counts = edges_of(triangles)
    of = np.empty(len(ends), dtype=np.int64)
    of[edge] = np.repeat(part, 3)
    border, of = ends[counts % 2 == 1], of[counts % 2 == 1]
    if len(border):
        loop = np.unique(components(border, len(vertices))[border[:, 0]], return_inverse=True)[1]
        size = _sizes(vertices[border], loop)[loop]
        wholly[of[size > np.minimum(largest_hole, 0.5 * _sizes(vertices[triangles], part)[of])]] = False
    return np.asarray(wholly[part])


def _sizes(places: Array, label: Integers) -> Array:
    """Return the diameters of balls around the places of each label, as those of holes are measured, m.

    Args:
        places: shape (n, k, 3), m.
        label: shape (n,).
    """
    points, of = places.reshape(-1, 3), np.repeat(label, places.shape[1])
    low, high = np.full((int(label.max()) + 1, 3), np.inf), np.full((int(label.max()) + 1, 3), -np.inf)
    np.minimum.at(low, of, points)
    np.maximum.at(high, of, points)
    radii = np.zeros(len(low))
    np.maximum.at(radii, of, np.linalg.norm(points - 0.5 * (low + high)[of], axis=1))
    return 2.0 * radii
