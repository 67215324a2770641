"""Starts: random postures without collision, wrist in a bounded region around the object (section 3.5).

As in the paper the object itself does not count as an obstacle here: starts belong to robot and enclosure.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..models import forward
from ..models.batch import WristChain
from ..models.robot import RobotModel
from ..problem import TaskModel
from ..problem.hand_posture import preshape

BLOCK = 20_000
DRAWS_PER_START = 4_000
"""Postures drawn per start wanted before giving up."""


def sample_starts(model: TaskModel, count: int, seed: int) -> Array:
    """Return up to `count` postures (q_a, sigma), shape (found, l + s), in the order of the draw.

    Arm joints are uniform over their limits (continuous joints over one turn), the hand is open as wide as
    the desired points are apart. Fewer are found only where the region can hardly be reached.
    """
    rng = np.random.default_rng(seed)
    robot, task = model.robot, model.task
    low, high = _sampling_range(robot, preshape(robot, model.desired_points))
    data = robot.model.createData()
    chain = WristChain(robot)
    found: list[Array] = []
    for _ in range(math.ceil(max(count * DRAWS_PER_START, 10 * BLOCK) / BLOCK)):
        postures = rng.uniform(low, high, (BLOCK, len(low)))
        positions, _ = chain.poses(postures)
        near = np.linalg.norm(positions - model.load.center_of_mass, axis=1) <= task.start_radius
        for posture in postures[near]:
            if model.collisions.clear(forward(robot, data, posture), task.margin.enclosure, task.margin.robot):
                found.append(posture)
                if len(found) == count:
                    return np.array(found)
    return np.array(found).reshape(len(found), len(low))


def _sampling_range(robot: RobotModel, synergies: Array) -> tuple[Array, Array]:
    low, high = robot.lower.copy(), robot.upper.copy()
    for i, name in enumerate(robot.description.arm.joints):
        if robot.urdf.movable[name] == "continuous":
            low[i], high[i] = max(low[i], -math.pi), min(high[i], math.pi)
    low[robot.arm_size :] = high[robot.arm_size :] = synergies
    return low, high
