"""Functions of space as interpolating cubic B-splines on a cubic lattice: value, gradient and Hessian are continuous.

With coefficients c at the nodes x_ijk = origin + h (i, j, k) and the cubic B-spline b,

    f(x) = sum_ijk c_ijk b(u_x - i) b(u_y - j) b(u_z - k),        u = (x - origin) / h

where of each sum four terms are not zero. The coefficients are those with which f takes the given values at the nodes
(scipy.ndimage.spline_filter). They are kept in single precision: of distances of a metre, 0.1 micrometre.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import spline_filter

from ..arrays import Array

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
