"""A cone of directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array


@dataclass(frozen=True)
class Cone:
    """Directions within `half_angle` (rad) of `axis` (3,), a unit vector; it may be given in any length."""

    axis: Array
    half_angle: float

    def __post_init__(self) -> None:
        axis = np.asarray(self.axis, dtype=float)
        object.__setattr__(self, "axis", axis / np.linalg.norm(axis))
