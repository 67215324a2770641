"""A proven lower bound of U for a task."""

from __future__ import annotations

import numpy as np

from ..kinematics.hand_posture import always_parallel
from ..mechanics import least_cost, least_cost_parallel
from ..problem import TaskModel


def least_U(model: TaskModel) -> float:
    """Return a bound that no U of a task can be below: Phi is not negative, and k V* is at least k times its own bound.

    The bound of V* for parallel pads holds where two flat pads are parallel in every posture of the hand, and forces
    must balance the weight; else that of any hand is taken. (`mechanics.bound` has the proofs.)
    """
    force = float(np.linalg.norm(model.load.wrench[:3]))
    if model.task.balance_wrench and always_parallel(model.robot):
        least = least_cost_parallel(force, model.limits)
    else:
        least = least_cost(len(model.robot.pads), model.limits)
    return model.task.force_weight * least
