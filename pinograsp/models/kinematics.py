"""Poses, contact points and their derivatives.

World spatial Jacobian columns (v_k, omega_k) of joint k give a point r fixed to a link that k moves the
velocity L_k = v_k + omega_k x r. For joints j, k that both move the link, k nearer to the root than j or j itself,

    dL_j/dq_k = omega_k x L_j,    dL_k/dq_j = omega_k x L_j,    d omega_j/dq_k = omega_k x omega_j.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from ..arrays import Array, skew
from .patches import patch_point
from .robot import RobotModel


@dataclass(frozen=True)
class Configuration:
    """A posture whose kinematics have been computed."""

    robot: RobotModel
    posture: Array
    """(q_a, sigma), shape (l + s,)."""
    rotations: Array
    """Of every joint frame in the world (index 0: the world itself), shape (njoints, 3, 3)."""
    translations: Array
    """m, shape (njoints, 3)."""
    jacobian: Array
    """World spatial Jacobian columns of all joints (linear at the world's origin, angular), shape (6, nv)."""


@dataclass(frozen=True)
class ContactKinematics:
    """The contacts of the pads, with derivatives in x = (posture, q_c)."""

    points: Array
    """Contact points in the world, m, shape (n, 3)."""
    normals: Array
    """Outward unit normals of the pads there: into the object, shape (n, 3)."""
    jacobians: Array
    """Twist (linear at the contact point, angular) per hand joint rate, shape (n, 6, h)."""
    d_points: Array
    """Shape (n, 3, v)."""
    d_normals: Array
    """Shape (n, 3, v)."""
    linear: Array
    """Velocity of the contact points per rate of every joint, shape (n, 3, nv)."""
    angular: Array
    """Angular velocity of the pads per rate of every joint, shape (n, 3, nv)."""


def forward(robot: RobotModel, data: Any, posture: Array) -> Configuration:
    """Compute poses and joint Jacobians.

    Args:
        robot: the mounted robot.
        data: a Pinocchio Data of its model, used as scratch space.
        posture: (q_a, sigma), rad (m), shape (l + s,).
    """
    pin.computeJointJacobians(robot.model, data, robot.joint_positions(posture))
    poses = np.array([M.homogeneous for M in data.oMi])
    return Configuration(robot, posture, poses[:, :3, :3], poses[:, :3, 3], data.J.copy())


def contact_kinematics(configuration: Configuration, parameters: Array) -> ContactKinematics:
    """Compute contact points, normals and hand Jacobians of every pad, with derivatives.

    Args:
        configuration: computed kinematics.
        parameters: q_c, contact parameters pad by pad, m or rad, shape (c,).
    """
    robot = configuration.robot
    joints = np.array([pad.joint for pad in robot.pads])
    local = [patch_point(pad.patch, parameters[pad.parameters]) for pad in robot.pads]
    patches = np.matmul(configuration.rotations[joints], np.array([pad.rotation for pad in robot.pads]))
    origins = np.matmul(configuration.rotations[joints], np.array([pad.translation for pad in robot.pads])[:, :, None])
    points = (origins + np.matmul(patches, np.array([at.point for at in local])[:, :, None]))[:, :, 0]
    points += configuration.translations[joints]
    normals = np.matmul(patches, np.array([at.normal for at in local])[:, :, None])[:, :, 0]

    moves = robot.supports[joints][:, None, :]
    angular = configuration.jacobian[3:] * moves
    linear = configuration.jacobian[:3] * moves - np.matmul(skew(points), angular)
    hand, size, total = robot.hand_joints, robot.posture_size, robot.posture_size + len(parameters)
    d_points = np.zeros((len(points), 3, total))
    d_normals = np.zeros((len(points), 3, total))
    d_points[:, :, :size] = linear @ robot.B
    d_normals[:, :, :size] = -np.matmul(skew(normals), angular) @ robot.B
    for i, (pad, at) in enumerate(zip(robot.pads, local, strict=True)):
        own = slice(size + pad.parameters.start, size + pad.parameters.stop)
        d_points[i, :, own] = patches[i] @ at.d_point
        d_normals[i, :, own] = patches[i] @ at.d_normal
    return ContactKinematics(
        points=points,
        normals=normals,
        jacobians=np.concatenate([linear[:, :, hand], angular[:, :, hand]], axis=1),
        d_points=d_points,
        d_normals=d_normals,
        linear=linear,
        angular=angular,
    )


def jacobian_derivatives(robot: RobotModel, contacts: ContactKinematics) -> Array:
    """Return the derivatives of the hand Jacobians in x = (posture, q_c), shape (n, 6, h, v)."""
    linear, angular = contacts.linear, contacts.angular
    n, _, nv = linear.shape
    hand = robot.hand_joints
    size = robot.posture_size
    omega = skew(angular.transpose(0, 2, 1).reshape(-1, 3)).reshape(n, nv, 3, 3)
    velocity = skew(linear.transpose(0, 2, 1).reshape(-1, 3)).reshape(n, nv, 3, 3)
    hand_linear, hand_angular = linear[:, None, :, hand], angular[:, None, :, hand]
    before = (np.arange(nv)[:, None] <= hand[None, :])[None, :, None, :]
    result = np.zeros((n, 6, len(hand), contacts.d_points.shape[2]))
    change = np.where(before, np.matmul(omega, hand_linear), -np.matmul(velocity, hand_angular))
    turn = np.where(before, np.matmul(omega, hand_angular), 0.0)
    both = np.concatenate([change, turn], axis=2)
    result[:, :, :, :size] = (both.reshape(n, nv, -1).transpose(0, 2, 1) @ robot.B).reshape(n, 6, len(hand), size)
    for i, pad in enumerate(robot.pads):
        own = slice(size + pad.parameters.start, size + pad.parameters.stop)
        result[i, :3, :, own] = np.matmul(omega[i, hand], contacts.d_points[i, :, own]).transpose(1, 0, 2)
    return result
