"""How a hand can hold two pads to each other: a table of its postures, in the frame of the wrist."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices
from ..descriptions.patches import LinePatch, PlanePatch
from ..geometry.patches import patch_point
from .contacts import pad_poses
from .forward import forward
from .hand_posture import DIRECTION, FACING, PASSED, synergy_postures
from .robot import Robot
from .wrist import wrist_pose


class Grips(NamedTuple):
    """Postures of a hand of two pads."""

    synergies: Array
    """rad (m), shape (g, s)."""
    pads: Array
    """Poses of the patch frames in the frame of the wrist, m, shape (g, 2, 4, 4)."""
    points: Array
    """Middles of the pads, m, wrist, shape (g, 2, 3)."""
    normals: Array
    """Outward normals there, wrist, shape (g, 2, 3)."""

    def at(self, indices: Indices) -> Grips:
        """Return some of the grips."""
        return Grips(*(part[indices] for part in self))

    @property
    def widths(self) -> Array:
        """Distance of the second pad's middle along the first one's normal, m, shape (g,)."""
        return np.asarray(((self.points[:, 1] - self.points[:, 0]) * self.normals[:, 0]).sum(axis=1))

    def nearest(self, width: float) -> Indices:
        """Return the grips by how far their pads are from facing each other at a distance, shape (g,)."""
        turned = np.linalg.norm(self.normals.sum(axis=1), axis=1)
        return np.argsort((self.widths - width) ** 2 + (DIRECTION * turned) ** 2, kind="stable")


def grips(robot: Robot, lower: Array, upper: Array) -> Grips:
    """Return postures of the hand in which its two pads face each other; flat ones with little tilt.

    Args:
        robot: with two pads.
        lower: bounds of the synergies, rad (m), shape (s,).
        upper: as well.
    """
    data, posture = robot.model.createData(), 0.5 * (robot.lower + robot.upper)
    middles = robot.parameter_limits.mean(axis=1)
    local = [patch_point(pad.patch, middles[pad.parameters]) for pad in robot.pads]
    places, outward = np.array([at.point for at in local]), np.array([at.normal for at in local])
    tried, poses = [], []
    within = [np.clip(sigma, lower, upper) for sigma, _ in synergy_postures(robot)]
    for sigma in np.unique(within, axis=0):
        posture[robot.arm_size :] = sigma
        configuration = forward(robot, data, posture)
        tried.append(sigma)
        poses.append(np.linalg.solve(wrist_pose(configuration), pad_poses(configuration)))
    pads = np.array(poses).reshape(-1, 2, 4, 4)
    points = (pads[:, :, :3, :3] @ places[:, :, None])[..., 0] + pads[:, :, :3, 3]
    normals = (pads[:, :, :3, :3] @ outward[:, :, None])[..., 0]
    found = Grips(np.array(tried), pads, points, normals)
    flat = all(isinstance(pad.patch, PlanePatch | LinePatch) for pad in robot.pads)
    kept = (normals[:, 0] * normals[:, 1]).sum(axis=1) < (-FACING if flat else 0.0)
    kept &= found.widths > -PASSED  # fingers that have passed each other face away
    return found.at(np.flatnonzero(kept))
