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
from pinograsp.database.cache import cached_database
from pinograsp.descriptions import Scene
from pinograsp.execution import own_workers
from pinograsp.planning.attempt import Item, Solver, attempts_of
from pinograsp.problem import TaskModel
from pinograsp.solve.local import LocalSolver
from pinograsp.solve.options import SolverOptions
from pinograsp.solve.starts import starts_near

from .page import Table
from .runs import near_best
from .store import Lines


@dataclass(frozen=True)
class Attempt:
    """What one start came to."""

    start: int
    U: float | None
    """Of a grasp that the independent check verified."""
    evaluations: int
    seconds: float


Method = Callable[[TaskModel], Solver]
"""Makes, in a worker process, what solves one start after the other."""


def by_options(options: SolverOptions) -> Method:
    """Return pinograsp's own way of solving a start."""
    return partial(LocalSolver, options=options)


def postures_of(robot: pinograsp.Robot, scene: Scene, task: str, count: int, seed: int) -> np.ndarray:
    """Return the starts that a plan of as many starts has, shape (count, l + s)."""
    model = TaskModel(robot, scene, task)
    with cached_database(robot, scene, model.task.margin, progress=Lines()) as database:
        found: np.ndarray = starts_near(database, model, count, seed)
    return found


def attempt_all(
    robot: pinograsp.Robot,
    scene: Scene,
    task: str,
    postures: np.ndarray,
    method: Method,
    workers: int,
    label: str,
) -> list[Attempt]:
    """Solve every start and judge what comes of it, sorted by start."""
    lines, done = Lines(), []
    prepare = partial(attempts_of, TaskModel(robot, scene, task), method)
    items = [Item(*start) for start in enumerate(postures)]
    with own_workers(workers) as pool:
        for attempt in pool.run(prepare, items, chunk=2):
            solution, U = attempt.solution, attempt.grasp.cost.U if attempt.grasp else None
            done.append(Attempt(solution.start, U, solution.evaluations, solution.seconds))
            verified = {"verified": sum(a.U is not None for a in done)}
            lines(pinograsp.Progress(label, len(done), len(postures), verified))
    return sorted(done, key=lambda a: a.start)


def as_data(attempts: Sequence[Attempt]) -> list[dict[str, Any]]:
    """Return attempts as JSON data."""
    return [asdict(attempt) for attempt in attempts]


def of_data(data: Sequence[dict[str, Any]]) -> list[Attempt]:
    """Return the attempts that `as_data` wrote."""
    return [Attempt(**entry) for entry in data]


HEAD = ("verified", "near the best", "best U", "evaluations a start", "ms a start", "verified a second and core")


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
