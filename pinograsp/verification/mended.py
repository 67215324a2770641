"""Triangles as they come, made into the border of a body; written apart from `geometry.mesh_repair`.

**Copies.** A surface goes round the points of space as often as its winding number says, and the body is where that is
above a half. A triangle that is there n times one way and m times the other adds n - m times its share. Where |n - m|
is more than 1, the surplus goes, for all such triangles that hang together at edges, unless more edges then had an
unequal number of triangles along them each way. What is left, if anything, closes the surface all the same.

Where n = m throughout a part, it adds nothing: it is drawn from both sides. One of each two triangles stays if the part
has no opening that is wider than allowed, and wider than half of itself, or if there is nothing else.

**Facing.** Neighbours have an edge in common that no other triangle has; they face alike if they run along it in turn.
Patches in which they do not are turned until they do.

**Parts.** They hang together at edges; a patch that is closed on its own is a part whatever else touches its edges. The
signed volume of a part tells whether it faces inwards in the file. All are turned outwards first. How many others go
around a part (the least that some of its corners see) is its depth. From the least depth on, a part is a cavity if all
its corners are in the material of what is less deep, and in that of the solid parts of it that face against it in the
file. A cavity is taken off the material, and faces inwards. So it does not matter if all is inside out.
"""

from __future__ import annotations

import igl
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..arrays import Array, Indices, Integers, Mask
from .pieces import edges_of

CORNERS = 20
"""Of a part, at most, that tell how many others go around it."""


def mended(vertices: Array, faces: Integers, largest_hole: float) -> Integers:
    """Return the triangles that bound a body, counter-clockwise seen from outside.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3), with three different corners each.
        largest_hole: diameter of openings that parts may have which are drawn from both sides, m.
    """
    return _outward(vertices, _facing_alike(vertices, _once(vertices, faces, largest_hole)))


def _sides(faces: Integers) -> tuple[Indices, Array]:
    """Return the number of the edge of each side of triangles, and which way they run along it, shape (3 f,)."""
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return edges_of(ends)[1], np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0)


def _joined(links: Indices, count: int) -> Indices:
    """Return the group of each of so many triangles, which hang together at links, three each, shape (3 count,)."""
    own = np.tile(np.arange(count), 3)
    ends = (own, count + links)
    size = count + int(links.max(initial=-1)) + 1
    graph = coo_matrix((np.ones(len(own), dtype=np.int8), ends), shape=(size, size))
    return np.unique(connected_components(graph, directed=False)[1][:count], return_inverse=True)[1].astype(np.int64)


def _once(vertices: Array, faces: Integers, largest_hole: float) -> Integers:
    """Return the triangles without copies that nothing needs."""
    order = np.argsort(faces, axis=1)
    around = np.where((order[:, 1] - order[:, 0]) % 3 == 1, 1, -1)
    triples = np.take_along_axis(faces, order, axis=1)
    pair = edges_of(triples[:, :2])[1]
    _, first, group = np.unique(pair * len(vertices) + triples[:, 2], return_index=True, return_inverse=True)
    if len(first) == len(faces):
        return faces
    there = faces[first]
    net = np.asarray(np.bincount(group, weights=around) * around[first], dtype=np.float64)  # as the first of them faces
    times = _less_surplus(there, net)
    times[_drawn_from_both(vertices, there, net == 0.0, largest_hole)] = 1.0
    turned = np.where((times < 0.0)[:, None], there[:, ::-1], there)
    return np.ascontiguousarray(np.repeat(turned, np.abs(times).astype(np.int64), axis=0))


def _less_surplus(faces: Integers, net: Array) -> Array:
    """Return how often different triangles are kept, of how often they are there, shape (f,); less than 0: turned."""
    edge, along = _sides(faces)
    times = net.copy()
    many = np.abs(net) > 1.0
    if not many.any():
        return times
    some = np.tile(many, 3)
    group = _joined(edge[some], int(many.sum()))
    before = np.bincount(edge, weights=along * np.tile(net, 3))
    change = np.bincount(edge[some], weights=(along * np.tile(np.sign(net) - net, 3))[some], minlength=len(before))
    touched, at = np.unique(edge[some], return_index=True)
    opened = ((before + change)[touched] != 0.0).astype(float) - (before[touched] != 0.0)
    needless = np.bincount(group[at % len(group)], weights=opened) <= 0.0
    less = np.flatnonzero(many)[needless[group]]
    times[less] = np.sign(times[less])
    return times


def _drawn_from_both(vertices: Array, faces: Integers, both: Mask, largest_hole: float) -> Mask:
    """Return which triangles are of parts that are there from both sides and enclose something, or are all."""
    if both.all() or not both.any():
        return both
    edge, _ = _sides(faces)
    part = _joined(edge, len(faces))
    wholly = np.bincount(part, weights=~both) == 0.0
    for number in np.flatnonzero(wholly).tolist():
        own = faces[part == number]
        ends = np.concatenate([own[:, [0, 1]], own[:, [1, 2]], own[:, [2, 0]]])
        edges, sides = edges_of(ends)
        border = edges[np.bincount(sides) % 2 == 1]
        graph = coo_matrix((np.ones(len(border)), border.T), shape=(len(vertices), len(vertices)))
        opening = connected_components(graph, directed=False)[1][border[:, 0]]
        widest = min(largest_hole, 0.5 * _across(vertices[own.ravel()]))
        wholly[number] = all(_across(vertices[border[opening == k].ravel()]) <= widest for k in np.unique(opening))
    return np.asarray(wholly[part])


