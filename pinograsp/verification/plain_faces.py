"""Which triangles of a body have one side of it in front of them and another behind, all over.

The winding number is the same at both ends of a way that crosses no triangle. So it is the same all along the front of
a triangle, and all along its back, unless another triangle crosses it; then one look at its middle tells of every point
that has its foot on it whether that is inside. Where the surface has openings, the winding number changes along the way
by the solid angle of the openings over 4 pi: by less than a tenth at twice the radius of a ball around one.
"""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
import trimesh

from ..arrays import Array, Indices, Integers, Mask
from .coal_bodies import triangle_tree

_MEETINGS = 100
"""Pairs of triangles that touch, itself among them, for each triangle, at most."""
_BESIDE = 1e-9
"""Share of a triangle beside it that counts as on it."""
_FOLDED = -1.0 + 1e-9
"""Cosine of the angle between triangles with a common corner below which they lie on each other."""
_CLEAR = 2.0
"""Radius around an opening within which the winding number is asked, in parts of its own."""


def crossed(vertices: Array, faces: Integers) -> Mask:
    """Return which triangles touch others otherwise than in corners and edges that they share, shape (f,).

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """
    first, second = _meeting(vertices, faces).T
    common = (faces[first][:, :, None] == faces[second][:, None, :]).any(axis=2)
    count = common.sum(axis=1)
    across = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    across /= np.linalg.norm(across, axis=1)[:, None]
    bad = (count == 0) | (count == 3) | ((across[first] * across[second]).sum(axis=1) < _FOLDED)
    one = np.flatnonzero((count == 1) & ~bad)
    bad[one] = _pierced(vertices, faces, across, first[one], second[one]) | _pierced(
        vertices, faces, across, second[one], first[one]
    )
    found = np.zeros(len(faces), dtype=bool)
    found[first[bad]] = found[second[bad]] = True
    return found


def _meeting(vertices: Array, faces: Integers) -> Indices:
    """Return the pairs of triangles that touch, shape (n, 2)."""
    tree, here = triangle_tree(vertices, faces), coal.Transform3s()
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    request.num_max_contacts, request.enable_contact = _MEETINGS * len(faces), False
    coal.collide(tree, here, tree, here, request, result)
    pairs = np.array([(contact.b1, contact.b2) for contact in result.getContacts()], dtype=np.intp).reshape(-1, 2)
    return np.asarray(pairs[pairs[:, 0] < pairs[:, 1]])


def _pierced(vertices: Array, faces: Integers, across: Array, first: Indices, second: Indices) -> Mask:
    """Whether triangles are met by the edges, opposite a common corner, of others, shape (n,)."""
    a, b, c = vertices[faces[first]].transpose(1, 0, 2)
    apart = ~(faces[second][:, :, None] == faces[first][:, None, :]).any(axis=2)
    ends = vertices[faces[second][apart].reshape(-1, 2)]
    heights = np.einsum("nij,nj->ni", ends - a[:, None], across[first])
    through = heights[:, 0] * heights[:, 1] <= 0.0
    rise = heights[:, 0] - heights[:, 1]
    share = np.divide(heights[:, 0], rise, out=np.zeros(len(rise)), where=rise != 0.0)
    place = ends[:, 0] + share[:, None] * (ends[:, 1] - ends[:, 0])
    return np.asarray(through & (barycentric(place, a, b, c) > -_BESIDE).all(axis=1))


def barycentric(points: Array, a: Array, b: Array, c: Array) -> Array:
    """Return the shares of the corners of triangles in points of their planes, all of shape (n, 3)."""
    e, f, g = b - a, c - a, points - a
    ee, ef, ff = (e * e).sum(axis=1), (e * f).sum(axis=1), (f * f).sum(axis=1)
    eg, fg = (e * g).sum(axis=1), (f * g).sum(axis=1)
    area = ee * ff - ef * ef
    v, w = (ff * eg - ef * fg) / area, (ee * fg - ef * eg) / area
    return np.column_stack([1.0 - v - w, v, w])


def neighbours(faces: Integers) -> Indices:
    """Return the triangle at the edge opposite each corner; -1 where there is none or more than one, shape (f, 3)."""
    owner = np.tile(np.arange(len(faces)), 3)
    corner = np.repeat(np.arange(3), len(faces))
    edges = np.sort(np.concatenate([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]]), axis=1)
    order = np.lexsort(edges.T)
    found = edges[order]
    new = np.concatenate([[True], (found[1:] != found[:-1]).any(axis=1), [True]])
    starts = np.flatnonzero(new)
    pairs = starts[:-1][np.diff(starts) == 2]
    beside = np.full((len(faces), 3), -1, dtype=np.intp)
    for one, other in ((order[pairs], order[pairs + 1]), (order[pairs + 1], order[pairs])):
        beside[owner[one], corner[one]] = owner[other]
    return beside


class Openings:
    """Balls around the openings of a surface, in which the winding number is asked for.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        alike, edge = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
        net = np.bincount(edge.ravel(), weights=np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0), minlength=len(alike))
        border = alike[net != 0.0]
        loops: list[Any] = trimesh.graph.connected_components(border, nodes=np.unique(border)) if len(border) else []
        boxes = [(vertices[loop].min(axis=0), vertices[loop].max(axis=0)) for loop in loops]
        self._balls = [(0.5 * (low + high), _CLEAR * 0.5 * float(np.linalg.norm(high - low))) for low, high in boxes]

    def near(self, points: Array, radii: Array | float = 0.0) -> Mask:
        """Return which points, shape (n, 3), or balls of some radii (m) around them, reach into one of the balls."""
        found = np.zeros(len(points), dtype=bool)
        for center, radius in self._balls:
            found |= ((points - center) ** 2).sum(axis=1) <= (radius + radii) ** 2
        return found
