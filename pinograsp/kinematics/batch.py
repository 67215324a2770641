"""Kinematics of many arm configurations at once, in NumPy, with the hand held still.

Every arm joint carries a rigid group: its link and all that follows up to the next arm joint. A group's frame has
the joint's axis as z, so that a joint turns two columns of its parent's rotation and nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ..arrays import Array
from .robot import Robot

WORLD = -1
"""Group of what no arm joint moves."""


@dataclass(frozen=True)
class GroupFrames:
    """Frames of the groups for N configurations."""

    rotations: Array
    """Shape (l, N, 3, 3)."""
    translations: Array
    """m, shape (l, N, 3)."""

    def place(self, group: int, points: Array) -> Array:
        """Return points (3,) of a group in the world, for every configuration, shape (N, 3)."""
        if group == WORLD:
            return np.broadcast_to(points, self.translations.shape[1:])
        return np.asarray(self.rotations[group] @ points + self.translations[group])


class BatchKinematics:
    """The arm's joints as constant placements and rotations about (or shifts along) z."""

    def __init__(self, robot: Robot, synergies: Array) -> None:
        model, data = robot.model, robot.model.createData()
        posture = np.concatenate([np.zeros(robot.arm_size), synergies])
        pin.computeJointJacobians(model, data, robot.joint_positions(posture))
        arm = [model.getJointId(name) for name in robot.description.arm.joints]
        self.group_of = {0: WORLD}
        """Group of every joint of the model."""
        for joint in range(1, model.njoints):
            self.group_of[joint] = arm.index(joint) if joint in arm else self.group_of[model.parents[joint]]
        self._zero = [np.eye(4)] * len(arm)
        self._steps: list[tuple[int, int, Array, bool]] = []
        for joint in sorted(arm):
            group, parent = self.group_of[joint], self.group_of[model.parents[joint]]
            column = model.joints[joint].idx_v
            motion = pin.getJointJacobian(model, data, joint, pin.LOCAL).reshape(6, model.nv)[:, column]
            revolute = bool(motion[3:].any())
            frame = data.oMi[joint].homogeneous @ _along_z(motion[3:] if revolute else motion[:3])
            self._zero[group] = frame
            base = np.eye(4) if parent == WORLD else self._zero[parent]
            self._steps.append((group, parent, np.linalg.inv(base) @ frame, revolute))
        self._joint_poses = {joint: data.oMi[joint].homogeneous for joint in range(model.njoints)}
        wrist = model.frames[robot.wrist_frame]
        self._wrist_group = self.group_of[wrist.parentJoint]
        self._wrist = self.placement(wrist.parentJoint, wrist.placement.homogeneous)

    def placement(self, joint: int, local: Array) -> Array:
        """Return a pose given in a joint's frame in the frame of the joint's group, shape (4, 4)."""
        group = self.group_of[joint]
        base = np.eye(4) if group == WORLD else self._zero[group]
        return np.asarray(np.linalg.inv(base) @ self._joint_poses[joint] @ local)

    def frames(self, q: Array) -> GroupFrames:
        """Return the frames of all groups for arm configurations q, rad (m), shape (N, l)."""
        count = len(q)
        rotations = np.empty((q.shape[1], count, 3, 3))
        translations = np.empty((q.shape[1], count, 3))
        for group, parent, step, revolute in self._steps:
            if parent == WORLD:
                R = np.broadcast_to(step[:3, :3], (count, 3, 3))
                p = np.broadcast_to(step[:3, 3], (count, 3))
            else:
                R = (rotations[parent].reshape(-1, 3) @ step[:3, :3]).reshape(count, 3, 3)
                p = rotations[parent] @ step[:3, 3] + translations[parent]
            if revolute:
                c, s = np.cos(q[:, group, None]), np.sin(q[:, group, None])
                rotations[group, :, :, 0] = c * R[:, :, 0] + s * R[:, :, 1]
                rotations[group, :, :, 1] = c * R[:, :, 1] - s * R[:, :, 0]
                rotations[group, :, :, 2] = R[:, :, 2]
                translations[group] = p
            else:
                rotations[group] = R
                translations[group] = p + R[:, :, 2] * q[:, group, None]
        return GroupFrames(rotations, translations)

    def wrist(self, frames: GroupFrames) -> tuple[Array, Array]:
        """Return wrist positions, m, and approach directions (the wrist's z axis), world, both (N, 3)."""
        positions = frames.place(self._wrist_group, self._wrist[:3, 3])
        if self._wrist_group == WORLD:
            return positions, np.broadcast_to(self._wrist[:3, 2], positions.shape)
        return positions, np.asarray(frames.rotations[self._wrist_group] @ self._wrist[:3, 2])


def _along_z(axis: Array) -> Array:
    """Return a rotation, as a pose (4, 4), whose z axis is the given unit vector."""
    helper = np.eye(3)[int(np.abs(axis).argmin())]
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(axis, x), axis])
    return pose
