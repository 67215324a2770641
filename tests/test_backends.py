"""Solvers behind one interface, and the recorder that judges them."""

from __future__ import annotations

import numpy as np
import pytest

from pinograsp import InputError, SolverOptions
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.solve.backends import BACKENDS, BudgetSpentError, Limits, Program, Stop
from pinograsp.solve.backends.nlopt import NLopt
from pinograsp.solve.local import LocalSolver
from pinograsp.solve.recorder import Recorder, program_from

LIMITS = Limits(evaluations=2000, violation=1e-9, cost_change=1e-12)


class Stay:
    """A backend that looks at the start and goes nowhere."""

    budget = 1

    def solve(self, program: Program, limits: Limits) -> Stop:
        assert limits.evaluations == self.budget
        program.cost(program.start)
        return Stop("converged")


def circle(calls: list[np.ndarray], budget: int = 10_000) -> Program:
    """minimise x + y on the circle x^2 + y^2 = 2 with x >= -0.5: (-0.5, -sqrt(1.75))."""

    def cost(z: np.ndarray) -> tuple[float, np.ndarray]:
        if len(calls) == budget:
            raise BudgetSpentError
        calls.append(z.copy())
        return float(z.sum()), np.ones(2)

    return Program(
        start=np.array([0.5, -0.5]),
        lower=np.full(2, -2.0),
        upper=np.full(2, 2.0),
        cost=cost,
        equalities=lambda z: (np.array([z @ z - 2.0]), 2.0 * z[None]),
        inequalities=lambda z: (np.array([-0.5 - z[0]]), np.array([[-1.0, 0.0]])),
        equality_count=1,
        inequality_count=1,
    )


@pytest.mark.parametrize(
    "backend",
    [
        BACKENDS["LD_SLSQP"],
        BACKENDS["LN_COBYLA"],
        NLopt("AUGLAG", 2000, inner=NLopt("LD_LBFGS", 2000)),
        NLopt("AUGLAG_EQ", 2000, inner=NLopt("LD_MMA", 2000, parameters=(("dual_maxeval", 1000),))),
    ],
)
def test_nlopt_solves_programs(backend: NLopt) -> None:
    calls: list[np.ndarray] = []
    backend.solve(circle(calls), LIMITS)
    # The last point, not the result of the solver: what counts is that it evaluates the optimum.
    np.testing.assert_allclose(calls[-1], [-0.5, -np.sqrt(1.75)], atol=1e-3)


@pytest.mark.parametrize("inner", [None, NLopt("LD_SLSQP", 2000)])
def test_spent_budget_ends_a_solve(inner: NLopt | None) -> None:
    calls: list[np.ndarray] = []
    backend = NLopt("AUGLAG" if inner else "LD_SLSQP", 2000, inner)
    assert backend.solve(circle(calls, budget=3), LIMITS) == Stop("budget spent")
    assert len(calls) == 3


def test_errors_of_a_program_are_told() -> None:
    def fail(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        raise np.linalg.LinAlgError("singular")

    program = circle([])
    broken = Program(**(vars(program) | {"equalities": fail}))
    assert BACKENDS["LD_SLSQP"].solve(broken, LIMITS) == Stop("failed", "singular")


def test_another_backend_is_one_line(toy_task: TaskModel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(BACKENDS, "STAY", Stay())
    solver = LocalSolver(toy_task, SolverOptions(algorithm="STAY", projection="nothing"))
    start = 0.5 * (toy_task.lower + toy_task.upper)
    solution = solver.solve(7, start)
    np.testing.assert_array_equal(solution.x[: len(start)], start)
    assert solution.evaluations <= 2  # at x, and at z * step_units, which may differ in the last digit
    assert solution.outcome == "infeasible"
    assert solution.state is not None
    np.testing.assert_array_equal(solution.state.x, solution.x)


def test_unknown_solver_is_refused() -> None:
    with pytest.raises(InputError, match=r"algorithm: no solver 'LD_SLQP'\. Did you mean LD_SLSQP"):
        SolverOptions(algorithm="LD_SLQP")


def test_recorder_keeps_the_best_and_counts_points_once(toy_task: TaskModel) -> None:
    problem = GraspProblem(toy_task, tuple(range(len(toy_task.desired_points))))
    recorder = Recorder(problem, tolerance=1e-4, budget=4)
    points = problem.lower + np.array([[0.2], [0.5], [0.5], [0.8]]) * (problem.upper - problem.lower)
    merits = [(max(e.violation - 1e-4, 0.0), e.cost) for e in map(recorder.at, points)]
    assert recorder.evaluations == 3
    assert recorder.merit == min(merits)
    assert recorder.best is not None
    np.testing.assert_array_equal(recorder.best.x, points[merits.index(min(merits))])
    recorder.at(points[0])
    with pytest.raises(BudgetSpentError):
        recorder.at(points[1])


def test_program_has_the_gradients_of_its_values(toy_task: TaskModel) -> None:
    problem = GraspProblem(toy_task, tuple(range(len(toy_task.desired_points))))
    program = program_from(Recorder(problem, 1e-4), problem.lower + 0.4 * (problem.upper - problem.lower))
    step = 1e-6
    shifts = step * np.eye(len(program.start))
    for function in (lambda z: (np.array([program.cost(z)[0]]), program.cost(z)[1][None]), program.equalities):
        values, jacobian = function(program.start)
        differences = [function(program.start + h)[0] - function(program.start - h)[0] for h in shifts]
        np.testing.assert_allclose(jacobian, np.array(differences).T / (2.0 * step), rtol=1e-4, atol=1e-5)
        assert jacobian.shape == (len(values), len(program.start))
