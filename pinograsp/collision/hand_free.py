"""Whether the hand keeps its links off each other."""

from __future__ import annotations

from functools import cache

import numpy as np

from ..arrays import Array
from ..kinematics.forward import forward
from ..kinematics.hand_posture import Allowed
from ..kinematics.robot import Robot
from .distances import CollisionModel
from .world import CLEARANCES


def hand_free(collisions: CollisionModel, robot: Robot) -> Allowed:
    """Return the function that says whether the hand keeps its links off each other, given synergies."""
    joints, margins = collisions.joints.tolist(), np.array([pair.margin for pair in collisions.pairs])
    moved_by_hand = cache(robot.moved_by_hand)
    in_hand = np.array(
        [
            pair.kind == CLEARANCES["link"] and moved_by_hand(joints[pair.first], joints[pair.second])
            for pair in collisions.pairs
        ]
    )
    data, posture = robot.model.createData(), 0.5 * (robot.lower + robot.upper)

    def free(sigma: Array) -> bool:
        posture[robot.arm_size :] = sigma
        found = collisions.distances(forward(robot, data, posture))
        return not (in_hand[found.indices] & (found.values < margins[found.indices])).any()

    return free
