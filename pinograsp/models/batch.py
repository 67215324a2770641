"""Wrist poses of many postures at once, in NumPy: a chain of constant placements and joint motions."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ..arrays import Array, skew
from .robot import RobotModel


class WristChain:
    """The joints between the world and the wrist."""

    def __init__(self, robot: RobotModel) -> None:
        model, data = robot.model, robot.model.createData()
        frame = model.frames[robot.wrist_frame]
        pin.computeJointJacobians(model, data, pin.neutral(model))
        self._robot = robot
        self._joints: list[tuple[int, Array, Array]] = []
        joint = frame.parentJoint
        while joint:
            column = model.joints[joint].idx_v
            motion = pin.getJointJacobian(model, data, joint, pin.LOCAL).reshape(6, model.nv)[:, column]
            self._joints.insert(0, (column, model.jointPlacements[joint].homogeneous, motion))
            joint = model.parents[joint]
        self._wrist = frame.placement.homogeneous

    def poses(self, postures: Array) -> tuple[Array, Array]:
        """Return wrist positions (N, 3), m, and approach directions (the wrist's z axis), (N, 3), world.

        Args:
            postures: (q_a, sigma) row by row, shape (N, l + s).
        """
        q = postures @ self._robot.B.T + self._robot.q_0
        R = np.broadcast_to(np.eye(3), (len(q), 3, 3))
        p = np.zeros((len(q), 3))
        for column, placement, motion in self._joints:
            p = p + R @ placement[:3, 3]
            R = R @ placement[:3, :3]
            p = p + (R @ motion[:3]) * q[:, column, None]
            if motion[3:].any():
                K = skew(motion[3:])
                s, c = np.sin(q[:, column]), np.cos(q[:, column])
                R = R @ (np.eye(3) + s[:, None, None] * K + (1.0 - c)[:, None, None] * (K @ K))
        return p + R @ self._wrist[:3, 3], R @ self._wrist[:3, 2]
