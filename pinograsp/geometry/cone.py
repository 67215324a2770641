"""A cone of directions."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, real_array
from ..errors import InputError, real_number
from ..frozen import Record


@dataclass(frozen=True, eq=False, repr=False)
class DirectionCone(Record):
    """Directions within an angle of an axis.

    Raises:
        InputError: the axis is no vector or has no direction, or the angle is not within 0 .. pi.
    """

    axis: Array
    """Unit vector (length 1), shape (3,), read-only; it may be given in any length."""
    half_angle: float
    """rad."""

    def __post_init__(self) -> None:
        axis = real_array("axis", self.axis, 3)
        length = float(np.linalg.norm(axis))
        if length == 0.0:
            raise InputError("has no direction: its length is 0", key="axis")
        object.__setattr__(self, "axis", axis / length)
        object.__setattr__(self, "half_angle", real_number("half_angle", self.half_angle, 0.0, math.pi, unit="rad"))
        super().__post_init__()
