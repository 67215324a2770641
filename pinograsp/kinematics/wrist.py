"""The pose of the wrist, and the approach direction, its z axis, with its derivative."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, skew
from .forward import Configuration


def approach_direction(configuration: Configuration) -> tuple[Array, Array]:
    """Return the wrist's z axis in the world, shape (3,), and its derivative in the posture, shape (3, l + s)."""
    robot = configuration.robot
    frame = robot.model.frames[robot.wrist_frame]
    joint = frame.parentJoint
    axis = configuration.rotations[joint] @ frame.placement.rotation[:, 2]
    angular = configuration.jacobian[3:] * robot.supports[joint]
    return axis, -skew(axis) @ angular @ robot.B


def wrist_jacobian(configuration: Configuration) -> Array:
    """Return linear (at the wrist's origin) and angular velocity of the wrist in the posture, world, (6, l + s)."""
    robot = configuration.robot
    joint = robot.model.frames[robot.wrist_frame].parentJoint
    jacobian = configuration.jacobian * robot.supports[joint]
    jacobian[:3] -= skew(wrist_pose(configuration)[:3, 3]) @ jacobian[3:]
    return np.asarray(jacobian @ robot.B)


def wrist_pose(configuration: Configuration) -> Array:
    """Return T_world_wrist, shape (4, 4)."""
    robot = configuration.robot
    frame = robot.model.frames[robot.wrist_frame]
    T = np.eye(4)
    T[:3, :3] = configuration.rotations[frame.parentJoint]
    T[:3, 3] = configuration.translations[frame.parentJoint]
    return np.asarray(T @ frame.placement.homogeneous)
