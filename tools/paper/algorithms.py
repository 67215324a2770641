"""What NLopt's other algorithms make of the problem.

They run over `GraspProblem.evaluate` from the same starts, projected and raw. Algorithms without equality constraints
get each equality as two inequalities with half the tolerance as slack. `pinograsp.solve` knows only the two that stay.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import nlopt
import numpy as np

import pinograsp
from pinograsp.problem import Evaluation, GraspProblem, TaskModel
from pinograsp.solve import LocalSolver, SolverOptions
from pinograsp.solve.projection import Projection

from .attempts import Found, Method, Solve, as_data, attempt_all, attempts_table, by_options, of_data, postures_of
from .cases import Case
from .comparison import KINDS
from .page import Block, Heading, Text
from .runs import Session
from .store import key_of

TOLERANCE = SolverOptions().tolerance
BUDGET = {True: 600, False: 3000}
"""Evaluations a start with and without gradients."""
SECONDS = 20.0
"""Most time of a start: some algorithms spend far more time than their evaluations take."""
DUAL = 1000
"""Steps on the dual problem in one iteration of MMA and CCSAQ; with the usual 100,000 a start may take minutes."""
INNER = 1e-6
"""Relative change of cost at which a solve inside an augmented Lagrangian stops."""


@dataclass(frozen=True)
class Recipe:
    """An algorithm and how it is given the constraints."""

    algorithm: str
    inner: str = ""
    """What an augmented Lagrangian solves its subproblems with."""
    pairs: bool = False
    """Whether equalities become pairs of inequalities."""

    @property
    def name(self) -> str:
        """The recipe in words."""
        return self.algorithm + f" with {self.inner}" * bool(self.inner) + ", equalities as pairs" * self.pairs

    @property
    def budget(self) -> int:
        """Evaluations a start."""
        return BUDGET["LD_" in self.algorithm + self.inner]


RECIPES = (
    Recipe("LD_SLSQP"),
    Recipe("LD_SLSQP", pairs=True),
    Recipe("LD_MMA", pairs=True),
    Recipe("LD_CCSAQ", pairs=True),
    Recipe("AUGLAG", "LD_LBFGS"),
    Recipe("AUGLAG", "LD_TNEWTON_PRECOND_RESTART"),
    Recipe("AUGLAG", "LD_SLSQP"),
    Recipe("AUGLAG_EQ", "LD_SLSQP"),
    Recipe("AUGLAG_EQ", "LD_MMA"),
    Recipe("AUGLAG_EQ", "LD_CCSAQ"),
    Recipe("LN_COBYLA"),
    Recipe("AUGLAG", "LN_BOBYQA"),
    Recipe("AUGLAG", "LN_SBPLX"),
    Recipe("AUGLAG_EQ", "LN_COBYLA"),
    Recipe("GN_ISRES"),
)


def algorithms_section(session: Session, starts: int) -> list[Block]:
    """Run every recipe on a few starts of every case, with the first robot, and return the section."""
    robot = session.robots[0]
    blocks: list[Block] = [
        Heading(2, "Other algorithms of NLopt"),
        Text(
            f"{robot.description.name}, the same {starts} starts, projected and raw; constraints as in the planner "
            f"except where the name says otherwise; at most {BUDGET[True]} evaluations with and {BUDGET[False]} "
            f"without gradients or {SECONDS:g} s, a single try. The best point that was evaluated counts, the start "
            "too. The first row of each kind is the planner as it is. MMA and CCSAQ take no equalities, LBFGS, "
            "TNEWTON, BOBYQA and SBPLX no constraints at all."
        ),
    ]
    for case in session.cases:
        scene = pinograsp.load_scene(case.scene)
        names = [recipe.name for recipe in RECIPES]
        settings = {"recipes": names, "budget": list(BUDGET.values()), "limits": [SECONDS, DUAL, INNER]}
        key = key_of(robot, scene, case.task, starts=starts, seed=session.seed, settings=settings)
        name = f"{robot.description.name}-{case.name}-algorithms"
        data = session.store.data(name, key, partial(_compute, session, case, starts))
        table = {tuple(row["row"]): of_data(row["attempts"]) for row in data}
        blocks += [Heading(3, case.title), attempts_table(table, ("starts", "algorithm"))]
    return blocks


def _compute(session: Session, case: Case, starts: int) -> list[dict[str, Any]]:
    robot, scene = session.robots[0], pinograsp.load_scene(case.scene)
    print(f"{robot.description.name}-{case.name}: algorithms on {starts} starts", flush=True)
    postures = postures_of(robot, scene, case.task, starts, session.seed)
    rows = []
    for kind, projection in KINDS.items():
        methods: dict[str, Method] = {"the planner": partial(by_options, SolverOptions(projection=projection))}
        methods |= {recipe.name: partial(by_recipe, recipe, projection) for recipe in RECIPES}
        for name, method in methods.items():
            note = f"{kind}, {name}"
            found = attempt_all(robot, scene, case.task, postures, method, session.workers, note)
            rows.append({"row": (kind, name), "attempts": as_data(found)})
    return rows


def by_recipe(recipe: Recipe, projection: Projection, model: TaskModel) -> Solve:
    """Return what solves one start after the other with a recipe."""
    # A solve of one evaluation gives the point that the projection leads to.
    projected = LocalSolver(model, SolverOptions(max_evaluations=1, projection=projection))

    def solve(index: int, posture: np.ndarray) -> Found:
        began = time.perf_counter()
        start = projected.solve(index, posture)
        problem = projected.problem(start.assignment)
        evaluated = Evaluated(problem, recipe.budget)
        minimise(evaluated, start.x, recipe)
        best = evaluated.best
        feasible = best is not None and best.violation <= TOLERANCE
        x = start.x if best is None else best.x
        return Found(problem, x, feasible, evaluated.count, time.perf_counter() - began)

    return solve


class Evaluated:
    """The problem in the variables z = x / step_units, as the planner's solver sees it.

    Evaluates each point once, keeps the best (least violation, then least cost), ends where the budget is spent.
    """

    def __init__(self, problem: GraspProblem, budget: int) -> None:
        self.problem, self.budget = problem, budget
        self.unit: np.ndarray = problem.model.robot.step_units
        self.count = 0
        self.best: Evaluation | None = None
        self._last: Evaluation | None = None
        self._key = (math.inf, math.inf)

    def __call__(self, z: np.ndarray) -> Evaluation:
        """Return the evaluation at z, its Jacobians still in x.

        Raises:
            nlopt.ForcedStop: the budget is spent (some algorithms count otherwise, or not at all).
        """
        x = z * self.unit
        if self._last is None or not np.array_equal(x, self._last.x):
            if self.count >= self.budget:
                raise nlopt.ForcedStop
            self.count += 1
            self._last = self.problem.evaluate(x)
            key = (max(self._last.violation - TOLERANCE, 0.0), self._last.cost)
            if math.isfinite(sum(key)) and key < self._key:
                self.best, self._key = self._last, key
        return self._last


def minimise(evaluated: Evaluated, x: np.ndarray, recipe: Recipe) -> None:
    """Run a recipe from x; `evaluated` holds what was found."""
    problem, unit = evaluated.problem, evaluated.unit
    basis = problem.equality_basis(evaluated(x / unit))
    optimizer = nlopt.opt(getattr(nlopt, recipe.algorithm), len(x))
    if recipe.inner:
        inner = nlopt.opt(getattr(nlopt, recipe.inner), len(x))
        inner.set_ftol_rel(INNER)
        inner.set_maxeval(recipe.budget // 4)
        inner.set_param("dual_maxeval", DUAL)
        optimizer.set_local_optimizer(inner)
    lower, upper = problem.lower / unit, problem.upper / unit
    optimizer.set_lower_bounds(lower)
    optimizer.set_upper_bounds(upper)
    optimizer.set_maxeval(recipe.budget)
    optimizer.set_maxtime(SECONDS)
    optimizer.set_param("dual_maxeval", DUAL)
    optimizer.set_ftol_abs(SolverOptions().cost_tolerance)
    optimizer.set_xtol_rel(1e-10)
    optimizer.set_min_objective(_cost(evaluated))
    slack, tight = 0.5 * TOLERANCE, 0.1 * TOLERANCE
    count = problem.inequality_count + 2 * len(basis) * recipe.pairs
    inequalities = _inequalities(evaluated, basis if recipe.pairs else basis[:0], slack)
    optimizer.add_inequality_mconstraint(inequalities, np.full(count, tight))
    if not recipe.pairs:
        optimizer.add_equality_mconstraint(_equalities(evaluated, basis), np.full(len(basis), tight))
    try:
        optimizer.optimize(np.clip(x / unit, lower, upper))
    except (nlopt.ForcedStop, nlopt.RoundoffLimited, nlopt.runtime_error, nlopt.invalid_argument):
        return  # the best point so far is kept


def _cost(evaluated: Evaluated) -> Callable[[np.ndarray, np.ndarray], float]:
    def cost(z: np.ndarray, gradient: np.ndarray) -> float:
        evaluation = evaluated(z)
        if gradient.size:
            gradient[:] = evaluation.cost_gradient * evaluated.unit
        return float(evaluation.cost)

    return cost


def _equalities(evaluated: Evaluated, basis: np.ndarray) -> Callable[[np.ndarray, np.ndarray, np.ndarray], None]:
    def equalities(result: np.ndarray, z: np.ndarray, gradient: np.ndarray) -> None:
        residual = evaluated(z).equalities
        result[:] = basis @ residual.values
        if gradient.size:
            gradient[:] = basis @ residual.jacobian * evaluated.unit

    return equalities


def _inequalities(
    evaluated: Evaluated, basis: np.ndarray, slack: float
) -> Callable[[np.ndarray, np.ndarray, np.ndarray], None]:
    """Return the inequalities, and as pairs the combinations of equalities that are the rows of `basis`."""

    def inequalities(result: np.ndarray, z: np.ndarray, gradient: np.ndarray) -> None:
        evaluation = evaluated(z)
        kept, equal = evaluation.inequalities, evaluation.equalities
        result[:] = np.concatenate([kept.values, basis @ equal.values - slack, -basis @ equal.values - slack])
        if gradient.size:
            rows = np.concatenate([kept.jacobian, basis @ equal.jacobian, -basis @ equal.jacobian])
            gradient[:] = rows * evaluated.unit

    return inequalities
