"""Points all over a convex solid, few enough to be looked at in every evaluation.

They are taken on the hull of a few of its vertices, beyond which no other one stands out by more than a tolerance. Let
q be a point of that hull, on a facet, an edge or a corner of it. Then one of the points, p, lies on the same facet, the
same edge or the same corner, at most `apart` from q:

- the corners are points,
- edges have points at most twice `apart` from each other,
- facets are in a grid of squares with a diagonal of twice `apart`; nodes of it beyond the rim are moved to the point of
  the facet that is nearest, by which no point of the facet comes farther from them. Small facets are covered by their
  corners: of a set of points no two of which are farther from each other than D, every point of the hull is at most
  D / sqrt(3) from one of them (Jung).

So where o is a point outside, q the point of the hull that is nearest to it and p as above, q - o is perpendicular to
p - q, and |p - o|^2 <= |q - o|^2 + apart^2.
"""

from __future__ import annotations

import math

import numpy as np

from ..array_cache import kept
from ..arrays import Array, Indices
from ..disk import digest
from .hulls import FlatError, Hull

VERSION = 1
"""Of the points that are kept; to be raised with every change of how they are chosen."""
_SAME_PLANE = 1e-5
"""Difference of the normals of facets that count as one, no unit, and of their offsets, m."""


def solid_points(vertices: Array, apart: float, tolerance: float) -> tuple[Array, float]:
    """Return points of a hull of some vertices of a convex solid, and how far it stands out; kept in the cache folder.

    Args:
        vertices: shape (n, 3), m.
        apart: largest way from a point of the hull to the nearest of the points, m (see `hull_points`).
        tolerance: how far the solid may stand out of the hull, m (see `simplified`).

    Raises:
        FlatError: the vertices lie in one plane.
    """

    def made() -> tuple[Array, float]:
        hull, within = simplified(vertices, tolerance)
        return hull_points(hull, apart), within

    key = digest(f"{VERSION} {apart!r} {tolerance!r} ".encode() + np.ascontiguousarray(vertices).tobytes())
    return kept(
        "points",
        key[:32],
        made,
        lambda found: {"points": found[0], "within": found[1]},
        lambda found: (found["points"], float(found["within"])),
    )


def hull_points(hull: Hull, apart: float) -> Array:
    """Return points of which one is at most `apart`, m, from every point of a hull, on the same facet, (n, 3), m."""
    vertices, corners = np.unique(hull.triangles.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = corners.reshape(-1, 3)
    found, rims = [vertices], []
    for facet in _facets(hull):
        own = np.unique(triangles[facet])
        around = _around(vertices[own], hull.normals[facet[0]])
        rims.append(np.stack([own[around], np.roll(own[around], -1)], axis=1))
        rim = vertices[own[around]]
        if _widest(rim) > math.sqrt(3.0) * apart:
            found.append(_in_facet(rim, hull.normals[facet[0]], apart))
    edges = np.unique(np.sort(np.concatenate(rims), axis=1), axis=0)
    return np.unique(np.concatenate([*found, *_on_edges(vertices[edges], apart)]), axis=0)


def simplified(vertices: Array, tolerance: float) -> tuple[Hull, float]:
    """Return a hull of some of the vertices of a convex solid, and how far others stand out of it.

    Args:
        vertices: shape (n, 3), m.
        tolerance: how far others may stand out, m.

    Raises:
        FlatError: the vertices lie in one plane.
    """
    whole = Hull(vertices)
    axes = np.linalg.svd(vertices - vertices.mean(axis=0), full_matrices=False)[2]
    chosen = np.unique([extreme for along in (vertices @ axes.T).T for extreme in (along.argmin(), along.argmax())])
    while True:
        try:
            hull = Hull(vertices[chosen])
        except FlatError:  # of four of its vertices, say
            return whole, 0.0
        beyond = vertices @ hull.normals.T - hull.offsets
        most = float(beyond.max())
        if most <= tolerance:
            return hull, max(most, 0.0)
        farthest = beyond.argmax(axis=0)
        chosen = np.union1d(chosen, farthest[beyond.max(axis=0) > tolerance])


def _facets(hull: Hull) -> list[Indices]:
    """Return which triangles lie in one plane, for every such plane."""
    planes = np.round(np.column_stack([hull.normals, hull.offsets]) / _SAME_PLANE)
    _, groups = np.unique(planes, axis=0, return_inverse=True)
    order = groups.ravel().argsort(kind="stable")
    return np.split(order, np.flatnonzero(np.diff(groups.ravel()[order])) + 1)


def _around(corners: Array, normal: Array) -> Indices:
    """Return the order of the corners of a convex polygon, shape (k, 3), counterclockwise about its normal."""
    away = corners - corners.mean(axis=0)
    first = away[0]
    return np.asarray(np.arctan2(away @ np.cross(normal, first), away @ first).argsort())


def _widest(corners: Array) -> float:
    return float(np.linalg.norm(corners[:, None] - corners[None], axis=2).max())


def _in_facet(rim: Array, normal: Array, apart: float) -> Array:
    """Return the nodes of a grid over a convex polygon, those beyond its rim moved to it, shape (n, 3)."""
    x = rim[1] - rim[0]
    x = x / np.linalg.norm(x)
    plane = np.stack([x, np.cross(normal, x)])
    flat = (rim - rim[0]) @ plane.T
    low, step = flat.min(axis=0), math.sqrt(2.0) * apart
    counts = np.ceil(np.ptp(flat, axis=0) / step).astype(int)
    nodes = low + step * (np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 2) + 0.5)
    return np.asarray(rim[0] + _moved_in(nodes, flat, apart) @ plane)


def _moved_in(nodes: Array, flat: Array, apart: float) -> Array:
    """Return points of a convex polygon, counterclockwise, (k, 2): nodes, (n, 2), and the nearest ones to those beyond.

    Nodes that are farther from it than `apart` cover nothing of it.
    """
    edges = np.roll(flat, -1, axis=0) - flat
    away = nodes[:, None] - flat
    outside = np.any(edges[:, 1] * away[:, :, 0] - edges[:, 0] * away[:, :, 1] > 0.0, axis=1)
    share = np.clip((away * edges).sum(axis=2) / (edges**2).sum(axis=1), 0.0, 1.0)
    on_rim = flat + share[:, :, None] * edges
    distances = np.linalg.norm(nodes[:, None] - on_rim, axis=2)
    nearest = on_rim[np.arange(len(nodes)), distances.argmin(axis=1)]
    kept = np.logical_or(~outside, distances.min(axis=1) <= apart)
    return np.asarray(np.where(outside[:, None], nearest, nodes)[kept])


def _on_edges(ends: Array, apart: float) -> list[Array]:
    """Return points within edges, shape (n, 2, 3), that with their ends are at most twice `apart` from each other."""
    counts = np.ceil(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / (2.0 * apart)).astype(int)
    return [
        first + (second - first) * (np.arange(1, count) / count)[:, None]
        for (first, second), count in zip(ends, counts.tolist(), strict=True)
        if count > 1
    ]
