"""A cone of directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array


@dataclass(frozen=True)
class Cone:
    """Directions within `half_angle` (rad) of `axis` (3,), which may be of any length."""

    axis: Array
    half_angle: float

    @property
    def direction(self) -> Array:
        """The axis as a unit vector, shape (3,)."""
        axis = np.asarray(self.axis, dtype=float)
        return np.asarray(axis / np.linalg.norm(axis))
