"""Approach: the approach direction is in the cone that the task asks for.

With c the distance of the approach direction z from the cone's axis d, both unit vectors, and a that of the cone's
border from d, how far inside the direction is reads

    2 a - sqrt(2 (c^2 + a^2)),        c = |z - d|,        a = 2 sin(angle / 2)

Near the border this is a - c, so rad-like for cones of any width; it grows no faster than sqrt(2) c far outside, and is
smooth on the axis, where the angle between z and d itself has a kink.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ...geometry.cone import DirectionCone
from ...kinematics.wrist import approach_direction
from ..constraint import PER_RADIAN, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel


class Approach(Inside):
    """Smooth membership of the approach direction, rad-like.

    Args:
        cone: in the world.
        wrist: name of the wrist's link.
    """

    name = "approach"
    figures: Mapping[str, str] = {"approach": "deg"}
    rows = ("approach",)
    scale = PER_RADIAN
    least = 2e-5
    """How far inside its cone the approach direction must be, rad: the solver's tolerance must not let it out."""

    def __init__(self, cone: DirectionCone, wrist: str) -> None:
        self._axis, self._angle, self._wrist = cone.axis, cone.half_angle, wrist

    def inside(self, state: State) -> Residual:
        z, d_z = approach_direction(state.configuration)
        border = 2.0 * math.sin(0.5 * self._angle)
        apart = z - self._axis
        root = math.sqrt(2.0 * (float(apart @ apart) + border**2))
        jacobian = np.zeros((1, len(state.x)))
        jacobian[0, : d_z.shape[1]] = -2.0 * (apart @ d_z) / root
        return Residual(np.array([2.0 * border - root]), jacobian)

    def angle(self, state: State) -> float:
        """Return the angle of the approach direction from the cone's axis, rad."""
        z, _ = approach_direction(state.configuration)
        return 2.0 * math.asin(min(1.0, 0.5 * float(np.linalg.norm(z - self._axis))))

    def violations(self, state: State) -> list[Violation]:
        beyond = max(0.0, math.degrees(self.angle(state) + self.least - self._angle))
        return [Violation("approach", beyond, "deg", self._wrist, size=beyond)]


def approach(model: TaskModel) -> Approach | None:
    """Return the constraint, or None if every approach direction is fine."""
    return None if model.approach is None else Approach(model.approach, model.robot.description.arm.wrist)
