"""Starts from the database: wrist in a bounded region around the object (section 3.5, Algorithm 1)."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Indices
from ..collision.hand_free import hand_free
from ..database.query import Configurations, spread_configurations
from ..database.store import Database
from ..geometry.cone import DirectionCone
from ..kinematics.hand_posture import preshape
from ..problem import TaskModel

RANGE_SLACK = 0.6
"""How far starts may miss the task's cone of approach directions and joint ranges where too few keep them, rad.

Of starts that miss a narrow cone and two ranges by up to 0.3, 0.6, 1.0 rad, 93, 89, 74 % led to a grasp.
"""
LOCK_SLACKS = (0.15, 0.3, 0.6, 1.2, 2.4, math.inf)
"""How far starts may be from the values of locked joints before they are set to these, one after the other, in steps of
1 rad or 0.1 m (`Robot.step_units`)."""


def starts_near(database: Database, model: TaskModel, count: int, seed: int) -> Array:
    """Return up to `count` postures (q_a, sigma), rad (m), shape (found, l + s), spread over the task's region.

    Configurations within the task's cone of approach directions and its joint ranges come first; if they are too few,
    others that miss these by little fill up. Joints are moved by whole turns into their range. The hand holds
    its pads as the desired contacts lie to each other. As in the paper the object itself does not count as an obstacle:
    starts belong to robot and enclosure.

    No configuration has a locked joint exactly at its value. Those come first that are within the first of
    `LOCK_SLACKS` of it, then as many as are needed from the further ones; the last takes every configuration of the
    region. Then the joint is set to its value: the wrist moves by as much, and the projection brings it back.
    """
    q, samples = np.empty((0, model.robot.arm_size)), np.empty(0, dtype=np.int64)
    for slack, lock_slack in _slacks(model):
        found = _selection(database, model, count, seed, slack, lock_slack)
        further = ~np.isin(found.samples, samples)
        q, samples = np.vstack([q, found.q[further]])[:count], np.append(samples, found.samples[further])
        if len(q) == count:
            break
    return postures(model, q, held(model))


def held(model: TaskModel) -> Array:
    """Return the synergies that hold the pads as the desired contacts lie to each other, rad (m), shape (s,).

    Those that the task locks, or gives a range, are within it. They depend on where the object stands only by rounding.
    Of a task that desires no contacts the hand is in mid-range.
    """
    own = slice(model.robot.arm_size, None)
    if model.task.desired_contacts is None:
        return 0.5 * (model.lower + model.upper)[own]
    inward, free = -model.object_surface(model.desired_points)[1], hand_free(model.collisions, model.robot)
    return np.clip(preshape(model.robot, model.desired_points, inward, free), model.lower[own], model.upper[own])


def postures(model: TaskModel, q: Array, synergies: Array) -> Array:
    """Return postures (q_a, sigma), shape (n, l + s): joints in the task's ranges by whole turns, locked ones set.

    Args:
        model: the task.
        q: arm configurations, rad (m), shape (n, l).
        synergies: of the hand, shape (s,).
    """
    q = in_turn(model, q)
    fixed = locked(model)
    q[:, fixed] = model.lower[fixed]
    return np.column_stack([q, np.tile(synergies, (len(q), 1))])


def in_turn(model: TaskModel, q: Array) -> Array:
    """Return arm configurations, rad (m), shape (n, l), with joints moved by whole turns to the task's ranges."""
    q = q.copy()
    for i in turning(model).values():
        q[:, i] -= math.tau * np.round((q[:, i] - 0.5 * (model.lower[i] + model.upper[i])) / math.tau)
    return q


def locked(model: TaskModel) -> Indices:
    """Return the indices of the arm joints that the task locks."""
    size = model.robot.arm_size
    return np.flatnonzero(model.lower[:size] == model.upper[:size])


def ranged(model: TaskModel) -> dict[str, int]:
    """Return the index in the posture of every arm joint that the task gives a range or locks."""
    asked = {interval.name for interval in model.task.intervals}
    return {name: i for i, name in enumerate(model.robot.description.arm.joints) if name in asked}


def turning(model: TaskModel) -> dict[str, int]:
    """Return those of `ranged` that turn (do not slide)."""
    return {name: i for name, i in ranged(model).items() if model.robot.urdf.movable[name] != "prismatic"}


def _slacks(model: TaskModel) -> list[tuple[float, float]]:
    """Return what is tried one after the other: slack of cone and ranges, rad, and of locked joints, in steps."""
    if not len(locked(model)):
        return [(0.0, 0.0), (RANGE_SLACK, 0.0)]
    near = [slack for slack in LOCK_SLACKS if slack <= RANGE_SLACK]
    return [*((0.0, slack) for slack in near), *((RANGE_SLACK, slack) for slack in LOCK_SLACKS[len(near) - 1 :])]


def _selection(
    database: Database, model: TaskModel, count: int, seed: int, slack: float, lock_slack: float
) -> Configurations:
    """Return configurations near the object that miss cone and ranges, or locked joints, by no more than the slacks."""
    approach = model.approach
    cone = None if approach is None else DirectionCone(approach.axis, min(approach.half_angle + slack, math.pi))
    joints = _intervals(model, slack, lock_slack)
    center, radius = model.load.center_of_mass, model.task.start_radius
    return spread_configurations(database, center, radius, count, cone=cone, joints=joints, seed=seed)


def _intervals(model: TaskModel, slack: float, lock_slack: float) -> dict[str, list[tuple[float, float]]]:
    """Return, by arm joint with a range, what is in the range up to its slack and whole turns.

    A slider has slack only where it is locked.
    """
    turned, fixed = turning(model), locked(model)
    intervals: dict[str, list[tuple[float, float]]] = {}
    for name, i in ranged(model).items():
        beyond = lock_slack * float(model.robot.step_units[i]) if i in fixed else slack if name in turned else 0.0
        if math.isinf(beyond):
            continue
        low, high = float(model.lower[i]) - beyond, float(model.upper[i]) + beyond
        most = math.ceil((model.robot.upper[i] - model.robot.lower[i]) / math.tau) if name in turned else 0
        intervals[name] = [(low + math.tau * k, high + math.tau * k) for k in range(-most, most + 1)]
    return intervals
