"""Types of arrays, one definition each, and helpers that several layers share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
"""Indices of arrays."""
Integers = NDArray[np.int64]
"""Integers that are stored or handed to other libraries."""
Mask = NDArray[np.bool_]
Numbers = Sequence[float] | NDArray[np.floating[Any] | np.integer[Any]]
"""A vector as users write it: a tuple, a list or an array."""
Rows = Sequence[Numbers] | NDArray[np.floating[Any] | np.integer[Any]]
"""Vectors or a matrix as users write them."""

if TYPE_CHECKING:
    Taken = TypeVar("Taken", contravariant=True)
    Held = TypeVar("Held", covariant=True)

    class Takes(Generic[Taken, Held]):
        """A field of which the constructor takes more than the field holds: a list, and it holds a tuple.

        For type checkers alone, and for parts of files alone: of a field that is a descriptor they read in `__set__`
        what the constructor takes, but not of one of a frozen dataclass.
        """

        @overload
        def __get__(self, instance: None, owner: type, /) -> Self: ...
        @overload
        def __get__(self, instance: object, owner: type | None = None, /) -> Held: ...
        def __get__(self, instance: object | None, owner: type | None = None, /) -> Self | Held: ...
        def __set__(self, instance: object, value: Taken, /) -> None: ...


def real_array(name: str, numbers: object, *shape: int) -> Array:
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
