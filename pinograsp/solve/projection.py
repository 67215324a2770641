"""Projection of a start on the contact conditions.

Levenberg-Marquardt steps, kept within bounds, in two stages: first on contact gap, direction of the pads and
distance from the desired points with collisions ignored, which turns a posture somewhere near the object into
one that holds it; then with the violated clearances as further residuals, which moves the arm through its null
space out of walls and object. From there the full problem is short.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import Literal

import numpy as np

from ..arrays import Array
from ..problem import GraspProblem, State, TaskModel
from ..problem.terms import Residual

Projection = Literal["nothing", "contacts", "contacts and clearance"]
MAX_STEPS = 30
DONE = 1e-5
"""Norm of the scaled residual below which the contacts are made: 0.1 micrometre."""
INITIAL_DAMPING = 10.0
POSTURE_STEP, PARAMETER_STEP = 0.5, 0.01
"""Units of damping: rad for posture variables, m for contact parameters."""


def nearest_assignment(model: TaskModel, start: State) -> tuple[int, ...]:
    """Return which desired point each pad serves: the assignment of least total squared distance."""
    square = ((start.contacts.points[:, None] - model.desired_points[None]) ** 2).sum(axis=2)
    pads = range(len(square))
    return min(itertools.permutations(range(square.shape[1])), key=lambda p: float(square[pads, p].sum()))


def project(problem: GraspProblem, x: Array, onto: Projection) -> Array:
    """Return the point that the stages lead to from x, within bounds, shape (v,)."""
    if onto != "nothing":
        x = _descend(problem, problem.contact_residual, x)
    if onto == "contacts and clearance":
        x = _descend(problem, problem.contact_and_clearance_residual, x)
    return x


def beginnings(problem: GraspProblem, x: Array, onto: Projection) -> Iterator[Array]:
    """Yield the points to solve from; each further one is for where a solve from the one before failed.

    The second way takes the clearances in from the start: it leads elsewhere where the contacts alone have drawn the
    arm deep into a wall.
    """
    yield project(problem, x, onto)
    if onto == "contacts and clearance":
        yield _descend(problem, problem.contact_and_clearance_residual, x)


def _descend(problem: GraspProblem, residual_at: Callable[[Array], Residual], x: Array) -> Array:
    unit = np.full(len(x), PARAMETER_STEP)
    unit[: problem.model.robot.posture_size] = POSTURE_STEP
    damping = INITIAL_DAMPING
    residual = residual_at(x)
    square = float(residual.values @ residual.values)
    for _ in range(MAX_STEPS):
        if square < DONE**2:
            break
        step = _damped_step(residual.jacobian * unit, residual.values, damping, _at_bound(problem, x))
        trial_x = np.clip(x + unit * step, problem.lower, problem.upper)
        trial = residual_at(trial_x)
        trial_square = float(trial.values @ trial.values)
        if trial_square < square:
            x, residual, square = trial_x, trial, trial_square
            damping *= 0.2
        else:
            damping *= 4.0
    return x


def _at_bound(problem: GraspProblem, x: Array) -> Array:
    """Return -1, 0 or 1 for variables at their lower bound, between bounds, at their upper bound."""
    return np.where(x >= problem.upper, 1.0, 0.0) - np.where(x <= problem.lower, 1.0, 0.0)


def _damped_step(J: Array, values: Array, damping: float, at_bound: Array) -> Array:
    """Return the Levenberg-Marquardt step of the variables that do not push against their bound."""
    gradient = J.T @ values
    free = gradient * at_bound >= 0
    step = np.zeros(J.shape[1])
    while free.any():
        F = J[:, free]
        step[:] = 0.0
        step[free] = np.linalg.solve(F.T @ F + damping * np.eye(F.shape[1]), -gradient[free])
        outward = free & (step * at_bound > 0)
        if not outward.any():
            break
        free &= ~outward
    return step
