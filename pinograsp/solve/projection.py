"""Projection of a start on the constraints, as near to the desired contacts as these allow.

Levenberg-Marquardt descents, kept within bounds, one after the other. The first looks at the contacts alone (gap,
direction of the pads, distance from the desired points) and ignores collisions, which turns a posture somewhere near
the object into one that holds it. The following ones add the violated clearances, which moves the arm through its null
space out of walls and object, and want the desired points less and less, so that where these cannot be reached the
contacts give way and not the walls. The last asks for the constraints alone. From there the full problem is short.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from ..problem import DesiredPoints, GraspProblem, Residual, State, TaskModel
from ..solver_words import Projection

MAX_STEPS = 30
DONE = 1e-5
"""Norm of the scaled residual below which a descent is done: 0.1 micrometre."""
STALLED = 0.05
"""A descent ends after two steps that each lessen the squared residual by less than this part."""
HOPELESS = 10
"""A descent ends after so many trials in a row that have not lessened it by that part, all in all."""
INITIAL_DAMPING = 40.0
LEAST_DAMPING = 1e-9
"""With less, where variables move nothing, a step has no solution in floating-point numbers."""
YIELDING = ((1.0, 0.3), (0.3, 1.0), (0.1, 1.0))
"""Weights of desired points and of clearances in the descents between the first and the last."""


def nearest_assignment(model: TaskModel, start: State, desired: DesiredPoints | None = None) -> tuple[int, ...]:
    """Return which desired point each pad serves: the assignment of least total squared distance.

    Args:
        model: the task.
        start: where the pads are.
        desired: points that are proposed; None: those that the task desires.
    """
    points = model.desired_points if desired is None else desired.points
    square = ((start.contacts.points[:, None] - points[None]) ** 2).sum(axis=2)
    pads = range(len(square))
    return min(itertools.permutations(range(square.shape[1])), key=lambda p: float(square[pads, p].sum()))


def initial_guesses(problem: GraspProblem, x: Array, onto: Projection) -> Iterator[Array]:
    """Yield the points to solve from; each further one is for where a solve from the one before failed.

    The second way takes the clearances in from the start: it leads elsewhere where the contacts alone have drawn the
    arm deep into a wall. The third one does not want the desired points, and holds the contacts in the middle of their
    pads until all else is met: a contact that has slid to a rim, with its footprint or a finger in the way, does not
    come back.
    """
    if onto == "nothing":
        yield x
        return
    held = descend(problem, 1.0, 0.0, x, STALLED)
    if onto == "contacts":
        yield held
        return
    yield _yield_to_clearances(problem, held)
    yield _yield_to_clearances(problem, x)
    yield descend(problem, 0.0, 1.0, descend(problem, 0.0, 1.0, x, 0.0, sliding=False), 0.0)


def _yield_to_clearances(problem: GraspProblem, x: Array) -> Array:
    for targets, clearances in YIELDING:
        x = descend(problem, targets, clearances, x, STALLED)
    return descend(problem, 0.0, 1.0, x, 0.0)


def descend(
    problem: GraspProblem,
    targets: float,
    clearances: float,
    x: Array,
    stalled: float,
    *,
    sliding: bool = True,
    done: float = DONE,
) -> Array:
    """Return where Levenberg-Marquardt steps on `GraspProblem.projection_residual` lead, within bounds, shape (v,).

    Unless they are sliding, contacts stay where they are on their pads.
    """
    unit = np.where(problem.free, problem.model.robot.step_units, 0.0)
    if not sliding:
        unit[problem.model.robot.posture_size :] = 0.0
    bounds = problem.lower, problem.upper
    return least_squares(
        lambda at: problem.projection_residual(at, targets, clearances), x, unit, bounds, stalled=stalled, done=done
    )


def miss(problem: GraspProblem, x: Array) -> float:
    """Return the norm of the scaled residual of the constraints at a point, shape (v,)."""
    return float(np.linalg.norm(problem.projection_residual(x, 0.0, 1.0).values))


def least_squares(
    residual_at: Callable[[Array], Residual],
    x: Array,
    unit: Array,
    bounds: tuple[Array, Array],
    *,
    stalled: float = 0.0,
    done: float = DONE,
) -> Array:
    """Return where Levenberg-Marquardt steps lead, within bounds, shape (v,).

    Args:
        residual_at: returns what is to be small at a point.
        x: where they begin, shape (v,).
        unit: steps of the variables that count alike; of those that stay 0, shape (v,).
        bounds: of x, both of shape (v,).
        stalled: part of the squared residual by which steps lessen it at least.
        done: norm of the residual below which it is small.
    """
    lower, upper = bounds
    damping = INITIAL_DAMPING
    residual = residual_at(x)
    square = float(residual.values @ residual.values)
    slow, reached, since = 0, square, 0
    for _ in range(MAX_STEPS):
        if square < done**2 or slow == 2 or since == HOPELESS:
            break
        since += 1
        trial_x = damped_step(residual.values, residual.jacobian, x, unit, lower, upper, damping)
        trial = residual_at(trial_x)
        trial_square = float(trial.values @ trial.values)
        if trial_square < square:
            slow = slow + 1 if trial_square > (1.0 - stalled) * square else 0
            x, residual, square = trial_x, trial, trial_square
            damping = max(0.2 * damping, LEAST_DAMPING)
            if square < (1.0 - STALLED) * reached:
                reached, since = square, 0
        else:
            damping *= 4.0
    return x


@compiled
def damped_step(
    values: Array, jacobian: Array, x: Array, unit: Array, lower: Array, upper: Array, damping: float
) -> Array:
    """Return where the Levenberg-Marquardt step of the variables leads that do not push against their bound.

    Args:
        values: shape (m,).
        jacobian: of these in x, shape (m, v).
        x: within bounds, shape (v,).
        unit: steps that count alike; 0 of those that stay, shape (v,).
        lower: bound of x, shape (v,).
        upper: likewise.
        damping: added to the diagonal of the squares.
    """
    J = jacobian * unit
    gradient, squares = J.T @ values, J.T @ J
    step, free, again = np.zeros(len(x)), np.empty(len(x), dtype=np.bool_), True
    for i in range(len(x)):
        free[i] = (x[i] < upper[i] or gradient[i] >= 0.0) and (x[i] > lower[i] or gradient[i] <= 0.0)
    while again and free.any():
        which = np.flatnonzero(free)
        step[:] = 0.0
        step[which] = np.linalg.solve(squares[which][:, which] + damping * np.eye(len(which)), -gradient[which])
        again = False
        for k in which:
            if (x[k] >= upper[k] and step[k] > 0.0) or (x[k] <= lower[k] and step[k] < 0.0):
                free[k], again = False, True
    return np.minimum(np.maximum(x + unit * step, lower), upper)
