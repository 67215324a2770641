"""Integrals over bodies that are filled evenly, for their centre of mass; written apart from `geometry.filled`.

A surface is closed by a fan over each of its openings, from the mean of the border. The tetrahedra between the
triangles of a closed surface and a point have signed volumes, which add up to the integral of the winding number,
whatever the point. Where parts overlap it is more than 1. So what the winding number, or any count of how often a point
is enclosed, has more than "once or not at all" is taken off: its integral is a mean over points of a Halton sequence,
in the part of space where the first of them found it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.stats import qmc

from ..arrays import Array, Integers

POINTS = 50_000
"""Of the sequence; a fifth of them is looked at first."""


class Filled(NamedTuple):
    """Integrals over a body, in its frame."""

    volume: float
    """m^3."""
    moment: Array
    """Integral of the points, m^4, shape (3,)."""

    @property
    def centroid(self) -> Array:
        """Centre of mass, m, shape (3,)."""
        return np.asarray(self.moment / self.volume)

    def less(self, other: Filled) -> Filled:
        """Return the integrals without those of another."""
        return Filled(self.volume - other.volume, self.moment - other.moment)

    def placed(self, T: Array) -> Filled:
        """Return the integrals of the body at a pose, shape (4, 4)."""
        return Filled(self.volume, T[:3, :3] @ self.moment + self.volume * T[:3, 3])


def enclosed(vertices: Array, faces: Integers) -> Filled:
    """Return the integrals of the winding number of a closed surface.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """
    middle = vertices.mean(axis=0)
    a, b, c = (vertices - middle)[faces].transpose(1, 0, 2)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    total = float(volumes.sum())
    return Filled(total, 0.25 * volumes @ (a + b + c) + total * middle)


def closed(vertices: Array, faces: Integers) -> tuple[Array, Integers]:
    """Return vertices and triangles with a fan over each opening.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    one_way = ends[:, 0] < ends[:, 1]
    pairs, edge = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    net = np.bincount(edge.ravel(), weights=np.where(one_way, 1.0, -1.0)).astype(np.int64)
    border = np.repeat(np.where((net > 0)[:, None], pairs, pairs[:, ::-1]), np.abs(net), axis=0)
    if not len(border):
        return vertices, faces
    corners, numbers = np.unique(border, return_inverse=True)
    numbers = numbers.reshape(border.shape)
    links = coo_matrix((np.ones(len(border)), numbers.T), shape=(len(corners), len(corners)))
    count, opening = connected_components(links, directed=False)
    middles = np.array([vertices[corners[opening == number]].mean(axis=0) for number in range(count)])
    fans = np.column_stack([border[:, ::-1], len(vertices) + opening[numbers[:, 0]]])
    return np.concatenate([vertices, middles]), np.concatenate([faces, fans])


def counted_again(count: Callable[[Array], Array], low: Array, high: Array) -> Filled:
    """Return the integrals of what a count of enclosures has more than 1 where it is above a half, and 0 elsewhere.

    Args:
        count: of points, shape (n, 3), shape (n,).
        low: of a box that holds all, shape (3,), m.
        high: likewise.
    """
    spread = qmc.Halton(3, scramble=False).random(POINTS)

    def again(points: Array) -> Array:
        many = count(points)
        return np.asarray(many - (many > 0.5))

    first = low + (high - low) * spread[: POINTS // 5]
    there = first[again(first) != 0.0]
    if not len(there):
        return Filled(0.0, np.zeros(3))
    beside = 3.0 * (high - low) / (POINTS // 5) ** (1.0 / 3.0)
    low, high = np.maximum(low, there.min(axis=0) - beside), np.minimum(high, there.max(axis=0) + beside)
    points = low + (high - low) * spread
    more = again(points) * float(np.prod(high - low)) / POINTS
    return Filled(float(more.sum()), more @ points)
