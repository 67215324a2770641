"""One local solve with NLopt, and what became of it.

NLopt raises RoundoffLimited and loses the point, ends with a success code on NaN, and may report success with
violated constraints; so every evaluated point is recorded, the best one kept, and judged by its own violations.
"""

from __future__ import annotations

import math
import time
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import nlopt
import numpy as np

from ..arrays import Array
from ..problem import Evaluation, GraspProblem, TaskModel
from .projection import Projection, beginnings, nearest_assignment

Algorithm = Literal["LD_SLSQP", "LN_COBYLA"]
Outcome = Literal["converged", "feasible", "infeasible", "budget spent", "failed"]
"""What a start came to. With the constraints kept at the best point: NLopt stopped by itself, or did not. With some
violated there: NLopt stopped by itself, its budget ended, or it raised an error."""
STOPPED_BY_ITSELF = {nlopt.SUCCESS, nlopt.FTOL_REACHED, nlopt.XTOL_REACHED, nlopt.STOPVAL_REACHED}
_BUDGET: dict[Algorithm, int] = {"LD_SLSQP": 200, "LN_COBYLA": 3000}


@dataclass(frozen=True)
class SolverOptions:
    """How each start is solved."""

    algorithm: Algorithm = "LD_SLSQP"
    max_evaluations: int | None = None
    """Budget of evaluations a solve; None: 200 for LD_SLSQP, 3000 for LN_COBYLA. A failed start gets a second one."""
    tolerance: float = 1e-4
    """Scaled violation that counts as feasible: 1 micrometre."""
    cost_tolerance: float = 1e-6
    """Change of the scaled cost at which a solve stops, 0.001 mm^2 in U; also ten times this part of the cost."""
    projection: Projection = "contacts and clearance"
    """What a start is projected on before the solve."""

    @property
    def budget(self) -> int:
        """Evaluations a start."""
        return self.max_evaluations or _BUDGET[self.algorithm]

    def to_json(self) -> dict[str, Any]:
        """Return the options as JSON data, the budget resolved."""
        return {**asdict(self), "max_evaluations": self.budget}


@dataclass(frozen=True)
class Solution:
    """The best point that one start led to."""

    start: int
    outcome: Outcome
    assignment: tuple[int, ...]
    x: Array
    violations: dict[str, tuple[float, str]]
    """By name of constraint: violation (mm, or as `problem.UNITS` says) and where."""
    evaluations: int
    seconds: float
    message: str = ""

    @property
    def feasible(self) -> bool:
        """Whether the constraints hold to the solver's tolerance."""
        return self.outcome in {"converged", "feasible"}

    @property
    def worst(self) -> tuple[str, float, str]:
        """The most violated constraint: name, violation, where."""
        name = max(self.violations, key=lambda key: self.violations[key][0])
        return (name, *self.violations[name])


@dataclass
class _Recorder:
    """Evaluates each point once and keeps the best: least violation first, then least cost."""

    problem: GraspProblem
    tolerance: float
    evaluations: int = 0
    last: Evaluation | None = None
    best: Evaluation | None = None
    _key: tuple[float, float] = field(default=(math.inf, math.inf))

    @property
    def feasible(self) -> bool:
        """Whether the best point keeps the constraints to the tolerance."""
        return self.best is not None and self.best.violation <= self.tolerance

    @property
    def merit(self) -> tuple[float, float]:
        """Violation above the tolerance, and cost, of the best point."""
        return self._key

    def at(self, x: Array) -> Evaluation:
        if self.last is None or not np.array_equal(x, self.last.x):
            self.last = self.problem.evaluate(x.copy())
            self.evaluations += 1
            violation = self.last.violation
            key = (max(violation - self.tolerance, 0.0), self.last.cost)
            if math.isfinite(violation) and math.isfinite(self.last.cost) and key < self._key:
                self.best, self._key = self.last, key
        return self.last


