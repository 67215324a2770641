"""The arm brought to where its hand holds a pair of points: inverse kinematics from the posture of a start.

The wrist is to be where a trial of the pair had it, and the hand is put as it was there. What the arm may touch is left
to the projection that follows. Of several holds the one is taken that turns the wrist least.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..kinematics.forward import forward
from ..kinematics.wrist import wrist_jacobian, wrist_pose
from ..problem import GraspProblem, Hold, Residual
from .projection import least_squares

LENGTH = 0.3
"""Distance of the wrist from where it is to be, m, that counts as much as 1 rad."""
WEIGHT = 10.0
"""Of the residual, rad."""
THERE = 1e-3
"""Norm of the residual, rad, below which the arm has come there."""


def brought(problem: GraspProblem, x: Array, hold: Hold) -> Array | None:
    """Return the point with the wrist and the hand of a hold, shape (v,); None if the arm does not come there.

    Args:
        problem: of the start.
        x: the start, shape (v,).
        hold: in the world.
    """
    robot = problem.model.robot
    size, data = robot.arm_size, robot.model.createData()
    x = np.clip(np.concatenate([x[:size], hold.synergies, hold.parameters]), problem.lower, problem.upper)
    hand = x[size : robot.posture_size]

    def miss(q: Array) -> Residual:
        configuration = forward(robot, data, np.concatenate([q, hand]))
        T, jacobian = wrist_pose(configuration), wrist_jacobian(configuration)[:, :size]
        moved, turned = T[:3, 3] - hold.T_wrist[:3, 3], pin.log3(T[:3, :3] @ hold.T_wrist[:3, :3].T)
        scale = WEIGHT * np.repeat([1.0 / LENGTH, 1.0], 3)
        return Residual(scale * np.concatenate([moved, turned]), scale[:, None] * jacobian)

    unit = np.where(problem.free, robot.step_units, 0.0)[:size]
    q = least_squares(miss, x[:size], unit, (problem.lower[:size], problem.upper[:size]))
    if np.linalg.norm(miss(q).values) > WEIGHT * THERE:
        return None
    return np.concatenate([q, x[size:]])


def turned(T_wrist: Array, hold: Hold) -> float:
    """Return by how much the wrist turns from a pose, shape (4, 4), into a hold, rad."""
    return float(np.linalg.norm(pin.log3(T_wrist[:3, :3] @ hold.T_wrist[:3, :3].T)))
