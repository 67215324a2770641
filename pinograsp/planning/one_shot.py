"""The whole way, from a robot file and a scene file to verified grasps."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import get_args

import numpy as np

from ..arrays import Array
from ..database import BuildProgress, Database, Identity, cached_database
from ..descriptions import SceneDescription
from ..descriptions.scene import Margins
from ..errors import InputError
from ..execution.pool import work
from ..kinematics.robot import RobotModel
from ..problem import UNITS, GraspProblem, TaskModel, check_task
from ..results import Blocked, Grasp, Result, Setup, claim_of, grasp_of, merge, provenance
from ..solve import LocalSolver, Solution, SolverOptions, starts_near
from ..solve.local import Outcome
from ..verification import Certificate, Verifier

DEFAULT_STARTS = 1304
"""The paper's number of starts."""


@dataclass(frozen=True)
class Attempt:
    """What one start came to."""

    solution: Solution
    certificate: Certificate | None
    """Of a solution that the solver calls feasible."""
    grasp: Grasp | None
    """If the certificate verifies it."""
    verify_seconds: float


@dataclass(frozen=True)
class Progress:
    """How far a run is."""

    done: int
    total: int
    reliable: int
    best_U: float
    """Infinite until the first reliable grasp."""


def plan(
    robot: RobotModel,
    scene: SceneDescription,
    task: str,
    *,
    starts: int = DEFAULT_STARTS,
    workers: int | None = None,
    seed: int = 0,
    database: Database | Path | str | None = None,
    options: SolverOptions | None = None,
    progress: Callable[[Progress], None] | None = None,
    build_progress: Callable[[BuildProgress], None] | None = None,
) -> Result:
    """Find, verify and rank grasps.

    The same seed gives the same grasps for any number of workers. Ctrl-C ends the search and returns what was
    found until then.

    Args:
        robot: from `load_robot`; it is mounted where the scene says.
        scene: from `load_scene`.
        task: name of a task of the scene.
        starts: number of starts.
        workers: number of processes; None: one for each core.
        seed: of the choice of starts.
        database: where the starts come from; None: a small one in the user's cache folder, built on first use.
        options: how each start is solved.
        progress: called after every start.
        build_progress: called after every batch while a database is built.

    Raises:
        InputError: the task does not exist or makes no sense for this robot and scene, the database belongs to
            another robot, enclosure or margin, or a number is out of range.
    """
    for name, number, least in (("starts", starts, 1), ("seed", seed, 0), ("workers", workers or 1, 1)):
        if number < least:
            raise InputError(f"must be at least {least}, not {number}", key=name)
    began = time.perf_counter()
    options = options or SolverOptions()
    workers = workers or os.cpu_count() or 1
    model = TaskModel(robot, scene, task)
    warnings = check_task(model)
    _evaluate_once(model)
    attempts: list[Attempt] = []
    interrupted = False
    times = {"prepare": time.perf_counter() - began}
    run: dict[str, object] = {"seed": seed, "workers": workers, "options": options.to_json()}
    try:
        with _database(database, robot, scene, model.task.margin, workers, build_progress) as opened:
            times["database"] = time.perf_counter() - began - times["prepare"]
            postures = starts_near(opened, model, starts, seed)
            run["database"] = {"file": str(opened.file), "rows": opened.rows(), "identity": opened.identity.digest}
        times["starts"] = time.perf_counter() - began - times["prepare"] - times["database"]
        with closing(_attempts(robot, scene, task, options, postures, workers)) as running:
            for attempt in running:
                attempts.append(attempt)
                if progress:
                    progress(_progress(attempts, len(postures)))
    except KeyboardInterrupt:
        interrupted = True
    times["total"] = time.perf_counter() - began
    return _result(robot, scene, task, starts, attempts, interrupted, times, run, warnings)


def _evaluate_once(model: TaskModel) -> None:
    """Have everything compiled that evaluations need, here and once, not in every worker."""
    problem = GraspProblem(model, tuple(range(len(model.desired_points))))
    problem.evaluate(0.5 * (problem.lower + problem.upper))


