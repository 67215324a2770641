"""Why a task finds no grasp, and what would help: a plan, or its refusal, and remedies."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import replace

from threadpoolctl import threadpool_limits

from ..database.store import Database
from ..descriptions import Scene
from ..errors import TaskError
from ..interrupts import taken, undisguised
from ..kinematics.hand_posture import jaw_range
from ..kinematics.reach import arm_reach
from ..kinematics.robot import Robot
from ..problem import TaskModel, file_findings
from ..problem.proposals import Proposals
from ..progress import Report
from ..results import Result
from ..results.explanation import Explanation, Remedy, Tried
from ..solve.options import SolverOptions
from .relaxations.variant import Failure
from .remedies import remedies
from .trials import Trials

BETWEEN = re.compile(r"\.[^.\[]+(?=\.)|\[.*$")
"""What a key of the scene has besides table and field: names, numbers."""
NAMED = re.compile(r"the (?:obstacle|object) '([^']+)'$|beyond (wall [xyz]=\S+)$")


def explained(
    robot: Robot,
    scene: Scene,
    task: str,
    plan: Callable[[], Result],
    database: Callable[[], Database],
    proposed: Callable[[], tuple[TaskModel, Proposals] | None],
    *,
    options: SolverOptions,
    seed: int,
    deadline: float,
    report: Report,
) -> Explanation:
    """Return why a task finds no grasp, with remedies.

    Args:
        robot: of the plan.
        scene: of the plan.
        task: its name.
        plan: plans it.
        database: gives the starts.
        proposed: gives the model of the plan and what it has proposed to its starts, if anything.
        options: how a start is solved.
        seed: of the choice of starts.
        deadline: after which no start of a remedy begins, s from the end of the plan.
        report: called as the work goes on.

    Raises:
        InputError: the scene cannot be used, for another reason than that the task cannot work.
    """
    began, bodies, kinds = time.perf_counter(), tuple[str, ...](), tuple[str, ...]()
    try:
        result = plan()
    except TaskError as error:
        refusal = f"{error.problem}. {error.remedy}" if error.remedy else error.problem
        odd = file_findings(scene, scene.task(task), robot.description)  # a wrong unit may be what is refused
        found = Explanation(refusal=refusal, warnings=tuple(odd))
        kinds = (BETWEEN.sub("", error.key or ""),)
        bodies = _named(error.problem)
    else:
        found = result.explanation or Explanation(done=result.done, verified=result.verified)
        found = replace(found, warnings=result.warnings, interrupted=result.interrupted)
        kinds = tuple(dict.fromkeys(cause.kind for cause in found.causes))
        bodies = tuple(dict.fromkeys(cause.body for cause in found.causes if cause.body))
    if not (found.verified or found.interrupted):
        base = arm_reach(robot.mounted(scene.mounting.matrix))[0]
        failure = Failure(scene, task, base, bodies, kinds, found.nearest_miss, jaw_range(robot), found.done)
        kept, tried, ended = list[Remedy](), list[Tried](), False
        try:
            end = time.perf_counter() + deadline
            with undisguised(), threadpool_limits(1):  # of BLAS, as in workers
                trials = Trials(robot, database(), task, options, seed, end, proposed())
                for outcome in remedies(failure, trials, report):  # kept one by one, so that an end loses none
                    if isinstance(outcome, Remedy):
                        kept.append(outcome)
                    else:
                        tried.append(outcome)
        except KeyboardInterrupt:
            taken()
            ended = True
        ended |= not all(change.whole for change in tried)
        found = replace(found, remedies=tuple(kept), tried=tuple(tried), interrupted=ended)
    return replace(found, seconds=time.perf_counter() - began)


def _named(problem: str) -> tuple[str, ...]:
    """Return the body that a refusal ends with."""
    found = NAMED.search(problem)
    return () if found is None else tuple(name for name in found.groups() if name)
