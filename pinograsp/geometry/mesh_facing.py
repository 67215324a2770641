"""Which way the parts of a surface face."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Indices, Integers, Mask
from ..words import number_of
from .mesh_parts import corners_of, parts_of, signed_volumes
from .winding import Winding

OFF = 1e-5
"""How far outside of a part it is looked for those around it, in parts of the mesh's extent."""
DEEPEST = 20
"""Parts that lie in more others are taken as if they lay in so many."""


def outward(vertices: Array, faces: Integers) -> tuple[Integers, list[str]]:
    """Return the triangles of every part facing outwards, but of cavities inwards; and what was turned, in words.

    A cavity is a part that lies wholly in the material of others, and in the file faces against solid parts around it,
    whichever way these do: a hollow body that is inside out is turned as a whole, and a file in which all is the other
    way round gives the same body. Solid are parts in the material that face as all solid parts around them, parts that
    lie in a cavity, and those that reach out of what they overlap. If no part faces inwards, none is a cavity.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """
    part = parts_of(faces, len(vertices))
    inverted = np.bincount(part, weights=signed_volumes(vertices, faces, part)) < 0.0
    if not inverted.any():
        return faces, []
    turned = inverted != _cavities(vertices, np.where(inverted[part][:, None], faces[:, ::-1], faces), part, inverted)
    if not turned.any():
        return faces, []
    count = int(turned.sum())
    some = f"{number_of(count, 'part')} of it {'is' if count == 1 else 'are'} inside out: turned"
    finding = "inside out: turned" if turned.all() else some
    return np.where(turned[part][:, None], faces[:, ::-1], faces), [finding]


def _cavities(vertices: Array, faces: Integers, part: Indices, inverted: Mask) -> Mask:
    """Return which parts are cavities, shape (parts,).

    Args:
        vertices: shape (v, 3), m.
        faces: all parts facing outwards, shape (f, 3).
        part: of each of them, shape (f,).
        inverted: which parts face inwards in the file, shape (parts,).
    """
    cavity, depth = np.zeros(len(inverted), dtype=bool), _depths(vertices, faces, part)
    for level in np.unique(depth[depth > 0]).tolist():
        around = depth < level
        for facing in (False, True):
            inner = (depth == level) & (inverted == facing)
            against = around & ~cavity & (inverted != facing)
            if not (inner.any() and against.any()):
                continue
            within = _wholly_in(vertices, faces, part, inner, against, cavity)
            if (around & cavity).any():
                within &= _wholly_in(vertices, faces, part, inner, around, cavity)
            cavity[within] = True
    return cavity


def _depths(vertices: Array, faces: Integers, part: Indices) -> Integers:
    """Return how many others go around the outer side of the largest triangle of each part, at most `DEEPEST`."""
    a, b, c = vertices[faces].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    order = np.lexsort((-lengths, part))
    largest = order[np.searchsorted(part[order], np.arange(int(part.max()) + 1))]
    out = normals[largest] / np.maximum(lengths[largest], np.finfo(np.float64).tiny)[:, None]
    beside = (a + b + c)[largest] / 3.0 + OFF * float(np.ptp(vertices, axis=0).max()) * out
    return np.clip(np.rint(Winding(vertices, faces).numbers(beside)), 0, DEEPEST).astype(np.int64)


def _wholly_in(vertices: Array, faces: Integers, part: Indices, inner: Mask, around: Mask, cavity: Mask) -> Mask:
    """Return which of some parts have all corners in the material of others, shape (parts,)."""
    outer, own = faces[around[part]], np.flatnonzero(inner[part])
    outer = np.where(cavity[part[around[part]]][:, None], outer[:, ::-1], outer)
    used = corners_of(faces[own], len(vertices))
    outside = np.zeros(len(vertices), dtype=bool)
    outside[used] = Winding(vertices, np.ascontiguousarray(outer)).numbers(vertices[used]) < 0.5
    out = np.bincount(part[own], weights=outside[faces[own]].any(axis=1), minlength=len(inner)) > 0
    return np.asarray(inner & ~out)
