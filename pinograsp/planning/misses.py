"""What kept the starts of a run from a grasp: causes body by body, and the nearest miss."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..problem import DesiredPoints, GraspProblem, TaskModel
from ..results import Grasp
from ..results.explanation import Cause, Explanation
from ..verification.check import Verifier
from .assemble import claim_of, grasp_of
from .attempt import Attempt, verifier_of
from .outcomes import obstacle_of

APART = " - "
"""Between the two bodies of a clearance."""


def explanation_of(model: TaskModel, attempts: Sequence[Attempt]) -> Explanation | None:
    """Return what kept starts from a grasp: causes and nearest miss; None if one led to a grasp, or none was tried.

    Args:
        model: the task.
        attempts: what became of the starts.
    """
    if not attempts or any(attempt.grasp for attempt in attempts):
        return None
    return Explanation(
        causes=_causes(attempts), nearest_miss=_nearest_miss(model, verifier_of(model), attempts), done=len(attempts)
    )


def _causes(attempts: Sequence[Attempt]) -> tuple[Cause, ...]:
    """Return the causes of starts without a grasp, the most frequent first."""
    found: dict[tuple[str, str], Cause] = {}
    for attempt in sorted(attempts, key=lambda a: a.solution.start):
        kind, miss, unit, where = obstacle_of(attempt)
        body = where.rpartition(APART)[2] if APART in where else ""
        known = found.get((kind, body))
        starts = known.starts + 1 if known else 1
        if known and known.nearest_miss <= miss:
            miss, where = known.nearest_miss, known.where
        found[kind, body] = Cause(kind, starts, starts / len(attempts), miss, unit, where, body)
    return tuple(sorted(found.values(), key=lambda cause: -cause.starts))


def _nearest_miss(model: TaskModel, verifier: Verifier, attempts: Sequence[Attempt]) -> Grasp | None:
    """Return the posture that came nearest to a grasp with its certificate; None if the solver failed on every start.

    What the check alone refuted is nearer than what the solver found no way for.
    """
    missed = [attempt for attempt in attempts if attempt.grasp is None and attempt.solution.violations]
    if not missed:
        return None
    nearest = min(missed, key=lambda a: (a.certificate is None, _size(a), a.solution.start)).solution
    none = np.zeros((len(model.robot.pads), 3))  # where the task desires no points, a posture does not depend on any
    desired = None if len(model.desired_points) else DesiredPoints(none, none)
    state = GraspProblem(model, nearest.assignment, desired=desired).state(nearest.x)
    claim = claim_of(state)
    return grasp_of(nearest.start, state, claim, verifier.check(claim))


def _size(attempt: Attempt) -> float:
    worst = attempt.solution.worst
    return 0.0 if worst is None else worst.size
