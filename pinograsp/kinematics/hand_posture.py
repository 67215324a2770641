"""Postures of the hand alone: how far it opens, and how to hold the pads before a grasp.

Synergies that move no pad, of fingers that a task does not use, are left where they are nearest to 0.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..descriptions.patches import LinePatch, PlanePatch
from ..geometry.patches import patch_point
from .robot import Robot

GRID = 17
"""Values per synergy that are tried."""
DRAWS = 1000
"""Random postures that are tried of a hand of more than two synergies, for which a grid has too many."""
DIRECTION = 0.02
"""Weight of a pad that points the wrong way, m per rad."""
FACING = 0.99
"""Cosine of the angle up to which flat pads count as facing each other."""
PASSED = 0.001
"""How far pads of a closed hand may have passed each other, m; beyond that they face away."""

Allowed = Callable[[Array], bool]


class Pads(NamedTuple):
    """The middles of all pads, with the arm at mid-range."""

    points: Array
    """World, m, shape (n, 3)."""
    normals: Array
    """Outward, shape (n, 3)."""


def synergy_postures(robot: Robot) -> Iterator[tuple[Array, Pads]]:
    """Yield synergies sigma within the limits, with the pads: on a grid, or at random if there are many synergies."""
    pads_at = _pad_kinematics(robot)
    lower, upper, _ = _ranges(robot)
    if len(lower) <= 2:
        tried = np.array(
            list(itertools.product(*(np.linspace(*ends, GRID) for ends in zip(lower, upper, strict=True))))
        )
    else:
        tried = np.random.default_rng(0).uniform(lower, upper, (DRAWS, len(lower)))
    for sigma in tried:
        if _allowed(robot, sigma):
            yield sigma, pads_at(sigma)


def preshape(robot: Robot, desired_points: Array, inward_normals: Array, free: Allowed | None = None) -> Array:
    """Return the synergies that hold the pads as the desired contacts lie to each other, as nearly as they can.

    Args:
        robot: the robot.
        desired_points: m, shape (n, 3).
        inward_normals: of the object there, shape (n, 3).
        free: whether synergies are fine (see `hand_free`); what is not is passed over.
    """
    return _best(robot, lambda pads: _misfit(pads, desired_points, inward_normals), free)


def hand_opening(robot: Robot) -> Array:
    """Return the synergies that hold the pads farthest apart, shape (s,)."""
    return _best(robot, lambda pads: -float(_distances(pads.points).sum()))


def jaw_range(robot: Robot) -> tuple[float, float] | None:
    """Return the least and the greatest distance of two flat pads that face each other, m; None if no two ever do."""
    gaps = list[float]()
    flat = [i for i, pad in enumerate(robot.pads) if isinstance(pad.patch, PlanePatch | LinePatch)]
    for _, pads in synergy_postures(robot) if len(flat) > 1 else ():
        for i, j in itertools.combinations(flat, 2):
            if pads.normals[i] @ pads.normals[j] < -FACING:
                gap = float((pads.points[j] - pads.points[i]) @ pads.normals[i])
                if gap > -PASSED:
                    gaps.append(gap)
    return (min(gaps), max(gaps)) if gaps else None


def always_parallel(robot: Robot) -> bool:
    """Whether the robot has two flat pads whose normals are opposite in every posture of the hand that is tried."""
    flat = all(isinstance(pad.patch, PlanePatch | LinePatch) for pad in robot.pads)
    return (
        flat
        and len(robot.pads) == 2
        and all(np.linalg.norm(pads.normals.sum(axis=0)) < 1e-6 for _, pads in synergy_postures(robot))
    )


def _best(robot: Robot, loss: Callable[[Pads], float], free: Allowed | None = None) -> Array:
    """Return the synergies of least loss: of `synergy_postures`, and where these are random of lines from the best."""
    ranked = sorted(((loss(pads), *sigma) for sigma, pads in synergy_postures(robot)), key=lambda found: found[0])
    least, *chosen = next((found for found in ranked if free is None or free(np.array(found[1:]))), ranked[0])
    sigma, pads_at = np.array(chosen), _pad_kinematics(robot)
    lower, upper, moving = _ranges(robot)
    for k in 2 * moving if len(sigma) > 2 else ():
        for value in np.linspace(lower[k], upper[k], GRID):
            trial = sigma.copy()
            trial[k] = value
            tried = loss(pads_at(trial)) if _allowed(robot, trial) else np.inf
            if tried < least - 1e-9 and (free is None or free(trial)):
                least, sigma = tried, trial
    return sigma


def _ranges(robot: Robot) -> tuple[Array, Array, list[int]]:
    """Return the limits of the synergies, equal for those that move no pad, and which ones move one."""
    lower, upper = robot.lower[robot.arm_size :].copy(), robot.upper[robot.arm_size :].copy()
    moves = np.array([robot.supports[pad.joint] for pad in robot.pads]) @ np.abs(robot.B[:, robot.arm_size :])
    still = ~moves.any(axis=0)
    lower[still] = upper[still] = np.clip(0.0, lower[still], upper[still])
    return lower, upper, np.flatnonzero(~still).tolist()


def _allowed(robot: Robot, sigma: Array) -> bool:
    """Whether joints that several synergies move are within their limits."""
    shared = robot.shared_joints
    lower, upper = robot.joint_limits
    q = robot.B[shared, robot.arm_size :] @ sigma + robot.q_0[shared]
    return bool((q >= lower[shared]).all() and (q <= upper[shared]).all())


def _pad_kinematics(robot: Robot) -> Callable[[Array], Pads]:
    """Return the function that places the pads, given synergies."""
    data, posture = robot.model.createData(), 0.5 * (robot.lower + robot.upper)
    middles = robot.parameter_limits.mean(axis=1)
    local = [patch_point(pad.patch, middles[pad.parameters]) for pad in robot.pads]

    def pads_at(sigma: Array) -> Pads:
        posture[robot.arm_size :] = sigma
        pin.forwardKinematics(robot.model, data, robot.joint_positions(posture))
        poses = [data.oMi[pad.joint] for pad in robot.pads]
        points, normals = np.empty((2, len(poses), 3))
        for i, (T, pad, at) in enumerate(zip(poses, robot.pads, local, strict=True)):
            points[i] = T.rotation @ (pad.rotation @ at.point + pad.translation) + T.translation
            normals[i] = T.rotation @ (pad.rotation @ at.normal)
        return Pads(points, normals)

    return pads_at


def _distances(points: Array) -> Array:
    """Return the distances between all pairs of points."""
    return np.array([float(np.linalg.norm(a - b)) for a, b in itertools.combinations(points, 2)])


def _misfit(pads: Pads, points: Array, normals: Array) -> float:
    """Return how far the pads are from contacts, moved rigidly to where they fit best (Kabsch), squared, m^2."""
    held = np.concatenate([pads.points - pads.points.mean(axis=0), DIRECTION * pads.normals])
    wanted = np.concatenate([points - points.mean(axis=0), DIRECTION * normals])
    count, least = len(points), np.inf
    for order in itertools.permutations(range(count)):
        there = wanted[[*order, *(count + i for i in order)]]
        U, sizes, Vt = np.linalg.svd(held.T @ there)
        overlap = sizes[0] + sizes[1] + np.sign(np.linalg.det(U) * np.linalg.det(Vt)) * sizes[2]
        least = min(least, float((held**2).sum() + (there**2).sum() - 2.0 * overlap))
    return least
