"""What NLopt's other algorithms make of the problem.

They run behind the interface of `pinograsp.solve.backends` from the same starts, projected and raw. Algorithms without
equality constraints get each equality as two inequalities with half the tolerance as slack. The package registers only
the two that stay.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

import pinograsp
from pinograsp.problem import DesiredPoints, TaskModel
from pinograsp.solve.backends import Limits, Program
from pinograsp.solve.backends.nlopt import INNER_COST_CHANGE, NLopt
from pinograsp.solve.local import LocalSolver, Solution, solution_of
from pinograsp.solve.options import Projection, SolverOptions
from pinograsp.solve.recorder import Recorder, program_from

from .attempts import Method, as_data, attempt_all, attempts_table, by_options, of_data, postures_of
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

    @property
    def backend(self) -> NLopt:
        """What solves."""
        parameters = (("dual_maxeval", DUAL),)
        inner = NLopt(self.inner, self.budget, parameters=parameters) if self.inner else None
        return NLopt(self.algorithm, self.budget, inner, parameters)

    def program(self, program: Program) -> Program:
        """Return a program as the algorithm takes it."""
        return with_pairs(program, 0.5 * TOLERANCE) if self.pairs else program


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
        settings = {"recipes": names, "budget": list(BUDGET.values()), "limits": [SECONDS, DUAL, INNER_COST_CHANGE]}
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
        methods: dict[str, Method] = {"the planner": by_options(SolverOptions(projection=projection))}
        methods |= {recipe.name: partial(RecipeSolver, recipe, projection) for recipe in RECIPES}
        for name, method in methods.items():
            note = f"{kind}, {name}"
            found = attempt_all(robot, scene, case.task, postures, method, session.workers, note)
            rows.append({"row": (kind, name), "attempts": as_data(found)})
    return rows


class RecipeSolver:
    """Solves one start after the other with a recipe, a single try each."""

    def __init__(self, recipe: Recipe, projection: Projection, model: TaskModel) -> None:
        self._recipe = recipe
        # A solve of one evaluation gives the point that the projection leads to.
        self._projected = LocalSolver(model, SolverOptions(max_evaluations=1, projection=projection))
        self._limits = Limits(
            evaluations=recipe.budget,
            violation=0.1 * TOLERANCE,
            cost_change=SolverOptions().cost_tolerance,
            seconds=SECONDS,
        )

    def solve(self, index: int, start: np.ndarray, proposed: Sequence[DesiredPoints] = ()) -> Solution:
        """Return where a start leads; some algorithms count evaluations otherwise or not at all, the recorder does."""
        began = time.perf_counter()
        projected = self._projected.solve(index, start, proposed)
        recorder = Recorder(self._projected.problem(projected.assignment), TOLERANCE, self._recipe.budget)
        program = self._recipe.program(program_from(recorder, projected.x))
        stop = self._recipe.backend.solve(program, self._limits)
        return solution_of(index, projected.x, recorder, stop, recorder.evaluations, began)


def with_pairs(program: Program, slack: float) -> Program:
    """Return a program with every equality as two inequalities, each with some slack."""

    def none(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros(0), np.zeros((0, len(z)))

    def inequalities(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        values, jacobian = program.inequalities(z)
        equal, slope = program.equalities(z)
        return np.concatenate([values, equal - slack, -equal - slack]), np.concatenate([jacobian, slope, -slope])

    return replace(
        program,
        equalities=none,
        inequalities=inequalities,
        equality_count=0,
        inequality_count=program.inequality_count + 2 * program.equality_count,
    )