def _across(points: Array) -> float:
    """Return the diameter of a ball around the middle of points that holds them, m."""
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return 2.0 * float(np.linalg.norm(points - middle, axis=1).max())


def _facing_alike(vertices: Array, faces: Integers) -> Integers:
    """Return the triangles, those of patches in which neighbours face opposite ways turned, so that the patch encloses.

    Neighbours have an edge in common that no other triangle has; they face alike if they run along it in turn.
    """
    edge, along = _sides(faces)
    wrong = ((np.bincount(edge) == 2) & (np.bincount(edge, weights=along) != 0.0))[edge]
    if not wrong.any():
        return faces
    alike, patch = (np.asarray(found, dtype=np.int64) for found in igl.bfs_orient(np.ascontiguousarray(faces)))
    alike = np.where((_volumes(vertices, alike, patch) < 0.0)[patch][:, None], alike[:, ::-1], alike)
    return np.where(np.isin(patch, patch[np.tile(np.arange(len(faces)), 3)[wrong]])[:, None], alike, faces)


def _volumes(vertices: Array, faces: Integers, part: Indices) -> Array:
    """Return six times the signed volume of each part, seen from the middle of its triangles, m^3."""
    corners = vertices[faces]
    count = np.bincount(part)
    middles = np.stack([np.bincount(part, corners[:, :, k].mean(axis=1)) / count for k in range(3)], axis=1)
    a, b, c = (corners - middles[part][:, None]).transpose(1, 0, 2)
    return np.asarray(np.bincount(part, weights=np.einsum("ij,ij->i", a, np.cross(b, c))), dtype=np.float64)


def _parts(faces: Integers) -> Indices:
    """Return the part of each triangle, shape (f,)."""
    edge, along = _sides(faces)
    alone = np.bincount(edge)[edge] <= 2
    links = np.where(alone, edge, edge.max() + 1 + np.arange(len(edge)))
    patch = _joined(links, len(faces))
    if alone.all():
        return patch
    places, place = np.unique(edge * (int(patch.max()) + 1) + np.tile(patch, 3), return_inverse=True)
    uneven = np.bincount(place, weights=along, minlength=len(places)) != 0.0
    open_ones = np.unique(np.tile(patch, 3)[uneven[place]])
    within = np.isin(np.tile(patch, 3), open_ones)
    return _joined(np.where(within, edge, links), len(faces))


def _outward(vertices: Array, faces: Integers) -> Integers:
    """Return the triangles of parts facing outwards, those of cavities inwards."""
    part = _parts(faces)
    inward = _volumes(vertices, faces, part) < 0.0
    if not inward.any():
        return faces
    outward = np.where(inward[part][:, None], faces[:, ::-1], faces)
    cavity = np.zeros(len(inward), dtype=bool)
    if not inward.all():
        depth = _depths(vertices, outward, part)
        for level in np.unique(depth[depth > 0]).tolist():
            around, here = depth < level, depth == level
            material = _least(vertices, outward, part, around, here, cavity) > 0.5
            for way in (False, True):
                against = around & ~cavity & (inward != way)
                of = here & material & (inward == way)
                cavity |= of & (_least(vertices, outward, part, against, of, cavity) > 0.5)
    return np.ascontiguousarray(np.where(cavity[part][:, None], outward[:, ::-1], outward))


def _least(vertices: Array, faces: Integers, part: Indices, around: Mask, of: Mask, cavity: Mask) -> Array:
    """Return the least winding number of some parts that corners of others see, shape (parts,); 0 of all the rest."""
    found = np.zeros(len(of))
    if not (around.any() and of.any()):
        return found
    outer = np.where(cavity[part][:, None], faces[:, ::-1], faces)[around[part]]
    own = of[part]
    corners, number = np.unique(faces[own], return_inverse=True)
    seen = _winding(vertices, outer, vertices[corners])[number.reshape(-1, 3)].min(axis=1)
    found[of] = np.inf
    np.minimum.at(found, part[own], seen)
    return found


def _depths(vertices: Array, faces: Integers, part: Indices) -> Integers:
    """Return how many other parts go around each, as some of its corners see it, shape (parts,)."""
    order = np.argsort(part, kind="stable")
    parts = np.split(faces[order], np.flatnonzero(np.diff(part[order])) + 1)
    corners = [np.unique(own) for own in parts]
    away = [vertices[own[:: -(-len(own) // CORNERS)]] for own in corners]
    seen = np.split(_winding(vertices, faces, np.concatenate(away)), np.cumsum([len(some) for some in away])[:-1])
    others = [every - _winding(vertices, own, some) for every, own, some in zip(seen, parts, away, strict=True)]
    return np.array([round(float(number.min())) for number in others], dtype=np.int64)


def _winding(vertices: Array, faces: Integers, points: Array) -> Array:
    """Return the winding numbers of points, shape (n, 3), shape (n,)."""
    used, numbers = np.unique(faces, return_inverse=True)
    tree = igl.FastWindingNumberBVH()
    tree.init(np.ascontiguousarray(vertices[used]), np.ascontiguousarray(numbers.reshape(-1, 3).astype(np.int64)))
    return np.asarray(tree.winding_number(np.ascontiguousarray(points)))
