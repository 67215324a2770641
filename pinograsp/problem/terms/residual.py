"""What a term returns."""

from __future__ import annotations

from typing import NamedTuple

from ...arrays import Array


class Residual(NamedTuple):
    """Values and Jacobian of a term."""

    values: Array
    """Shape (m,)."""
    jacobian: Array
    """In x, shape (m, v)."""
