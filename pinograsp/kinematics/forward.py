"""Poses and joint Jacobians of a posture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from ..arrays import Array
from .robot import Robot


@dataclass(frozen=True)
class Configuration:
    """A posture whose kinematics have been computed."""

    robot: Robot
    posture: Array
    """(q_a, sigma), shape (l + s,)."""
    rotations: Array
    """Of every joint frame in the world (index 0: the world itself), shape (njoints, 3, 3)."""
    translations: Array
    """m, shape (njoints, 3)."""
    jacobian: Array
    """World spatial Jacobian columns of all joints (linear at the world's origin, angular), shape (6, nv)."""


def forward(robot: Robot, data: Any, posture: Array) -> Configuration:
    """Compute poses and joint Jacobians.

    Args:
        robot: the mounted robot.
        data: a Pinocchio Data of its model, used as scratch space.
        posture: (q_a, sigma), rad (m), shape (l + s,).
    """
    pin.computeJointJacobians(robot.model, data, robot.joint_positions(posture))
    poses = np.array([M.homogeneous for M in data.oMi.tolist()])  # iterating over oMi itself makes a copy of each
    return Configuration(robot, posture, poses[:, :3, :3], poses[:, :3, 3], data.J.copy())
