"""Flat faces of links, each with the largest rectangle in it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..geometry.triangle_mesh import TriangleMesh
from .rectangles import largest_rectangle

FLAT = 1e-4
"""Corners of one face are this near to its plane, m."""
PARALLEL = math.cos(math.radians(2.0))
LEAST_SIDE = 0.005
"""Shorter sides of a rectangle leave nothing to hold with, m."""
MOST_FACES = 24
"""Of a link, the largest ones."""
MOST_SEEDS = 200


@dataclass(frozen=True)
class Facet:
    """A flat face of a link; link frame."""

    link: str
    origin: Array
    """Middle of the rectangle, m, shape (3,)."""
    axes: Array
    """Rotation; columns x along the rectangle's side that leads away from the link's origin, y, outward normal."""
    sides: Array
    """Of the rectangle, along x and y, m, shape (2,)."""
    standing: float
    """How far the link reaches beyond the plane of the face, m."""


def facets_of(link: str, mesh: TriangleMesh) -> list[Facet]:
    """Return the flat faces of a link that hold a rectangle with sides of at least `LEAST_SIDE`."""
    corners, triangles = mesh.corners, mesh.triangles
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(normals, axis=1) / 2
    fit = areas > 1e-12
    triangles, areas, normals = triangles[fit], areas[fit], normals[fit] / (2 * areas[fit, None])
    left = np.ones(len(areas), dtype=bool)
    found: list[Facet] = []
    for seed in _seeds(triangles, normals, areas):
        if not left[seed] or len(found) == MOST_FACES:
            continue
        normal = normals[seed]
        face = left & (normals @ normal > PARALLEL)
        face[face] = np.abs((triangles[face] - triangles[seed, 0]) @ normal).max(axis=1) < FLAT
        left &= ~face
        facet = _facet(link, corners, triangles[face], _tidy(normal)) if areas[face].sum() > LEAST_SIDE**2 else None
        found += [] if facet is None else [facet]
    return found


def _seeds(triangles: Array, normals: Array, areas: Array) -> list[int]:
    """Return the largest triangles of the planes, roughly told apart, that hold the most area."""
    offsets = (triangles[:, 0] * normals).sum(axis=1)
    planes = np.round(np.column_stack([normals / 0.05, offsets / 5e-4])).astype(np.int64)
    _, plane = np.unique(planes, axis=0, return_inverse=True)
    plane = plane.ravel()
    order = np.argsort(-areas)
    _, first = np.unique(plane[order], return_index=True)
    total = np.bincount(plane, weights=areas)
    # The planes of a face may be told apart where there is one, so a part of its area is enough.
    worth = np.flatnonzero(total > LEAST_SIDE**2 / 4)
    return [int(order[first[k]]) for k in worth[np.argsort(-total[worth])][:MOST_SEEDS]]


def _facet(link: str, corners: Array, triangles: Array, normal: Array) -> Facet | None:
    """Return the facet of a flat face, made up of `triangles`, of a link whose triangles have `corners`."""
    height = float((triangles @ normal).max())  # nothing of the face stands out of the patch
    frames = [np.column_stack([x, np.cross(normal, x), normal]) for x in _directions(triangles, normal)]
    extents = [np.ptp((triangles @ axes[:, :2]).reshape(-1, 2), axis=0) for axes in frames]
    # A later direction must fit the face clearly better than those of the link's axes.
    tightest = min(range(len(frames)), key=lambda k: float(np.prod(extents[k])) * (1.0 if k < 2 else 1.02))
    if extents[tightest].min() < LEAST_SIDE:
        return None
    axes, rectangle = frames[tightest], largest_rectangle(triangles @ frames[tightest][:, :2])
    if (rectangle.high - rectangle.low).min() < LEAST_SIDE:
        return None
    origin = axes @ [*(rectangle.low + rectangle.high) / 2, height]
    sides = rectangle.high - rectangle.low
    x = np.abs(origin @ axes[:, :2]).argmax()  # along the finger, away from where it is hinged
    first = axes[:, x] * (1.0 if origin @ axes[:, x] >= 0.0 else -1.0)
    axes = np.column_stack([first, np.cross(normal, first), normal])
    standing = float((corners @ normal).max()) - height
    return Facet(link, origin, axes, sides if x == 0 else sides[::-1], standing)


def _directions(triangles: Array, normal: Array) -> list[Array]:
    """Return directions in the plane along which a rectangle may lie: of the link's axes, and of long edges."""
    edges = (np.roll(triangles, -1, axis=1) - triangles).reshape(-1, 3)
    longest = edges[np.argsort(-(edges**2).sum(axis=1))[:6]]
    found: list[Array] = []
    for direction in (*np.eye(3), *longest):
        flat = direction - (direction @ normal) * normal
        if np.linalg.norm(flat) < 0.5 * np.linalg.norm(direction):
            continue
        x = _tidy(flat / np.linalg.norm(flat))
        x = x - (x @ normal) * normal
        x /= np.linalg.norm(x)
        # Turned by a quarter it is the same.
        if all(1e-3 < abs(x @ y) < 1.0 - 1e-6 for y in found):
            found.append(x)
    return found


def _tidy(direction: Array) -> Array:
    """Return an axis of the link if a unit vector is within a tenth of a milliradian of it."""
    axis = np.round(direction)
    return np.asarray(axis if np.linalg.norm(axis - direction) < 1e-4 else direction)
