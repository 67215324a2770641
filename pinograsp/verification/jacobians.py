"""Geometric Jacobians of the verification's own kinematics, and what they measure: manipulability.

A joint with the unit axis a through the point c moves a point p of a link beyond it with the velocity a x (p - c) and
the angular velocity a if it turns, with a and 0 if it slides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..arrays import Array, cross
from .certificate import Figure
from .kinematics import Kinematics, Poses, Twist


def jacobian(twists: Sequence[Twist], point: Array) -> Array:
    """Return the geometric Jacobian of a world point, shape (6, joints): velocity, m, above angular velocity, rad."""
    axes = np.array([twist.axis for twist in twists]).reshape(-1, 3)
    places = np.array([twist.place for twist in twists]).reshape(-1, 3)
    revolute = np.array([twist.revolute for twist in twists], dtype=bool)[:, None]
    angular = np.where(revolute, axes, 0.0)
    return np.concatenate([np.where(revolute, cross(axes, point - places), axes).T, angular.T])


def rate_of_twist(twists: Sequence[Twist], rates: Mapping[str, Array]) -> Array:
    """Return the twist of a link per unit of each synergy, shape (synergies, 6).

    The velocity, m, of what of the link is at the world's origin, and the angular velocity, rad.

    Args:
        twists: joints between the root and the link.
        rates: change of joints per unit of each synergy; joints that are not named stay.
    """
    moving = [twist for twist in twists if twist.joint in rates]
    J = jacobian(moving, np.zeros(3))
    count = len(next(iter(rates.values()), ()))
    return np.array([rates[twist.joint] for twist in moving]).reshape(-1, count).T @ J.T


def manipulability_figure(kinematics: Kinematics, poses: Poses, arm: Sequence[str], wrist: str) -> Figure:
    """Return Yoshikawa's measure sqrt(det(J J^T)) of the arm at the wrist, to which no limit is set.

    J is the geometric Jacobian with rows in m and in rad, so that the measure of an arm that turns in every joint has
    the unit m^3; with sliding joints it has another one, and the same label. For fewer than six joints it is the
    product of the singular values, sqrt(det(J^T J)).
    """
    twists = [twist for twist in kinematics.twists(wrist, poses) if twist.joint in arm]
    J = jacobian(twists, poses[wrist][:3, 3])
    measure = float(np.linalg.svd(J, compute_uv=False).prod())
    return Figure("manipulability", measure, -math.inf, "m^3", "at least", wrist)