class LocalSolver:
    """Solves a task from one start after another; what one start gives does not depend on the others."""

    def __init__(self, model: TaskModel, options: SolverOptions) -> None:
        self._model = model
        self._options = options
        self._problems: dict[tuple[int, ...], GraspProblem] = {}

    def problem(self, assignment: tuple[int, ...]) -> GraspProblem:
        """Return the problem in which pad i serves desired point assignment[i]."""
        if assignment not in self._problems:
            self._problems[assignment] = GraspProblem(self._model, assignment)
        return self._problems[assignment]

    def solve(self, index: int, start: Array) -> Solution:
        """Solve from one start.

        Args:
            index: number of the start.
            start: posture (q_a, sigma), shape (l + s,).
        """
        began = time.perf_counter()
        problem = self.problem(tuple(range(len(self._model.desired_points))))
        centers = 0.5 * (problem.lower + problem.upper)[self._model.robot.posture_size :]
        x = np.clip(np.concatenate([start, centers]), problem.lower, problem.upper)
        assignment = nearest_assignment(self._model, problem.state(x))
        problem = self.problem(assignment)
        runs = []
        for beginning in beginnings(problem, x, self._options.projection):
            recorder = _Recorder(problem, self._options.tolerance)
            runs.append((recorder, *_run(recorder, beginning, self._options)))
            if recorder.feasible:
                break
        count = sum(recorder.evaluations for recorder, _, _ in runs)
        recorder, code, message = min(runs, key=lambda run: run[0].merit)
        best = recorder.best
        if best is None:
            return Solution(index, "failed", assignment, x, {}, count, time.perf_counter() - began, message)
        violations = problem.violations(problem.state(best.x))
        seconds = time.perf_counter() - began
        outcome = _outcome(code, recorder.feasible)
        return Solution(index, outcome, assignment, best.x, violations, count, seconds, message)


def _outcome(code: int, feasible: bool) -> Outcome:
    stopped_by_itself = code in STOPPED_BY_ITSELF
    if feasible:
        return "converged" if stopped_by_itself else "feasible"
    if code in {nlopt.MAXEVAL_REACHED, nlopt.MAXTIME_REACHED}:
        return "budget spent"
    return "infeasible" if stopped_by_itself or code == nlopt.ROUNDOFF_LIMITED else "failed"


def _run(recorder: _Recorder, x: Array, options: SolverOptions) -> tuple[int, str]:
    """Run NLopt from x on the variables z = x / step_units; the recorder holds the outcome.

    Returns:
        NLopt's code and a message.
    """
    problem = recorder.problem
    unit = problem.model.robot.step_units
    basis = problem.equality_basis(recorder.at(x))
    optimizer = nlopt.opt(getattr(nlopt, options.algorithm), len(x))
    lower, upper = problem.lower / unit, problem.upper / unit
    optimizer.set_lower_bounds(lower)
    optimizer.set_upper_bounds(upper)
    optimizer.set_maxeval(options.budget)
    optimizer.set_ftol_abs(options.cost_tolerance)
    optimizer.set_ftol_rel(10.0 * options.cost_tolerance)
    optimizer.set_xtol_rel(1e-10)

    def cost(z: Array, gradient: Array) -> float:
        evaluation = recorder.at(z * unit)
        if gradient.size:
            gradient[:] = evaluation.cost_gradient * unit
        return evaluation.cost

    def equalities(result: Array, z: Array, gradient: Array) -> None:
        residual = recorder.at(z * unit).equalities
        result[:] = basis @ residual.values
        if gradient.size:
            gradient[:] = basis @ residual.jacobian * unit

    def inequalities(result: Array, z: Array, gradient: Array) -> None:
        residual = recorder.at(z * unit).inequalities
        result[:] = residual.values
        if gradient.size:
            gradient[:] = residual.jacobian * unit

    optimizer.set_min_objective(cost)
    tight = 0.1 * options.tolerance
    optimizer.add_equality_mconstraint(equalities, np.full(len(basis), tight))
    optimizer.add_inequality_mconstraint(inequalities, np.full(problem.inequality_count, tight))
    try:
        optimizer.optimize(np.clip(x / unit, lower, upper))
    except nlopt.RoundoffLimited:
        return int(nlopt.ROUNDOFF_LIMITED), "roundoff limits progress"
    except (nlopt.exception, RuntimeError, ValueError, np.linalg.LinAlgError) as error:
        return int(nlopt.FAILURE), str(error) or type(error).__name__
    return int(optimizer.last_optimize_result()), ""
