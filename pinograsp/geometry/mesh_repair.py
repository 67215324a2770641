"""Triangles as they come from files made into the border of a body, as far as that can be done without guessing.

A surface is closed in the sense of the winding number if its triangles go along every edge as often one way as the
other: then every point is enclosed a whole number of times, and the body is where that number is positive. That is
asked here, rather than that every edge has two triangles: bodies may consist of parts that overlap, touch or share
edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import igl
import numpy as np
from scipy.spatial import cKDTree

from ..arrays import Array, Indices, Integers, Mask
from ..words import number_of
from .mesh_doubles import once
from .mesh_facing import outward
from .mesh_holes import hole_caps
from .mesh_parts import components, corners_of, edges_of, signed_volumes
from .mesh_sides import OuterSides
from .no_body import NoBodyError, in_brackets

NEAR = 1e-6
"""Corners that are nearer than this part of the body's extent are one."""
ADDED = -1
"""Origin of a triangle that closes a hole."""
GHOST = 0.01
"""Part of the area that may enclose nothing, at creases and seams."""


@dataclass(frozen=True)
class Repaired:
    """Triangles that enclose a body."""

    vertices: Array
    """Shape (v, 3), m."""
    faces: Integers
    """Shape (f, 3), counter-clockwise seen from outside."""
    origin: Indices
    """Index of the triangle that each is, -1: one that closes a hole; shape (f,)."""
    outer: Mask
    """Which triangles bound the body, and do not lie wholly inside it where parts overlap; shape (f,)."""
    findings: tuple[str, ...]
    """What was mended, in words."""


def repaired(vertices: Array, faces: Integers, largest_hole: float) -> Repaired:
    """Return the border of a body.

    Args:
        vertices: shape (v, 3), finite, m.
        faces: shape (f, 3).
        largest_hole: diameter up to which holes are closed, m.

    Raises:
        NoBodyError: it is flat, has a larger hole, or its triangles enclose nothing.
    """
    vertices, faces = _merged(vertices, faces)
    _require_extent(vertices)
    faces, origin, doubled = once(vertices, faces, largest_hole)
    faces, turned = _consistent(vertices, faces)
    findings = [f"{number_of(doubled, 'doubled triangle')} left out"] if doubled else []
    findings += [f"{number_of(turned, 'triangle')} against the direction of their neighbours turned"] if turned else []
    faces, inside_out = outward(vertices, faces)
    findings += inside_out
    vertices, caps, holes = hole_caps(vertices, faces, largest_hole)
    findings += holes
    faces = np.concatenate([faces, caps])
    origin = np.concatenate([origin, np.full(len(caps), ADDED)])
    sides = OuterSides(vertices, faces)
    _require_body(vertices, faces, sides)
    extent = float(np.ptp(vertices, axis=0).max())
    real = sides.areas > 0.5e-13 * extent**2  # slivers enclose and measure nothing
    outer = sides.outer()[real]
    return Repaired(vertices, np.ascontiguousarray(faces[real]), origin[real], outer, tuple(findings))


def _merged(vertices: Array, faces: Integers) -> tuple[Array, Integers]:
    """Return corners at one place made one: seams of textures and normals, and rounding, part no triangles."""
    used = corners_of(faces, len(vertices))
    vertices, faces = vertices[used], (np.cumsum(used) - 1)[faces]
    key = np.zeros(len(vertices), dtype=np.int64)
    for column in vertices.T:
        rank = np.unique(column, return_inverse=True)[1]
        key = np.unique(key * (int(rank.max()) + 1) + rank, return_inverse=True)[1]
    first = np.unique(key, return_index=True)[1]
    vertices, faces = vertices[first], key[faces]
    pairs = cKDTree(vertices).query_pairs(NEAR * float(np.ptp(vertices, axis=0).max()), output_type="ndarray")
    if len(pairs):
        label = components(pairs, len(vertices))
        vertices, faces = vertices[np.unique(label, return_index=True)[1]], label[faces]
    return vertices, faces


def _require_extent(vertices: Array) -> None:
    spread = np.linalg.eigvalsh(np.cov(vertices.T)) if len(vertices) > 3 else np.zeros(3)
    if spread[0] <= (1e-6) ** 2 * spread[2]:
        raise NoBodyError("lies in one plane and encloses no volume", "A body has a thickness; model it as a solid")


def _consistent(vertices: Array, faces: Integers) -> tuple[Integers, int]:
    """Return the triangles with neighbours that face the same way, where an edge has two; and how many were turned."""
    _, edge, direction, counts = edges_of(faces)
    net = np.bincount(edge, weights=direction)
    if not ((counts == 2) & (net != 0)).any():
        return faces, 0
    alike, patch = igl.bfs_orient(np.ascontiguousarray(faces))
    alike = np.asarray(alike, dtype=np.int64)
    volumes = np.bincount(patch, weights=signed_volumes(vertices, alike, patch))
    alike = np.where((volumes < 0.0)[patch][:, None], alike[:, ::-1], alike)
    same = (alike == faces).all(axis=1) | (np.roll(alike, 1, axis=1) == faces).all(axis=1)
    same |= (np.roll(alike, 2, axis=1) == faces).all(axis=1)
    turned = int((~same).sum())
    return alike, min(turned, len(faces) - turned)


def _require_body(vertices: Array, faces: Integers, sides: OuterSides) -> None:
    """Refuse triangles many of which bound nothing, or that enclose no volume.

    Triangles bound nothing where a surface crosses itself, and its inner side is outside from there on. Such parts may
    make up for the volume of the others: that they are there is what is told.
    """
    ghosts = np.where(sides.windings < -0.5, sides.areas, 0.0)
    share = float(ghosts.sum() / sides.areas.sum())
    if share > GHOST:
        place = vertices[faces[int(np.argmax(ghosts))]].mean(axis=0)
        problem = f"crosses itself: {100.0 * share:.0f} % of its surface enclose nothing, such as at"
        raise NoBodyError(f"{problem} {in_brackets(place)} m", "Make it one solid in a modeller")
    a, b, c = (vertices - vertices.min(axis=0))[faces].transpose(1, 0, 2)
    volume = float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6.0
    if volume <= 1e-9 * float(np.prod(np.ptp(vertices, axis=0))):
        raise NoBodyError("encloses no volume", "A body has a thickness; model it as a solid")
