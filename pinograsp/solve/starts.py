"""Starts from the database: wrist in a bounded region around the object (section 3.5, Algorithm 1)."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..collision.hand_free import hand_free
from ..database.query import Configurations, spread_configurations
from ..database.store import Database
from ..geometry.cone import Cone
from ..kinematics.hand_posture import preshape
from ..problem import TaskModel

RANGE_SLACK = 0.6
"""How far starts may miss the task's cone of approach directions and joint ranges where too few keep them, rad.

Of starts that miss a narrow cone and two ranges by up to 0.3, 0.6, 1.0 rad, 93, 89, 74 % led to a grasp.
"""
WHOLE_TURN = 2.0 * math.pi


def starts_near(database: Database, model: TaskModel, count: int, seed: int) -> Array:
    """Return up to `count` postures (q_a, sigma), shape (found, l + s), spread over the task's region.

    Configurations within the task's cone of approach directions and its joint ranges come first; if they are too few,
    others that miss these by little fill up. Joints are moved by whole turns into their range. The hand holds
    its pads as the desired contacts lie to each other. As in the paper the object itself does not count as an obstacle:
    starts belong to robot and enclosure.
    """
    found = _selection(database, model, count, seed, 0.0)
    q = found.q
    if len(q) < count:
        wider = _selection(database, model, count, seed, RANGE_SLACK)
        q = np.vstack([q, wider.q[~np.isin(wider.samples, found.samples)]])[:count]
    return postures(model, q, held(model))


def held(model: TaskModel) -> Array:
    """Return the synergies that hold the pads as the desired contacts lie to each other, shape (s,).

    They depend on where the object stands only by rounding.
    """
    inward, free = -model.object_surface(model.desired_points)[1], hand_free(model.collisions, model.robot)
    return preshape(model.robot, model.desired_points, inward, free)


def postures(model: TaskModel, q: Array, synergies: Array) -> Array:
    """Return postures (q_a, sigma), shape (n, l + s): joints moved by whole turns into the task's ranges.

    Args:
        model: the task.
        q: arm configurations, rad (m), shape (n, l).
        synergies: of the hand, shape (s,).
    """
    q = q.copy()
    for i in turning(model).values():
        q[:, i] -= WHOLE_TURN * np.round((q[:, i] - 0.5 * (model.lower[i] + model.upper[i])) / WHOLE_TURN)
    return np.column_stack([q, np.tile(synergies, (len(q), 1))])


def turning(model: TaskModel) -> dict[str, int]:
    """Return the index in the posture of every arm joint that has a range and turns (does not slide)."""
    return {
        name: i
        for i, name in enumerate(model.robot.description.arm.joints)
        if name in model.task.joint_ranges and model.robot.urdf.movable[name] != "prismatic"
    }


def _selection(database: Database, model: TaskModel, count: int, seed: int, slack: float) -> Configurations:
    """Return configurations near the object that miss neither cone nor ranges by more than `slack` (rad)."""
    approach = model.approach
    cone = None if approach is None else Cone(approach.axis, min(approach.half_angle + slack, math.pi))
    center, radius, joints = model.load.center_of_mass, model.task.start_radius, _intervals(model, slack)
    return spread_configurations(database, center, radius, count, cone=cone, joints=joints, seed=seed)


def _intervals(model: TaskModel, slack: float) -> dict[str, list[tuple[float, float]]]:
    """Return, by arm joint with a range, what is in the range up to `slack` and whole turns; no slack for sliders."""
    turned = turning(model)
    intervals: dict[str, list[tuple[float, float]]] = {}
    for i, name in enumerate(model.robot.description.arm.joints):
        if name in turned:
            low, high = float(model.lower[i]) - slack, float(model.upper[i]) + slack
            most = math.ceil((model.robot.upper[i] - model.robot.lower[i]) / WHOLE_TURN)
            intervals[name] = [(low + WHOLE_TURN * k, high + WHOLE_TURN * k) for k in range(-most, most + 1)]
        elif name in model.task.joint_ranges:
            intervals[name] = [(float(model.lower[i]), float(model.upper[i]))]
    return intervals
