"""How far the pads can get from the arm's first joint: a bound, from the lengths of the chain stretched out."""

from __future__ import annotations

import itertools

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..geometry.patches import patch_point
from .pads import Pad
from .robot import Robot


def arm_reach(robot: Robot) -> tuple[Array, float]:
    """Return the origin of the first arm joint, world, m, shape (3,), and a bound on the distance of contacts, m."""
    model, data = robot.model, robot.model.createData()
    pin.forwardKinematics(model, data, robot.q_0)
    first = min(model.getJointId(name) for name in robot.description.arm.joints)
    slide = np.abs(robot.B) @ np.maximum(np.abs(robot.lower), np.abs(robot.upper)) + np.abs(robot.q_0)
    longest = 0.0
    for pad in robot.pads:
        joint, length = pad.joint, float(np.linalg.norm(pad.translation)) + _size(pad)
        while joint != 0:
            if robot.urdf.movable[model.names[joint]] == "prismatic":
                length += float(slide[model.joints[joint].idx_v])
            if joint == first:
                break
            length += float(np.linalg.norm(model.jointPlacements[joint].translation))
            joint = model.parents[joint]
        longest = max(longest, length)
    return data.oMi[first].translation.copy(), longest


def _size(pad: Pad) -> float:
    """Return the greatest distance of a pad's corners from the origin of its patch, m."""
    corners = itertools.product(*pad.patch.parameters)
    return max(float(np.linalg.norm(patch_point(pad.patch, np.array(corner)).point)) for corner in corners)
