"""Single starts solved by any method and judged by the independent check, for comparisons.

A plan (`pinograsp.plan`) does not say what one start took; a comparison of methods needs it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

import pinograsp
from pinograsp.database import cached_database
from pinograsp.descriptions import SceneDescription
from pinograsp.execution.pool import work
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.results import claim_of, grasp_of
from pinograsp.solve import LocalSolver, SolverOptions, starts_near
from pinograsp.verification import Verifier

from .page import Table
from .runs import near_best
from .store import Lines


@dataclass(frozen=True)
class Found:
    """Where a method went from one start."""

    problem: GraspProblem
    x: np.ndarray
    feasible: bool
    """By the method's own measure."""
    evaluations: int
    seconds: float


@dataclass(frozen=True)
class Attempt:
    """What one start came to."""

    start: int
    U: float | None
    """Of a grasp that the independent check verified."""
    evaluations: int
    seconds: float


Solve = Callable[[int, np.ndarray], Found]
Method = Callable[[TaskModel], Solve]
"""Makes, in a worker process, what solves one start after the other."""


def by_options(options: SolverOptions, model: TaskModel) -> Solve:
    """Return pinograsp's own way of solving a start."""
    solver = LocalSolver(model, options)

    def solve(index: int, posture: np.ndarray) -> Found:
        s = solver.solve(index, posture)
        return Found(solver.problem(s.assignment), s.x, s.feasible, s.evaluations, s.seconds)

    return solve


def postures_of(robot: pinograsp.RobotModel, scene: SceneDescription, task: str, count: int, seed: int) -> np.ndarray:
    """Return the starts that a plan of as many starts has, shape (count, l + s)."""
    model = TaskModel(robot, scene, task)
    rows = Lines("rows of the start database")
    with cached_database(robot, scene, model.task.margin, progress=lambda p: rows(p.rows, p.size)) as database:
        found: np.ndarray = starts_near(database, model, count, seed)
    return found


def attempt_all(
    robot: pinograsp.RobotModel,
    scene: SceneDescription,
    task: str,
    postures: np.ndarray,
    method: Method,
    workers: int,
    label: str,
) -> list[Attempt]:
    """Solve every start and judge what comes of it, sorted by start."""
    lines, done = Lines(label), []
    for attempt in work(partial(_prepare, robot, scene, task, method), list(enumerate(postures)), workers, chunk=2):
        done.append(attempt)
        lines(len(done), len(postures), f"{sum(a.U is not None for a in done)} reliable")
    return sorted(done, key=lambda a: a.start)


def _prepare(
    robot: pinograsp.RobotModel, scene: SceneDescription, task: str, method: Method
) -> Callable[[tuple[int, np.ndarray]], Attempt]:
    solve = method(TaskModel(robot, scene, task))
    verifier = Verifier(robot.description, scene, task)

    def attempt(item: tuple[int, np.ndarray]) -> Attempt:
        index, posture = item
        found = solve(index, posture)
        U = verified_cost(index, found.problem, found.x, verifier) if found.feasible else None
        return Attempt(index, U, found.evaluations, found.seconds)

    return attempt


def verified_cost(index: int, problem: GraspProblem, x: np.ndarray, verifier: Verifier) -> float | None:
    """Return U at x if the independent check verifies the grasp there."""
    state = problem.state(x)
    claim = claim_of(state)
    certificate = verifier.check(claim)
    return grasp_of(index, state, claim, certificate).cost.U if certificate.verified else None


def as_data(attempts: Sequence[Attempt]) -> list[dict[str, Any]]:
    """Return attempts as JSON data."""
    return [asdict(attempt) for attempt in attempts]


def of_data(data: Sequence[dict[str, Any]]) -> list[Attempt]:
    """Return the attempts that `as_data` wrote."""
    return [Attempt(**entry) for entry in data]


HEAD = ("reliable", "near the best", "best U", "evaluations a start", "ms a start", "reliable a second and core")


def attempts_table(of_methods: dict[tuple[str, ...], list[Attempt]], head: tuple[str, ...]) -> Table:
    """Return a table of methods on the same starts; the best U of them all says what is near the best.

    Args:
        of_methods: attempts by the first cells of their row.
        head: heads of these cells.
    """
    best = min((a.U for attempts in of_methods.values() for a in attempts if a.U is not None), default=None)
    rows = []
    for first, attempts in of_methods.items():
        found = sorted(a.U for a in attempts if a.U is not None)
        seconds = [a.seconds for a in attempts]
        rows.append(
            (
                *first,
                f"{100 * len(found) / len(attempts):.1f} %",
                f"{100 * near_best(found, best or 0.0) / len(attempts):.1f} %",
                f"{found[0]:.6g}" if found else "-",
                f"{np.mean([a.evaluations for a in attempts]):.0f}",
                f"{1e3 * np.mean(seconds):.1f}",
                f"{len(found) / sum(seconds):.3g}",
            )
        )
    return Table((*head, *HEAD), rows)
