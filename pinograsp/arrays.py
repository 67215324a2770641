"""Types of arrays, one definition each, and helpers that several layers share."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
"""Indices of arrays."""
Integers = NDArray[np.int64]
"""Integers that are stored or handed to other libraries."""
Mask = NDArray[np.bool_]


def real_array(name: str, numbers: ArrayLike, *shape: int) -> Array:
    """Return finite numbers that were given as the argument of a name, as an array of a shape.

    Raises:
        InputError: they are no numbers, not finite, or of another shape.
    """
    try:
        array = np.asarray(numbers, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"must be numbers of shape {shape}, not {numbers!r}", key=name) from None
    if array.shape != shape:
        raise InputError(f"has shape {array.shape}, not {shape}", key=name)
    if not np.isfinite(array).all():
        raise InputError("holds a number that is not finite", key=name)
    return array


def without_turns(angles: Array) -> Array:
    """Return angles less whole turns, from -pi to below pi, rad."""
    return np.asarray(np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi)


def skew(vectors: Array) -> Array:
    """Return the matrices [r]_x with [r]_x a = r x a, shape (..., 3, 3), for vectors of shape (..., 3)."""
    matrices = np.zeros((*vectors.shape, 3))
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    matrices[..., 0, 1], matrices[..., 0, 2], matrices[..., 1, 2] = -z, y, -x
    matrices[..., 1, 0], matrices[..., 2, 0], matrices[..., 2, 1] = z, -y, x
    return matrices


def cross(first: Array, second: Array) -> Array:
    """Return vector products, shapes (..., 3) as NumPy broadcasts them; for few vectors far quicker than `np.cross`."""
    return first[..., _NEXT] * second[..., _LAST] - first[..., _LAST] * second[..., _NEXT]


_NEXT, _LAST = [1, 2, 0], [2, 0, 1]
