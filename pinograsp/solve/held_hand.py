"""The arm brought to where its hand holds a pair of points: inverse kinematics from the posture of a start.

The wrist is to be where a trial of the pair had it, and the hand is put as it was there; but it is turned about the
normals of the contacts towards the hand of the start, as far as the pair allows. What the arm may touch is left to the
projection that follows.

Of all turns by an angle t about a unit vector a that one comes nearest to a rotation Q which maximises

    trace(rotation(t)^T Q) = cos t (trace Q - a . Q a) + sin t a . (Q_32 - Q_23, Q_13 - Q_31, Q_21 - Q_12) + a . Q a
"""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..kinematics.forward import forward
from ..kinematics.wrist import wrist_jacobian, wrist_pose
from ..problem import GraspProblem, Hold, Residual
from .projection import least_squares

LENGTH = 0.3
"""Distance of the wrist from where it is to be, m, that counts as much as 1 rad."""
BETWEEN = math.radians(11.25)
"""By how much a hold may turn beyond turns that were looked at, rad."""
WEIGHT = 10.0
"""Of the residual, rad."""
THERE = 1e-3
"""Norm of the residual, rad, below which the arm has come there."""


def brought(problem: GraspProblem, x: Array, hold: Hold) -> Array | None:
    """Return the point with the wrist and the hand of a hold, shape (v,); None if the arm does not come there.

    Args:
        problem: of the start.
        x: the start, shape (v,).
        hold: in the world.
    """
    robot = problem.model.robot
    size, data = robot.arm_size, robot.model.createData()
    x = np.clip(np.concatenate([x[:size], hold.synergies, hold.parameters]), problem.lower, problem.upper)
    hand = x[size : robot.posture_size]

    def miss(q: Array) -> Residual:
        configuration = forward(robot, data, np.concatenate([q, hand]))
        T, jacobian = wrist_pose(configuration), wrist_jacobian(configuration)[:, :size]
        moved, turned = T[:3, 3] - hold.T_wrist[:3, 3], pin.log3(T[:3, :3] @ hold.T_wrist[:3, :3].T)
        scale = WEIGHT * np.repeat([1.0 / LENGTH, 1.0], 3)
        return Residual(scale * np.concatenate([moved, turned]), scale[:, None] * jacobian)

    unit = np.where(problem.free, robot.step_units, 0.0)[:size]
    q = least_squares(miss, x[:size], unit, (problem.lower[:size], problem.upper[:size]))
    if np.linalg.norm(miss(q).values) > WEIGHT * THERE:
        return None
    return np.concatenate([q, x[size:]])


def turned(hold: Hold, T_wrist: Array) -> Hold:
    """Return a hold turned about its axis, as far as it allows, to where the wrist has the least way to turn.

    Args:
        hold: in some frame.
        T_wrist: pose of the wrist in that frame, shape (4, 4).
    """
    origin, along = hold.axis
    Q = T_wrist[:3, :3] @ hold.T_wrist[:3, :3].T
    odd = np.array([Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]])
    best = math.atan2(along @ odd, np.trace(Q) - along @ Q @ along)
    away = (best - hold.turns + math.pi) % math.tau - math.pi
    nearest = int(np.abs(away).argmin())
    turn = hold.turns[nearest] + float(np.clip(away[nearest], -BETWEEN, BETWEEN))
    return hold._replace(T_wrist=turned_about(origin, along, turn) @ hold.T_wrist, turns=hold.turns - turn)


def turned_about(origin: Array, along: Array, turn: float) -> Array:
    """Return the motion, shape (4, 4), that turns by an angle, rad, about a unit vector through a point, m."""
    T = np.eye(4)
    T[:3, :3] = pin.exp3(turn * along)
    T[:3, 3] = origin - T[:3, :3] @ origin
    return T


def between(T_wrist: Array, hold: Hold) -> float:
    """Return by how much the wrist turns from a pose, shape (4, 4), into a hold, rad."""
    return float(np.linalg.norm(pin.log3(T_wrist[:3, :3] @ hold.T_wrist[:3, :3].T)))
