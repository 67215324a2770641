"""Contact points of the pads and their derivatives.

World spatial Jacobian columns (v_k, omega_k) of joint k give a point r fixed to a link that k moves the
velocity L_k = v_k + omega_k x r. For joints j, k that both move the link, k nearer to the root than j or j itself,

    dL_j/dq_k = omega_k x L_j,    dL_k/dq_j = omega_k x L_j,    d omega_j/dq_k = omega_k x omega_j.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled
from ..geometry.patches import patch_point
from .forward import Configuration
from .pads import PadFrames
from .robot import Robot


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


def contact_kinematics(configuration: Configuration, parameters: Array) -> ContactKinematics:
    """Compute contact points, normals and hand Jacobians of every pad, with derivatives.

    Args:
        configuration: computed kinematics.
        parameters: q_c, contact parameters pad by pad, m or rad, shape (c,).
    """
    robot, pads = configuration.robot, configuration.robot.pad_frames
    local = [patch_point(pad.patch, parameters[pad.parameters]) for pad in robot.pads]
    return ContactKinematics(
        *_contact_kinematics(
            configuration.rotations,
            configuration.translations,
            configuration.jacobian,
            robot.B,
            robot.hand_joints,
            robot.supports,
            pads,
            np.array([at.point for at in local]),
            np.array([at.normal for at in local]),
            np.concatenate([at.d_point.T for at in local]),
            np.concatenate([at.d_normal.T for at in local]),
        )
    )


def pad_poses(configuration: Configuration) -> Array:
    """Return the poses of the pads' patch frames in the world, m, shape (n, 4, 4)."""
    pads = configuration.robot.pad_frames
    R = configuration.rotations[pads.joints]
    T = np.tile(np.eye(4), (len(pads.joints), 1, 1))
    T[:, :3, :3] = R @ pads.rotations
    T[:, :3, 3] = (R @ pads.translations[:, :, None])[:, :, 0] + configuration.translations[pads.joints]
    return T


@compiled
def _contact_kinematics(
    rotations: Array,
    translations: Array,
    jacobian: Array,
    B: Array,
    hand: Indices,
    supports: Array,
    pads: PadFrames,
    local_points: Array,
    local_normals: Array,
    local_d_points: Array,
    local_d_normals: Array,
) -> tuple[Array, Array, Array, Array, Array, Array, Array]:
    """Return the fields of `ContactKinematics` in their order.

    Points and normals on the patches, shape (n, 3), have derivatives in the contact parameters, shape (c, 3).
    """
    n, (nv, size) = len(pads.joints), B.shape
    v = size + len(pads.owners)
    R, points, normals = _placed(rotations, translations, pads, local_points, local_normals)
    d_points, d_normals = np.zeros((n, 3, v)), np.zeros((n, 3, v))
    linear, angular = np.zeros((n, 3, nv)), np.zeros((n, 3, nv))
    jacobians = np.empty((n, 6, len(hand)))
    for i in range(n):
        for k in range(nv):
            if supports[pads.joints[i], k] == 0.0:
                continue
            for x in range(3):
                y, z = (x + 1) % 3, (x + 2) % 3
                omega_y, omega_z = jacobian[3 + y, k], jacobian[3 + z, k]
                angular[i, x, k] = jacobian[3 + x, k]
                linear[i, x, k] = jacobian[x, k] + omega_y * points[i, z] - omega_z * points[i, y]
                d_normal = omega_y * normals[i, z] - omega_z * normals[i, y]
                for variable in range(size):
                    d_points[i, x, variable] += linear[i, x, k] * B[k, variable]
                    d_normals[i, x, variable] += d_normal * B[k, variable]
        for h in range(len(hand)):
            for x in range(3):
                jacobians[i, x, h] = linear[i, x, hand[h]]
                jacobians[i, 3 + x, h] = angular[i, x, hand[h]]
    for c in range(len(pads.owners)):
        i = pads.owners[c]
        for row in range(3):
            for column in range(3):
                d_points[i, row, size + c] += R[i, row, column] * local_d_points[c, column]
                d_normals[i, row, size + c] += R[i, row, column] * local_d_normals[c, column]
    return points, normals, jacobians, d_points, d_normals, linear, angular


@compiled
def _placed(
    rotations: Array, translations: Array, pads: PadFrames, local_points: Array, local_normals: Array
) -> tuple[Array, Array, Array]:
    """Return rotations of the pads, points on them and normals there, world, shapes (n, 3, 3), (n, 3), (n, 3)."""
    n = len(pads.joints)
    R, points, normals = np.zeros((n, 3, 3)), np.empty((n, 3)), np.zeros((n, 3))
    for i in range(n):
        joint = pads.joints[i]
        for row in range(3):
            points[i, row] = translations[joint, row]
            for column in range(3):
                for k in range(3):
                    R[i, row, column] += rotations[joint, row, k] * pads.rotations[i, k, column]
                points[i, row] += rotations[joint, row, column] * pads.translations[i, column]
                points[i, row] += R[i, row, column] * local_points[i, column]
                normals[i, row] += R[i, row, column] * local_normals[i, column]
    return R, points, normals


def jacobian_derivatives(robot: Robot, contacts: ContactKinematics) -> Array:
    """Return the derivatives of the hand Jacobians in x = (posture, q_c), shape (n, 6, h, v)."""
    owners = robot.pad_frames.owners
    return _jacobian_derivatives(
        contacts.linear, contacts.angular, contacts.d_points, robot.B, robot.hand_joints, owners
    )


@compiled
def _jacobian_derivatives(
    linear: Array, angular: Array, d_points: Array, B: Array, hand: Indices, owners: Indices
) -> Array:
    n, (nv, size) = len(linear), B.shape
    result = np.zeros((n, 6, len(hand), size + len(owners)))
    for i in range(n):
        for h in range(len(hand)):
            j = hand[h]
            for x in range(3):
                y, z = (x + 1) % 3, (x + 2) % 3
                for k in range(nv):
                    if k <= j:
                        change = angular[i, y, k] * linear[i, z, j] - angular[i, z, k] * linear[i, y, j]
                        turn = angular[i, y, k] * angular[i, z, j] - angular[i, z, k] * angular[i, y, j]
                    else:
                        change = angular[i, y, j] * linear[i, z, k] - angular[i, z, j] * linear[i, y, k]
                        turn = 0.0
                    for variable in range(size):
                        result[i, x, h, variable] += change * B[k, variable]
                        result[i, 3 + x, h, variable] += turn * B[k, variable]
                for c in range(size, size + len(owners)):
                    if owners[c - size] == i:
                        result[i, x, h, c] = angular[i, y, j] * d_points[i, z, c] - angular[i, z, j] * d_points[i, y, c]
    return result
