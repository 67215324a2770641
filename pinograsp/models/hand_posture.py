"""What the hand alone can do: how far it opens, and how far apart to hold the pads before a grasp."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from ..arrays import Array
from .kinematics import ContactKinematics, contact_kinematics, forward
from .robot import RobotModel

GRID = 17
"""Values per synergy that are tried."""


def synergy_postures(robot: RobotModel) -> Iterator[tuple[Array, ContactKinematics]]:
    """Yield synergies sigma over a grid of their limits, with the pads' centres; the arm at mid-range."""
    data = robot.model.createData()
    middle = 0.5 * (robot.lower + robot.upper)
    limits = zip(robot.lower[robot.arm_size :], robot.upper[robot.arm_size :], strict=True)
    centers = robot.parameter_limits.mean(axis=1)
    for sigma in itertools.product(*(np.linspace(low, high, GRID) for low, high in limits)):
        posture = middle.copy()
        posture[robot.arm_size :] = sigma
        yield np.array(sigma), contact_kinematics(forward(robot, data, posture), centers)


def preshape(robot: RobotModel, desired_points: Array) -> Array:
    """Return the synergies that hold the pads as far apart as the desired points, as nearly as they can.

    Args:
        robot: the robot.
        desired_points: m, shape (n, 3).
    """
    wanted = _spread(desired_points)
    return min(
        ((sigma, _spread(pads.points)) for sigma, pads in synergy_postures(robot)),
        key=lambda found: float(np.abs(found[1] - wanted).sum()),
    )[0]


def hand_opening(robot: RobotModel) -> Array:
    """Return the synergies that hold the pads farthest apart, shape (s,)."""
    return max(
        ((sigma, float(_spread(pads.points).sum())) for sigma, pads in synergy_postures(robot)),
        key=lambda found: found[1],
    )[0]


def widest_jaw(robot: RobotModel) -> float | None:
    """Return the greatest distance between two pads that face each other, m; None if no two ever do."""
    widest: float | None = None
    for _, pads in synergy_postures(robot):
        for i, j in itertools.combinations(range(len(pads.points)), 2):
            if pads.normals[i] @ pads.normals[j] < -0.99:
                gap = float((pads.points[j] - pads.points[i]) @ pads.normals[i])
                widest = gap if widest is None else max(widest, gap)
    return widest


def _spread(points: Array) -> Array:
    """Return the distances between all pairs of points, ascending."""
    pairs = itertools.combinations(points, 2)
    return np.sort([float(np.linalg.norm(a - b)) for a, b in pairs])
