"""The room around the robot: a box."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np
from pydantic import model_validator

from ..arrays import Array
from ..frozen import FrozenMapping
from .model import Frozen
from .values import Vector3, wrong


class Enclosure(Frozen):
    """The inside of a box-shaped room, m, edges along the world axes; its six walls are half-spaces."""

    min: Vector3
    """Corner of the least coordinates, m, world."""
    max: Vector3
    """Corner of the greatest coordinates, m, world."""

    @model_validator(mode="after")
    def _ordered(self) -> Enclosure:
        for axis, letter in enumerate("xyz"):
            if self.min[axis] >= self.max[axis]:
                raise wrong(f"min {self.min[axis]:g} is not below max {self.max[axis]:g} along {letter}", "min", axis)
        return self

    @cached_property
    def walls(self) -> Mapping[str, tuple[Array, float]]:
        """Name to (inward normal n, shape (3,), and offset d, m): the inside is n . p >= d, world."""
        walls: dict[str, tuple[Array, float]] = {}
        for axis, letter in enumerate("xyz"):
            inward = np.eye(3)[axis]
            walls[f"wall {letter}={self.min[axis]:g}"] = (inward, self.min[axis])
            walls[f"wall {letter}={self.max[axis]:g}"] = (-inward, -self.max[axis])
        return FrozenMapping(walls)
