"""How far inside its cone the approach direction is.

With c the distance of the approach direction z from the cone's axis d, both unit vectors, and a that of the cone's
border from d, the value is

    2 a - sqrt(2 (c^2 + a^2)),        c = |z - d|,        a = 2 sin(angle / 2)

Near the border this is a - c, so rad-like for cones of any width; it grows no faster than sqrt(2) c far outside, and is
smooth on the axis, where the angle between z and d itself has a kink.
"""

from __future__ import annotations

import math

import numpy as np

from ...kinematics.wrist import approach_direction
from ..state import State
from .residual import Residual


def approach(state: State) -> Residual:
    """Return the smooth membership of the approach direction, shape (1,); empty if every direction is fine."""
    cone = state.model.approach
    if cone is None:
        return Residual(np.zeros(0), np.zeros((0, len(state.x))))
    z, d_z = approach_direction(state.configuration)
    border = 2.0 * math.sin(0.5 * cone.angle)
    apart = z - cone.axis
    root = math.sqrt(2.0 * (float(apart @ apart) + border**2))
    jacobian = np.zeros((1, len(state.x)))
    jacobian[0, : d_z.shape[1]] = -2.0 * (apart @ d_z) / root
    return Residual(np.array([2.0 * border - root]), jacobian)


def approach_angle(state: State) -> float:
    """Return the angle of the approach direction from the cone's axis, rad; zero if every direction is fine."""
    cone = state.model.approach
    if cone is None:
        return 0.0
    z, _ = approach_direction(state.configuration)
    return 2.0 * math.asin(min(1.0, 0.5 * float(np.linalg.norm(z - cone.axis))))
