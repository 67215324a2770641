"""Findings about joints: limits, what follows what, what stays still."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator

import numpy as np

from ..descriptions import RobotDescription
from ..descriptions.urdf import RobotUrdf
from ..descriptions.urdf_checks import usable
from ..kinematics.limits import hard_limits, limits_of
from ..kinematics.robot import Robot
from ..words import in_words, number_of
from .findings import Finding

WIDEST = {"revolute": 4 * math.pi, "prismatic": 10.0}
"""Limits farther apart than this, rad (m), are hardly those of a real joint."""
ROUNDED = 1.001
"""As limits are that were written with few digits, such as 6.2832."""


def unusable_limits(description: RobotDescription, urdf: RobotUrdf) -> Iterator[Finding]:
    """Find all joints in use whose limits leave nothing to move in; a robot model refuses the first of them."""
    given = {*description.arm.limits, *(synergy.joint for synergy in description.hand.synergies if synergy.limits)}
    arm = description.arm.joints
    for joint in urdf.tree.findall("joint"):
        name, limit = joint.get("name", ""), joint.find("limit")
        if limit is None or joint.get("type") == "continuous" or name in given:
            continue
        if name in arm or name in description.hand.joints:
            low, high = limits_of(joint)
            if not usable(low, high):
                key = f"arm.limits.{name}" if name in arm else "limits of its synergy"
                yield Finding("wrong", f"joint {name} has no usable limits ({low:g} .. {high:g})", f"Give {key}")


def joint_findings(robot: Robot) -> Iterator[Finding]:
    """Say what moves what, and what does not."""
    yield from _arm(robot)
    yield from _soft(robot)
    yield from _wide(robot)
    yield from _narrowed(robot)
    for column, name in enumerate(robot.posture_names[robot.arm_size :], robot.arm_size):
        moved = [f"{robot.joint_names[row]} {robot.B[row, column]:+g}" for row in np.flatnonzero(robot.B[:, column])]
        yield Finding("ok", f"synergy {name} moves {number_of(len(moved), 'joint')}: {in_words(moved, 8)}")
    still = {robot.joint_names[row] for row in np.flatnonzero(~robot.B.any(axis=1))}
    for name in sorted(still - robot.description.hand.rest.keys() - robot.urdf.mimics.keys()):
        yield Finding(
            "doubtful",
            f"joint {name} is neither arm nor hand joint: it stays at {robot.q_0[robot.joint_names.index(name)]:g}",
            "Add it to arm.joints or hand.synergies, give its angle under hand.rest, or name a link under leave_out",
        )


def _arm(robot: Robot) -> Iterator[Finding]:
    arm, wrist = robot.description.arm, robot.model.frames[robot.wrist_frame].parentJoint
    order = [robot.joint_names.index(name) for name in arm.joints]
    idle = [name for name, row in zip(arm.joints, order, strict=True) if not robot.supports[wrist, row]]
    for name in idle:
        remedy = "Take it out of arm.joints, or name a wrist that it moves"
        yield Finding("doubtful", f"arm joint {name} does not move the wrist, {arm.wrist}", remedy)
    if order != sorted(order):
        yield Finding("doubtful", "arm.joints are not in the order from the base outwards", "Sort them")
    if not idle:
        sliding = sum(robot.urdf.movable[name] == "prismatic" for name in arm.joints)
        some = f", {sliding} of them sliding" if sliding else ""
        yield Finding("ok", f"the wrist, {arm.wrist}, is moved by {number_of(len(order), 'joint')}{some}")


def _soft(robot: Robot) -> Iterator[Finding]:
    """Say which joints are kept within soft limits, and which ones have soft limits that nothing can be made of."""
    used, unused = [], []
    for joint in robot.urdf.composed.tree.findall("joint"):
        if joint.find("safety_controller") is not None and joint.get("type") in WIDEST:
            hard, soft = hard_limits(joint), limits_of(joint)
            used += [f"{joint.get('name')} {soft[0]:g} .. {soft[1]:g}"] if soft != hard else []
            unused += [joint.get("name", "")] if soft == hard and not _holds(joint, hard) else []
    if used:
        yield Finding("ok", f"soft limits of <safety_controller> are kept: {in_words(used)}")
    if unused:
        what = f"soft limits of {in_words(unused)} leave nothing to move in, and are not kept"
        yield Finding("doubtful", what, "Mend them in the URDF, or give limits in the robot file")


def _holds(joint: ET.Element, hard: tuple[float, float]) -> bool:
    """Whether the soft limits of a joint are there and lie around its hard ones."""
    soft = joint.find("safety_controller")
    ends = [None if soft is None else soft.get(key) for key in ("soft_lower_limit", "soft_upper_limit")]
    return all(end is None for end in ends) or (
        float(ends[0] or hard[0]) <= hard[0] and float(ends[1] or hard[1]) >= hard[1]
    )


def _wide(robot: Robot) -> Iterator[Finding]:
    for name, low, high in zip(robot.posture_names, robot.lower, robot.upper, strict=True):
        if high - low > ROUNDED * WIDEST.get(robot.urdf.movable.get(name, ""), math.inf):
            unit, other = ("m", "mm") if robot.urdf.movable.get(name) == "prismatic" else ("rad", "degrees")
            remedy = f"Are they in {other}? Else give narrower ones in the robot file: starts are drawn from all of it"
            yield Finding("doubtful", f"the limits of {name} are {low:g} .. {high:g} {unit}", remedy)


def _narrowed(robot: Robot) -> Iterator[Finding]:
    """Find joints that cannot use their range because one that follows them has a smaller one."""
    lower, upper = robot.joint_limits
    for column, name in enumerate(robot.posture_names):
        if name in robot.joint_names:
            row = robot.joint_names.index(name)
            low, high = float(robot.lower[column]), float(robot.upper[column])
            if low > lower[row] + 1e-6 or high < upper[row] - 1e-6:
                what = (
                    f"joints that follow {name} keep it within {low:g} .. {high:g} of {lower[row]:g} .. {upper[row]:g}"
                )
                yield Finding("doubtful", what, "Check limits and mimic relations of the followers")
