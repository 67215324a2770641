"""Nodes of a lattice, compiled: their places, which of them may be near the surface, and the farthest of regions."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Indices
from ..compiled import compiled


@compiled
def some_nodes(origin: Array, h: float, counts: tuple[int, int, int], which: Indices) -> Array:
    """Return nodes of a lattice by their number, shape (n, 3), m."""
    places = np.empty((len(which), 3))
    for n in range(len(which)):
        row, k = divmod(which[n], counts[2])
        i, j = divmod(row, counts[1])
        places[n, 0], places[n, 1], places[n, 2] = origin[0] + i * h, origin[1] + j * h, origin[2] + k * h
    return places


@compiled
def nodes_between(known: Array, distances: Array, within: float, h: float) -> Indices:
    """Return the numbers of nodes that may be near the surface, but for every second one along each axis.

    A distance changes by no more than the way: every second node tells which of the others are not near.

    Args:
        known: what the distances of every second node are at least, m, shape (mx, my, mz).
        distances: about those of all nodes; raised to what they are at least; m, shape (nx, ny, nz).
        within: distance of what is near, m.
        h: spacing, m.
    """
    counts = distances.shape
    found, count = np.empty(distances.size, dtype=np.intp), 0
    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                odd = i % 2 + j % 2 + k % 2
                if odd == 0:
                    continue
                away = _most_beside(known, i, j, k) - math.sqrt(odd) * h
                if away >= within:
                    distances[i, j, k] = max(distances[i, j, k], away)
                else:
                    found[count] = (i * counts[1] + j) * counts[2] + k
                    count += 1
    return found[:count].copy()


@compiled
def _most_beside(known: Array, i: int, j: int, k: int) -> float:
    """Return the largest of the distances of every second node that are beside a node."""
    most = -np.inf
    for a in range(i // 2, min((i + 1) // 2 + 1, known.shape[0])):
        for b in range(j // 2, min((j + 1) // 2 + 1, known.shape[1])):
            for c in range(k // 2, min((k + 1) // 2 + 1, known.shape[2])):
                most = max(most, known[a, b, c])
    return most


@compiled
def farthest_nodes(distances: Array, regions: NDArray[np.int32], count: int) -> Indices:
    """Return the node of each region that is farthest from the surface, shape (count, 3).

    Args:
        distances: m, shape (nx, ny, nz).
        regions: number of the region of each node, from 1 on; 0: of none.
        count: number of regions.
    """
    found, most = np.zeros((count, 3), dtype=np.intp), np.full(count, -np.inf)
    for i in range(distances.shape[0]):
        for j in range(distances.shape[1]):
            for k in range(distances.shape[2]):
                region = regions[i, j, k] - 1
                if region >= 0 and distances[i, j, k] > most[region]:
                    most[region] = distances[i, j, k]
                    found[region, 0], found[region, 1], found[region, 2] = i, j, k
    return found