@contextmanager
def _database(
    given: Database | Path | str | None,
    robot: RobotModel,
    scene: SceneDescription,
    margins: Margins,
    workers: int,
    progress: Callable[[BuildProgress], None] | None,
) -> Iterator[Database]:
    """Give the database to take starts from, for certain the right one; what is opened here is closed again."""
    if given is None:
        with cached_database(robot, scene, margins, workers=workers, progress=progress) as cached:
            yield cached
        return
    with nullcontext(given) if isinstance(given, Database) else Database.open(given) as opened:
        opened.require(Identity.of(robot, scene, margins))
        yield opened


def _attempts(
    robot: RobotModel,
    scene: SceneDescription,
    task: str,
    options: SolverOptions,
    postures: Array,
    workers: int,
) -> Generator[Attempt]:
    prepare = partial(_prepare, robot, scene, task, options)
    return work(prepare, list(enumerate(postures)), workers)


def _prepare(
    robot: RobotModel, scene: SceneDescription, task: str, options: SolverOptions
) -> Callable[[tuple[int, Array]], Attempt]:
    """Build, in a worker, what handles one start after the other."""
    solver = LocalSolver(TaskModel(robot, scene, task), options)
    verifier = Verifier(robot.description, scene, task)

    def attempt(item: tuple[int, Array]) -> Attempt:
        index, posture = item
        solution = solver.solve(index, posture)
        if not solution.feasible:
            return Attempt(solution, None, None, 0.0)
        began = time.perf_counter()
        state = solver.problem(solution.assignment).state(solution.x)
        claim = claim_of(state)
        certificate = verifier.check(claim)
        grasp = grasp_of(index, state, claim, certificate) if certificate.verified else None
        return Attempt(solution, certificate, grasp, time.perf_counter() - began)

    return attempt


def _progress(attempts: list[Attempt], total: int) -> Progress:
    costs = [attempt.grasp.cost.U for attempt in attempts if attempt.grasp]
    return Progress(len(attempts), total, len(costs), min(costs, default=float("inf")))


def _result(
    robot: RobotModel,
    scene: SceneDescription,
    task: str,
    starts: int,
    attempts: list[Attempt],
    interrupted: bool,
    times: dict[str, float],
    run: dict[str, object],
    warnings: list[str],
) -> Result:
    outcomes = Counter(attempt.solution.outcome for attempt in attempts)
    seconds = [attempt.solution.seconds for attempt in attempts]
    grasps = [attempt.grasp for attempt in attempts if attempt.grasp]
    if attempts:
        times["solver_mean"] = float(np.mean(seconds))
        times["solver_median"] = float(np.median(seconds))
        times["verification_mean"] = float(np.mean([a.verify_seconds for a in attempts]))
    return Result(
        setup=Setup(robot.description, scene, task),
        grasps=merge(grasps),
        starts=starts,
        counts={outcome: outcomes[outcome] for outcome in get_args(Outcome)},
        reliable=len(grasps),
        refuted=sum(1 for a in attempts if a.certificate and not a.certificate.verified),
        blocked=_blocked(attempts),
        interrupted=interrupted,
        warnings=tuple(warnings),
        times=times,
        provenance=provenance(robot.description, scene) | run,
    )


def _blocked(attempts: list[Attempt]) -> dict[str, Blocked]:
    """Return, per kind of constraint, how many starts it blocked and the nearest miss."""
    blocked: dict[str, Blocked] = {}
    for attempt in sorted(attempts, key=lambda a: a.solution.start):
        if attempt.grasp:
            continue
        kind, miss, unit, where = _obstacle(attempt)
        known = blocked.get(kind)
        if known is None or miss < known.nearest_miss:
            blocked[kind] = Blocked((known.starts if known else 0) + 1, miss, unit, where)
        else:
            blocked[kind] = Blocked(known.starts + 1, known.nearest_miss, known.unit, known.where)
    return blocked


def _obstacle(attempt: Attempt) -> tuple[str, float, str, str]:
    """Return kind, violation, unit and place of what kept an attempt from being reliable."""
    if attempt.certificate:
        figure = attempt.certificate.refuted_by[0]
        return f"check of {figure.name}", abs(figure.value - figure.limit), figure.unit, figure.where
    if not attempt.solution.violations:
        return "solver failure", 0.0, "", attempt.solution.message
    kind, violation, where = attempt.solution.worst
    return kind, violation, UNITS.get(kind, "mm"), where
