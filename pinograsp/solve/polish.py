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
from ..mechanics import residual_gradient
from ..problem import Evaluation, GraspProblem

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
    x, best = near.x, near
    for _ in range(STEPS):
        values, jacobian = _equations(problem, best)
        if np.abs(values).max() <= DONE:
            break
        best = problem.evaluate(_stepped(problem, x, values, jacobian))
        x = best.x
    return best if best.violation <= max(tolerance, near.violation) else near


def _equations(problem: GraspProblem, at: Evaluation) -> tuple[Array, Array]:
    """Return the values of the equations and their Jacobian: the equalities, and balance where the task asks for it."""
    values, jacobian = at.equalities
    model = problem.model
    if not model.task.balance_wrench:
        return values, jacobian
    state = problem.state(at.x)
    weight = 1.0 / (float(np.linalg.norm(model.load.scaled)) or 1.0)
    norm = weight * float(np.linalg.norm(state.statics.residual))
    slope = weight * residual_gradient(state.statics, state.grasp_derivatives, model.contact_models)
    return np.append(values, norm), np.vstack([jacobian, slope])


def _stepped(problem: GraspProblem, x: Array, values: Array, jacobian: Array) -> Array:
    unit = problem.model.robot.step_units
    free = (x > problem.lower) & (x < problem.upper)
    J = jacobian * unit * free
    step = unit * (np.linalg.pinv(J, rcond=RANK) @ -values)
    return np.asarray(np.clip(x + step, problem.lower, problem.upper))
