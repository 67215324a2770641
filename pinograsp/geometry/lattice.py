"""Functions of space as interpolating cubic B-splines on a cubic lattice: value, gradient and Hessian are continuous.

With coefficients c at the nodes x_ijk = origin + h (i, j, k) and the cubic B-spline b,

    f(x) = sum_ijk c_ijk b(u_x - i) b(u_y - j) b(u_z - k),        u = (x - origin) / h

where of each sum four terms are not zero. The coefficients are those with which f takes the given values at the nodes
(scipy.ndimage.spline_filter). They are kept in single precision: of distances of a metre, 0.1 micrometre.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import spline_filter

from ..arrays import Array
from ..compiled import compiled

RIM = 6
"""Nodes along every border that are left out."""


class Lattice(NamedTuple):
    """Coefficients of a spline."""

    coefficients: NDArray[np.float32]
    """Shape (nx, ny, nz)."""
    origin: Array
    """Of the first node, m, shape (3,)."""
    spacing: float
    """h, m."""


def lattice_of(values: Array, origin: Array, spacing: float) -> Lattice:
    """Return the spline that takes given values at the nodes, without the outermost ones.

    What is assumed beyond a border shows in the slopes there, less by 3.7 times with every node.

    Args:
        values: shape (nx, ny, nz).
        origin: of the first value, m, shape (3,).
        spacing: m.
    """
    coefficients = spline_filter(values, order=3, output=np.float32)[(slice(RIM, -RIM),) * 3]
    return Lattice(np.ascontiguousarray(coefficients), origin + RIM * spacing, spacing)


def nodes(origin: Array, spacing: float, counts: tuple[int, ...]) -> Array:
    """Return the nodes of a lattice, shape (nx * ny * nz, 3), m, in the order of its values."""
    axes = [origin[axis] + spacing * np.arange(counts[axis]) for axis in range(3)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


@compiled
def covers(lattice: Lattice, x: float, y: float, z: float) -> bool:
    """Return whether a point is at least one spacing within the outermost nodes."""
    origin, once, counts = lattice.origin, 1.0 / lattice.spacing, lattice.coefficients.shape
    u, v, w = (x - origin[0]) * once, (y - origin[1]) * once, (z - origin[2]) * once
    return bool(1.0 <= u <= counts[0] - 2 and 1.0 <= v <= counts[1] - 2 and 1.0 <= w <= counts[2] - 2)


@compiled
def distance_beyond(lattice: Lattice, x: float, y: float, z: float) -> float:
    """Return how far a point is from what the lattice covers, m."""
    square = 0.0
    for axis in range(3):
        place = x if axis == 0 else (y if axis == 1 else z)
        low = lattice.origin[axis] + lattice.spacing
        high = lattice.origin[axis] + lattice.spacing * (lattice.coefficients.shape[axis] - 2)
        square += max(low - place, place - high, 0.0) ** 2
    return math.sqrt(square)


@compiled
def _cell(lattice: Lattice, axis: int, place: float) -> tuple[int, float]:
    """Return the first of the four nodes along an axis that count at a place, and its share of the middle step."""
    u = (place - lattice.origin[axis]) / lattice.spacing
    first = min(max(int(u) - 1, 0), lattice.coefficients.shape[axis] - 4)
    return first, u - first - 1.0


@compiled
def _weights(t: float) -> tuple[float, float, float, float]:
    s = 1.0 - t
    cube, other = t * t * t, s * s * s
    return other / 6.0, (4.0 - 6.0 * t * t + 3.0 * cube) / 6.0, (4.0 - 6.0 * s * s + 3.0 * other) / 6.0, cube / 6.0


@compiled
def _slopes(t: float) -> tuple[float, float, float, float]:
    s = 1.0 - t
    return -0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), 0.5 * s * (4.0 - 3.0 * s), 0.5 * t * t


@compiled
def _bends(t: float) -> tuple[float, float, float, float]:
    return 1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t


@compiled
def value_at(lattice: Lattice, x: float, y: float, z: float) -> float:
    """Return the value at a point that the lattice covers."""
    (i, t), (j, u), (k, v) = _cell(lattice, 0, x), _cell(lattice, 1, y), _cell(lattice, 2, z)
    a, b, c = _weights(t), _weights(u), _weights(v)
    total = 0.0
    for p in range(4):
        plane = 0.0
        for q in range(4):
            row = lattice.coefficients[i + p, j + q, k : k + 4]
            plane += b[q] * (c[0] * row[0] + c[1] * row[1] + c[2] * row[2] + c[3] * row[3])
        total += a[p] * plane
    return total


@compiled
def derivatives_at(lattice: Lattice, x: float, y: float, z: float, gradient: Array, hessian: Array) -> float:
    """Return the value at a point that the lattice covers; write gradient (3,) and Hessian (3, 3)."""
    (i, t), (j, u), (k, v) = _cell(lattice, 0, x), _cell(lattice, 1, y), _cell(lattice, 2, z)
    a, da, dda = _weights(t), _slopes(t), _bends(t)
    b, db, ddb = _weights(u), _slopes(u), _bends(u)
    c, dc, ddc = _weights(v), _slopes(v), _bends(v)
    f = fx = fy = fz = fxx = fyy = fzz = fxy = fxz = fyz = 0.0
    for p in range(4):
        g = gy = gz = gyy = gzz = gyz = 0.0
        for q in range(4):
            row = lattice.coefficients[i + p, j + q, k : k + 4]
            r = c[0] * row[0] + c[1] * row[1] + c[2] * row[2] + c[3] * row[3]
            rz = dc[0] * row[0] + dc[1] * row[1] + dc[2] * row[2] + dc[3] * row[3]
            rzz = ddc[0] * row[0] + ddc[1] * row[1] + ddc[2] * row[2] + ddc[3] * row[3]
            g += b[q] * r
            gy += db[q] * r
            gyy += ddb[q] * r
            gz += b[q] * rz
            gyz += db[q] * rz
            gzz += b[q] * rzz
        f += a[p] * g
        fx += da[p] * g
        fxx += dda[p] * g
        fy += a[p] * gy
        fxy += da[p] * gy
        fyy += a[p] * gyy
        fz += a[p] * gz
        fxz += da[p] * gz
        fyz += a[p] * gyz
        fzz += a[p] * gzz
    once, twice = 1.0 / lattice.spacing, 1.0 / (lattice.spacing * lattice.spacing)
    gradient[0], gradient[1], gradient[2] = once * fx, once * fy, once * fz
    hessian[0, 0], hessian[1, 1], hessian[2, 2] = twice * fxx, twice * fyy, twice * fzz
    hessian[0, 1], hessian[0, 2], hessian[1, 2] = twice * fxy, twice * fxz, twice * fyz
    hessian[1, 0], hessian[2, 0], hessian[2, 1] = hessian[0, 1], hessian[0, 2], hessian[1, 2]
    return f
