"""The last digits of a grasp: contact and balance as exact as rounding allows.

A solver stops when constraints hold to some micrometres. Then pads and surface are tilted against each other by as
much, and a wrench is balanced by forces along slightly different normals than the ones that are reported. Newton's
method on the equations c(x) = 0 of contact, tangency and balance takes the least step (in the units of the variables)
that meets them, with variables that are at a bound held there:

    x <- x - D (J D)^+ c(x)

Nothing else is asked: the steps are of the size of the solver's tolerance, below the slack that every margin has.

The distance to an uneven surface is interpolated, and next to sharp edges off by up to 0.1 mm. There the gaps of c(x)
are then replaced by exact ones, with their derivatives as they are: facets differ little from what is interpolated
between them. These steps are longer, so inequalities that would not hold after one are held where they are.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..problem import Evaluation, GraspProblem
from ..problem.constraint import PER_METRE, Residual
from ..problem.constraints.contact_gap import ContactGap
from ..problem.constraints.wrench_balance import wrench_balance

STEPS = 4
DONE = 1e-10
"""Scaled residual that is as good as zero."""
EXACT_STEPS = 12
"""Of the steps with exact gaps: next to edges their derivatives are off, so that an error shrinks by some tenths."""
EXACT = 1e-4
"""Scaled residual that will do where gaps are exact: facets have corners, and a micrometre is less than they matter."""
RANK, EXACT_RANK = 1e-6, 1e-3
"""Singular value, in parts of the largest, below which equations depend on others; in the second case of those with
exact gaps and held inequalities, which may contradict each other."""


def polished(problem: GraspProblem, near: Evaluation, tolerance: float) -> Evaluation:
    """Return the evaluation of a point by a feasible one where the equations hold; the given one if there is none.

    Args:
        problem: of the evaluation.
        near: of a point that keeps the constraints to the tolerance.
        tolerance: scaled violation that counts as none.
    """
    best = near
    for _ in range(STEPS):
        equations = _equations(problem, best)
        if np.abs(equations.values).max() <= DONE:
            break
        best = problem.evaluate(_stepped(problem, best.x, equations))
    best = best if best.violation <= max(tolerance, near.violation) else near
    return _with_exact_gaps(problem, best, tolerance) if problem.model.surface.uneven else best


def _with_exact_gaps(problem: GraspProblem, near: Evaluation, tolerance: float) -> Evaluation:
    """Return the evaluation of a point by a feasible one with less of a gap; the given one if there is none."""
    best, tried = near, near
    least, allowed = _largest_gap(problem, near), max(tolerance, near.violation)
    for _ in range(EXACT_STEPS):
        equations, beyond = _equations(problem, tried, exact=True), tried.inequalities.values
        if np.abs(equations.values).max() <= EXACT:
            break
        held = np.zeros(len(beyond), dtype=bool)
        for _ in range(STEPS):
            values = np.append(equations.values, np.maximum(beyond[held], 0.0))
            jacobian = np.vstack([equations.jacobian, tried.inequalities.jacobian[held]])
            x = _stepped(problem, tried.x, Residual(values, jacobian), EXACT_RANK)
            crossed = beyond + tried.inequalities.jacobian @ (x - tried.x) > allowed
            if not (crossed & ~held).any():
                break
            held |= crossed
        tried = problem.evaluate(x)
        gap, others = _largest_gap(problem, tried), np.delete(tried.equalities.values, _gap_rows(problem))
        worst = max(float(np.abs(others).max(initial=0.0)), float(tried.inequalities.values.max(initial=0.0)))
        if gap < least and worst <= allowed:
            best, least = tried, gap
    return best


def _equations(problem: GraspProblem, at: Evaluation, *, exact: bool = False) -> Residual:
    """Return contact, tangency and balance, scaled; contact from the object's triangles if it is to be exact."""
    balance, state = wrench_balance(problem.model), problem.state(at.x)
    values, jacobian = at.equalities
    if exact:
        values = values.copy()
        values[_gap_rows(problem)] = PER_METRE * problem.model.exact_distances(state.contacts.points)
    if balance is not None:
        unbalanced = balance.unbalanced(state)
        values, jacobian = np.append(values, unbalanced.values), np.vstack([jacobian, unbalanced.jacobian])
    return Residual(values, jacobian)


def _gap_rows(problem: GraspProblem) -> list[int]:
    gaps = ContactGap(problem.model).rows
    return [problem.rows.equalities.index(row) for row in gaps]


def _largest_gap(problem: GraspProblem, at: Evaluation) -> float:
    """Return the exact distance of the contact that is farthest from the surface, m."""
    return float(np.abs(problem.model.exact_distances(problem.state(at.x).contacts.points)).max())


def _stepped(problem: GraspProblem, x: Array, equations: Residual, rank: float = RANK) -> Array:
    unit = problem.model.robot.step_units
    free = (x > problem.lower) & (x < problem.upper)
    J = equations.jacobian * unit * free
    step = unit * (np.linalg.pinv(J, rcond=rank) @ -equations.values)
    return np.asarray(np.clip(x + step, problem.lower, problem.upper))
