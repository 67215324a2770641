"""Figures of the joints: limits and mimic relations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from ..descriptions import RobotDescription
from .certificate import Figure
from .kinematics import Joint

Limits = dict[str, tuple[float, float]]


def joint_limits(joints: Iterable[Joint], robot: RobotDescription) -> Limits:
    """Return the limits of the joints that have any: the robot file's replace those of the URDF."""
    limits: Limits = {joint.name: joint.limits for joint in joints if joint.limits is not None}
    limits |= robot.arm.limits
    limits |= {s.joint: s.limits for s in robot.hand.synergies if s.joint is not None and s.limits is not None}
    return limits


def limits_figure(limits: Limits, angles: Mapping[str, float]) -> Figure:
    """Return the least distance of a joint from its limits, rad (m for sliding joints)."""
    margins = {name: min(angles[name] - low, high - angles[name]) for name, (low, high) in limits.items()}
    worst = min(margins, key=margins.__getitem__)
    return Figure("joint limits", float(margins[worst]), -1e-9, "rad", "at least", worst)


def reserve_figure(limits: Limits, arm: Iterable[str], angles: Mapping[str, float], reserve: float) -> Figure | None:
    """Return the least distance of an arm joint from its limits, rad (m for sliding joints); None if none has any."""
    own = {name: limits[name] for name in arm if name in limits}
    return replace(limits_figure(own, angles), name="joint reserve", limit=reserve - 1e-9) if own else None


def mimic_figure(joints: Iterable[Joint], angles: Mapping[str, float]) -> Figure:
    """Return the largest deviation of a joint from what it mimics, rad (m for sliding joints)."""
    errors = {
        joint.name: abs(angles[joint.name] - (joint.multiplier * angles[joint.mimics] + joint.offset))
        for joint in joints
        if joint.mimics is not None
    }
    worst = max(errors, key=errors.__getitem__, default="")
    return Figure("mimic joints", float(errors.get(worst, 0.0)), 1e-9, "rad", "at most", worst)
