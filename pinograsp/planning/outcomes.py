"""Outcomes of the starts of a run, and the result that holds them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, get_args

import numpy as np

from ..database.store import Database, identity_of
from ..descriptions.robot_files import Hashes
from ..progress import Progress
from ..results import WITHSTAND, Blocked, Grasp, Result, Setup, merge
from ..results.explanation import Explanation
from ..results.provenance import provenance
from ..solver_words import Outcome
from ..units import in_si
from ..verification.resistance import Q_FORCE, is_graded
from .attempt import Attempt

EMPTY = "the database is empty: the arm keeps its margins from walls, obstacles and itself nowhere"


@dataclass
class Run:
    """A run on its way: filled as the starts are tried."""

    setup: Setup
    files: Hashes
    """Of the robot when it was loaded."""
    starts: int
    warnings: tuple[str, ...] = ()
    attempts: list[Attempt] = field(default_factory=list)
    verified: int = 0
    """Attempts with a grasp; counted as they come, as progress is reported after each."""
    best_U: float = math.inf
    """Least U of these."""
    times: dict[str, float] = field(default_factory=dict)
    """Seconds per stage."""
    facts: dict[str, Any] = field(default_factory=dict)
    """Seed, options and database, for the provenance."""
    interrupted: bool = False

    def add(self, attempt: Attempt) -> None:
        """Take in what became of a start."""
        self.attempts.append(attempt)
        if attempt.grasp:
            self.verified += 1
            self.best_U = min(self.best_U, attempt.grasp.cost.U)

    def progress(self, total: int) -> Progress:
        """Return how far the run is, of so many starts: with how many are `verified`, and the `best U` of these."""
        best = {"best U": self.best_U} if self.verified else {}
        return Progress("starts", len(self.attempts), total, {"verified": self.verified, **best})

    def count_starts(self, found: int, radius: float, nearest: float) -> None:
        """Warn where fewer starts were found in the database than asked for.

        Args:
            found: number of them.
            radius: of the region around the object where they were looked for, m.
            nearest: distance of the nearest wrist of the database from the object, m.
        """
        if found == self.starts:
            return
        few = f"only {found} of {self.starts} starts were found" if found else "no start was found"
        reason = f"the database has no {'more ' if found else ''}configuration that suits the task and has the wrist "
        reason += f"within {radius:g} m (start_radius) of the object"
        if not self.facts["database"]["rows"]:
            reason = EMPTY
        elif nearest > radius:
            lacking = math.ceil(100.0 * (nearest - radius)) / 100
            reason += (
                f"; the nearest has it {nearest:.2f} m away: move the object {lacking:.2f} m or more towards the arm, "
            )
            reason += "or give a larger start_radius"
        self.warnings += (f"{few}: {reason}",)

    def count_tried(self, deadline: float | None) -> None:
        """Warn where no start was tried.

        Args:
            deadline: after which none began, s.
        """
        if self.attempts:
            return
        if self.starts:
            reason = f"the preparations took {self.times['prepare']:.1f} s, the deadline is {deadline:g} s"
            self.warnings += (f"no start was tried: {reason}",)
        else:
            reason = "the database has no configuration that suits the task"
            self.warnings += (f"no start was found: {reason if self.facts['database']['rows'] else EMPTY}",)

    def count_graded(self, grasps: Sequence[Grasp]) -> None:
        """Warn where workers that died have left grasps without the figures of their resistance."""
        lost = sum(not is_graded(grasp.certificate) for grasp in grasps)
        if lost and not self.interrupted:
            self.warnings += (f"the resistance of {lost} grasps is not known: workers ended twice over them",)

    def distinct(self) -> tuple[Grasp, ...]:
        """Return the grasps that were found, near-identical ones as one."""
        return merge([attempt.grasp for attempt in self.attempts if attempt.grasp])

    def result(self, grasps: tuple[Grasp, ...], explanation: Explanation | None = None) -> Result:
        """Return the result of what was tried.

        Args:
            grasps: the distinct ones with all their figures, in the default order.
            explanation: why there are none.
        """
        attempts = self.attempts
        outcomes = Counter(attempt.solution.outcome for attempt in attempts)
        return Result(
            setup=self.setup,
            grasps=grasps,
            starts=self.starts,
            counts={outcome: outcomes[outcome] for outcome in get_args(Outcome)},
            verified=sum(1 for attempt in attempts if attempt.grasp),
            refuted=sum(1 for attempt in attempts if _refuted(attempt)),
            blocked=blocked(attempts),
            explanation=explanation,
            interrupted=self.interrupted,
            warnings=self.warnings,
            times=self.times | _times(attempts),
            provenance=provenance(self.setup.robot, self.setup.scene, self.files) | self.facts,
        )


def facts_of(database: Database) -> dict[str, Any]:
    """Return the database that starts come from, for the provenance."""
    return {"file": str(database.file), "rows": database.rows(), "identity": identity_of(database).digest}


def _refuted(attempt: Attempt) -> bool:
    """Whether the check refuted what the solver called feasible, for more than what it withstands."""
    return attempt.certificate is not None and not attempt.certificate.verified and not too_weak(attempt)


def too_weak(attempt: Attempt) -> bool:
    """Whether all that an attempt lacks is that its grasp withstands as much as the task asks for."""
    certificate = attempt.certificate
    return certificate is not None and [figure.name for figure in certificate.refuted_by] == [Q_FORCE]


def _times(attempts: Sequence[Attempt]) -> dict[str, float]:
    if not attempts:
        return {}
    seconds = [attempt.solution.seconds for attempt in attempts]
    return {
        "solver_mean": float(np.mean(seconds)),
        "solver_median": float(np.median(seconds)),
        "verification_mean": float(np.mean([attempt.verify_seconds for attempt in attempts])),
    }


def blocked(attempts: Sequence[Attempt]) -> dict[str, Blocked]:
    """Return, per kind of constraint, how many starts it blocked and the nearest miss."""
    found: dict[str, Blocked] = {}
    for attempt in sorted(attempts, key=lambda a: a.solution.start):
        if attempt.grasp:
            continue
        kind, miss, unit, where = obstacle_of(attempt)
        known = found.get(kind)
        if known is None or miss < known.nearest_miss:
            found[kind] = Blocked((known.starts if known else 0) + 1, miss, unit, where)
        else:
            found[kind] = Blocked(known.starts + 1, known.nearest_miss, known.unit, known.where)
    return found


def obstacle_of(attempt: Attempt) -> tuple[str, float, str, str]:
    """Return kind, violation, unit and place of what kept an attempt from being verified."""
    if attempt.certificate is not None:
        figure = attempt.certificate.refuted_by[0]
        if too_weak(attempt):
            return WITHSTAND, figure.limit - figure.value, figure.unit, figure.where
        return f"check of {figure.name}", abs(figure.value - figure.limit), figure.unit, figure.where
    worst = attempt.solution.worst
    if worst is None:
        return "solver failure", 0.0, "", attempt.solution.message
    return worst.name, *in_si(worst.value, worst.unit), worst.where
