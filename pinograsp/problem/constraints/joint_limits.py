"""Joint limits of the joints that several synergies move.

Joints that one variable alone moves are kept in their limits by its bounds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..constraint import PER_RADIAN, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel


class JointLimits(Inside):
    """Distances from the upper and from the lower limits, rad (m)."""

    name = "joint limits"
    figures: Mapping[str, str] = {"joint limits": "deg"}
    scale = PER_RADIAN
    least = 2e-5
    """How far inside its limits a joint must be, rad (m): the solver's tolerance must not let it out."""

    def __init__(self, model: TaskModel) -> None:
        robot = model.robot
        self._robot, self._joints = robot, robot.shared_joints
        self._names = [robot.joint_names[joint] for joint in self._joints]
        self.rows = tuple(f"{side} limit of {name}" for side in ("upper", "lower") for name in self._names)

    def inside(self, state: State) -> Residual:
        robot, joints = self._robot, self._joints
        q = robot.joint_positions(state.configuration.posture)[joints]
        lower, upper = robot.joint_limits
        jacobian = np.zeros((2 * len(joints), len(state.x)))
        jacobian[:, : robot.posture_size] = np.concatenate([-robot.B[joints], robot.B[joints]])
        return Residual(np.concatenate([upper[joints] - q, q - lower[joints]]), jacobian)

    def violations(self, state: State) -> list[Violation]:
        return [self.largest_violation(state, "deg", math.degrees(1.0), [*self._names, *self._names])]


def joint_limits(model: TaskModel) -> JointLimits | None:
    """Return the constraint, or None if no joint is moved by several synergies."""
    return JointLimits(model) if len(model.robot.shared_joints) else None
