"""Projection of a start on the contact conditions, collisions ignored.

A few Levenberg-Marquardt steps on contact gap, tangency and distance from the desired points, kept within bounds.
It turns a posture somewhere near the object into one that holds it, from where the full problem is short.
"""

from __future__ import annotations

import itertools

import numpy as np

from ..arrays import Array
from ..problem import GraspProblem, State, TaskModel

MAX_STEPS = 15
DONE = 1e-5
"""Norm of the scaled residual below which the contacts are made: 0.1 micrometre."""


def nearest_assignment(model: TaskModel, start: State) -> tuple[int, ...]:
    """Return which desired point each pad serves: the assignment of least total squared distance."""
    square = ((start.contacts.points[:, None] - model.desired_points[None]) ** 2).sum(axis=2)
    pads = range(len(square))
    return min(itertools.permutations(range(square.shape[1])), key=lambda p: float(square[pads, p].sum()))


def project(problem: GraspProblem, x: Array) -> Array:
    """Return the point that the steps from x lead to, within bounds, shape (v,)."""
    damping = 1e-2
    residual = problem.contact_residual(x)
    square = float(residual.values @ residual.values)
    for _ in range(MAX_STEPS):
        J = residual.jacobian
        normal = J.T @ J
        scale = float(np.trace(normal)) / len(x)
        step = np.linalg.solve(normal + damping * scale * np.eye(len(x)), -J.T @ residual.values)
        trial_x = np.clip(x + step, problem.lower, problem.upper)
        trial = problem.contact_residual(trial_x)
        trial_square = float(trial.values @ trial.values)
        if trial_square < square:
            x, residual, square = trial_x, trial, trial_square
            damping *= 0.2
            if square < DONE**2:
                break
        else:
            damping *= 5.0
    return x
