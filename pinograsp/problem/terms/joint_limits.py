"""How far inside their limits the joints are that several synergies move.

Joints that one variable alone moves are kept there by its bounds.
"""

from __future__ import annotations

import numpy as np

from ..state import State
from .residual import Residual


def joint_limits(state: State) -> Residual:
    """Return the distances from the upper and from the lower limits, rad (m), shape (2 j,); empty without them."""
    robot = state.model.robot
    shared = robot.shared_joints
    if not len(shared):
        return Residual(np.zeros(0), np.zeros((0, len(state.x))))
    q = robot.joint_positions(state.configuration.posture)[shared]
    lower, upper = robot.joint_limits
    jacobian = np.zeros((2 * len(shared), len(state.x)))
    jacobian[:, : robot.posture_size] = np.concatenate([-robot.B[shared], robot.B[shared]])
    return Residual(np.concatenate([upper[shared] - q, q - lower[shared]]), jacobian)
