"""Lower bounds of a distance field that cost a look at four numbers, made from its splines when it is read.

A cubic B-spline lies above the least of the coefficients that count, and a linear function g . x is the spline whose
coefficients are its values at the nodes. So around a node n, up to half of what lies between nodes with a bound,

    f(n + x) >= a + g . x        with        a = min over the nodes m that count there of c_m - g . (m - n)

whatever g is; with the slope of the coefficients around n the bound is next to f where the surface is smooth. Distance
and spline differ: what the spline has too much around a node is known, and taken off.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..compiled import compiled
from .lattice import RIM, Lattice

APART = 2
"""Nodes of a lattice from one with a bound to the next."""


class Bounds(NamedTuple):
    """Linear functions that lie below the distance around some nodes of a lattice."""

    values: NDArray[np.float32]
    """a, m, and g, shape (nx, ny, nz, 4)."""
    origin: Array
    """Of the first of these nodes, m, shape (3,)."""
    spacing: float
    """Between them, m."""


def bounds_of(lattice: Lattice, above: NDArray[np.float32], apart: int) -> Bounds:
    """Return bounds within a lattice.

    Args:
        lattice: of a signed distance.
        above: how far the spline may lie above the distance around some nodes of the lattice before its rim was cut
            off, m, shape (mx, my, mz).
        apart: nodes between those.
    """
    h = lattice.spacing
    return Bounds(_linear(lattice.coefficients, h, above, apart, RIM), lattice.origin + 2.0 * h, APART * h)


@compiled
def _linear(
    coefficients: NDArray[np.float32], h: float, above: NDArray[np.float32], apart: int, rim: int
) -> NDArray[np.float32]:
    """Return a and g around every `APART`-th node, from the third one on, shape (nx, ny, nz, 4)."""
    counts = [(count - 5) // APART + 1 for count in coefficients.shape]
    bounds = np.empty((counts[0], counts[1], counts[2], 4), dtype=np.float32)
    for a in range(counts[0]):
        i = 2 + APART * a
        m = (i + rim + apart // 2) // apart
        for b in range(counts[1]):
            j = 2 + APART * b
            n = (j + rim + apart // 2) // apart
            for c in range(counts[2]):
                k = 2 + APART * c
                o = (k + rim + apart // 2) // apart
                x = 0.5 * (coefficients[i + 1, j, k] - coefficients[i - 1, j, k])
                y = 0.5 * (coefficients[i, j + 1, k] - coefficients[i, j - 1, k])
                z = 0.5 * (coefficients[i, j, k + 1] - coefficients[i, j, k - 1])
                least = np.inf
                for p in range(-2, 3):
                    for q in range(-2, 3):
                        for r in range(-2, 3):
                            least = min(least, coefficients[i + p, j + q, k + r] - x * p - y * q - z * r)
                bounds[a, b, c, 0] = least - above[m, n, o]
                bounds[a, b, c, 1], bounds[a, b, c, 2], bounds[a, b, c, 3] = x / h, y / h, z / h
    return bounds
