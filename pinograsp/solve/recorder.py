"""A grasp problem as a solver sees it, every evaluated point recorded."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..problem import Evaluation, GraspProblem
from .backends import BudgetSpentError, Program


class Recorder:
    """Evaluates each point once and keeps the best: least violation first, then least cost.

    Args:
        problem: evaluated.
        tolerance: scaled violation that counts as none.
        budget: number of points that may be evaluated.
    """

    def __init__(self, problem: GraspProblem, tolerance: float, budget: float = math.inf) -> None:
        self.problem = problem
        self.evaluations = 0
        self.best: Evaluation | None = None
        self.merit = (math.inf, math.inf)
        """Violation above the tolerance, and cost, of the best point."""
        self.tolerance, self._budget = tolerance, budget
        self._last: Evaluation | None = None

    @property
    def feasible(self) -> bool:
        """Whether the best point keeps the constraints to the tolerance."""
        return self.best is not None and self.best.violation <= self.tolerance

    def at(self, x: Array) -> Evaluation:
        """Return the evaluation at x, shape (v,).

        Raises:
            BudgetSpentError: it would be one too many.
        """
        if self._last is None or not np.array_equal(x, self._last.x):
            if self.evaluations >= self._budget:
                raise BudgetSpentError
            self._last = self.problem.evaluate(x.copy())
            self.evaluations += 1
            violation = self._last.violation
            merit = (max(violation - self.tolerance, 0.0), self._last.cost)
            if math.isfinite(violation) and math.isfinite(self._last.cost) and merit < self.merit:
                self.best, self.merit = self._last, merit
        return self._last


def program_from(recorder: Recorder, x: Array) -> Program:
    """Return the recorder's problem in the variables z = x / step_units, to be solved from x, shape (v,).

    Variables that are locked are none of the program's: solvers stumble over bounds without room.
    """
    problem = recorder.problem
    free, unit = problem.free, problem.model.robot.step_units
    basis = problem.equality_basis(recorder.at(x))
    lower, upper = (problem.lower / unit)[free], (problem.upper / unit)[free]
    start = np.clip((x / unit)[free], lower, upper)

    def at(z: Array) -> Evaluation:
        if np.array_equal(z, start):
            return recorder.at(x)  # from which z * unit differs by rounding
        point = problem.lower.copy()
        point[free] = z * unit[free]
        return recorder.at(point)

    def cost(z: Array) -> tuple[float, Array]:
        evaluation = at(z)
        return evaluation.cost, (evaluation.cost_gradient * unit)[free]

    def equalities(z: Array) -> tuple[Array, Array]:
        residual = at(z).equalities
        return basis @ residual.values, (basis @ residual.jacobian * unit)[:, free]

    def inequalities(z: Array) -> tuple[Array, Array]:
        residual = at(z).inequalities
        return residual.values, (residual.jacobian * unit)[:, free]

    return Program(
        start=start,
        lower=lower,
        upper=upper,
        cost=cost,
        equalities=equalities,
        inequalities=inequalities,
        equality_count=len(basis),
        inequality_count=len(problem.rows.inequalities),
    )
