"""The last digits of a grasp: contact and balance as exact as rounding allows.

A solver stops when constraints hold to some micrometres. Then pads and surface are tilted against each other by as
much, and a wrench is balanced by forces along slightly different normals than the ones that are reported. Newton's
method on the equations c(x) = 0 of contact, tangency and balance takes the least step (in the units of the variables)
that meets them, with variables that are at a bound held there:

    x <- x - D (J D)^+ c(x)

Nothing else is asked: the steps are of the size of the solver's tolerance, below the slack that every margin has.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..problem import Evaluation, GraspProblem
from ..problem.constraints.wrench_balance import wrench_balance

STEPS = 4
DONE = 1e-10
"""Scaled residual that is as good as zero."""
RANK = 1e-6
"""Singular value, in parts of the largest, below which equations depend on others."""


def polished(problem: GraspProblem, near: Evaluation, tolerance: float) -> Evaluation:
    """Return the evaluation of a point by a feasible one where the equations hold; the given one if there is none.

    Args:
        problem: of the evaluation.
        near: of a point that keeps the constraints to the tolerance.
        tolerance: scaled violation that counts as none.
    """
    balance, best = wrench_balance(problem.model), near
    for _ in range(STEPS):
        values, jacobian = best.equalities
        if balance is not None:
            unbalanced = balance.unbalanced(problem.state(best.x))
            values, jacobian = np.append(values, unbalanced.values), np.vstack([jacobian, unbalanced.jacobian])
        if np.abs(values).max() <= DONE:
            break
        best = problem.evaluate(_stepped(problem, best.x, values, jacobian))
    return best if best.violation <= max(tolerance, near.violation) else near


def _stepped(problem: GraspProblem, x: Array, values: Array, jacobian: Array) -> Array:
    unit = problem.model.robot.step_units
    free = (x > problem.lower) & (x < problem.upper)
    J = jacobian * unit * free
    step = unit * (np.linalg.pinv(J, rcond=RANK) @ -values)
    return np.asarray(np.clip(x + step, problem.lower, problem.upper))
