"""The least changes that make a task work, found by short plans, and each verified by another one.

Starts are those of one database of the scene as it was, with the usual margins where its own are larger. They keep off
walls by these: where a change is to smaller ones, some starts may be missing, which makes a remedy larger, never wrong.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from ..database.store import Database
from ..descriptions import Scene
from ..errors import InputError, TaskError
from ..kinematics.robot import Robot
from ..problem import TaskModel, check_placement, check_task
from ..problem.proposals import Candidate, Proposals
from ..progress import Progress, Report
from ..results.explanation import Remedy
from ..solve.local import LocalSolver
from ..solve.options import SolverOptions
from ..solve.pair_trials import PairTrials
from ..solve.starts import starts_near
from .attempt import attempt, items_of, verifier_of
from .defaults import PROPOSED
from .relaxations import suitable
from .relaxations.variant import Failure, Variant

STARTS = 12
"""Of a short plan that asks whether a change helps; it ends with its first grasp."""
SURE, ENOUGH = 32, 3
"""Starts of the plan that verifies a remedy, with another seed, at most; it ends with so many verified ones."""
CLOSE = 0.1
"""Part of a size to which it is found."""
FURTHER = (1.0, 1.25, 1.6, 2.2)
"""Factors of a size that are tried until the plan verifies it."""
EVALUATIONS = 60
"""Of a solve of a short plan."""


class Trials:
    """Short plans of changed scenes.

    Args:
        robot: what is planned for.
        database: where the starts come from.
        task: name of the task.
        options: how a start is solved.
        seed: of the choice of starts.
        end: when the last start may begin, on the clock `time.perf_counter`, s.
    """

    def __init__(
        self, robot: Robot, database: Database, task: str, options: SolverOptions, seed: int, end: float
    ) -> None:
        self._robot, self._database, self._task, self._seed, self._end = robot, database, task, seed, end
        self._until = end
        self._proposed: dict[str, Proposals | None] = {}
        """By all that they depend on; None where there are none."""
        self._quick = replace(options, max_evaluations=min(EVALUATIONS, options.budget), tries=1)
        self._options = options

    def share(self, parts: int) -> None:
        """Let plans go on for one of so many equal parts of the time that is left."""
        now = time.perf_counter()
        self._until = self._end if parts == 1 else now + (self._end - now) / parts

    def helps(self, scene: Scene) -> bool:
        """Whether a start of a short plan is verified; a scene that is refused is of no help.

        Raises:
            TimeoutError: the share of the time is over; so of `sure`.
        """
        return self._count(scene, STARTS, 1, self._seed, self._quick)[0] > 0

    def sure(self, scene: Scene) -> tuple[int, int]:
        """Return how many starts of a longer plan with another seed are verified, up to `ENOUGH`, of how many tried."""
        return self._count(scene, SURE, ENOUGH, self._seed + 1, self._options)

    def _count(self, scene: Scene, starts: int, enough: int, seed: int, options: SolverOptions) -> tuple[int, int]:
        try:
            check_placement(scene, self._task)
            model = TaskModel(self._robot, scene, self._task)
            check_task(model)
            candidates = self._candidates(model, seed)
        except InputError:
            return 0, 0
        solver, verifier = LocalSolver(model, options), verifier_of(model)
        verified = tried = 0
        for item in items_of(model, starts_near(self._database, model, starts, seed), candidates):
            if time.perf_counter() > self._until:
                raise TimeoutError
            tried += 1
            verified += attempt(solver, verifier, item).grasp is not None
            if verified == enough:
                break
        return verified, tried

    def _candidates(self, model: TaskModel, seed: int) -> tuple[Candidate, ...]:
        """Return the pairs that are proposed to the starts of a task; none if it desires some points.

        Raises:
            TaskError: there are none.
        """
        if model.task.desired_contacts is not None:
            return ()
        key = json.dumps([seed, *_proposed_for(model)], sort_keys=True)
        if key not in self._proposed:
            self._proposed[key] = None
            self._proposed[key] = Proposals(model, seed, PairTrials(model).held)
        known = self._proposed[key]
        if known is None:
            raise TaskError("no contacts can be proposed", key=f"objects.{model.task.object}.shape")
        return known.here(model, PROPOSED)


def remedies(failure: Failure, trials: Trials, report: Report) -> Iterator[Remedy]:
    """Yield the remedies of a failure, one for each kind of change that helps, as they are found.

    Every kind has its part of the time, and what those before it have left of theirs.

    Args:
        failure: what is to be mended.
        trials: short plans.
        report: called before every kind of change.

    Raises:
        TimeoutError: the time of the trials was too short for some kind.
    """
    kinds, late = suitable(failure), False
    for number, variants in enumerate(kinds):
        report(Progress("remedies", number, len(kinds)))
        trials.share(len(kinds) - number)
        try:
            found = _least(failure.scene, variants, trials)
        except TimeoutError:
            late = True
            continue
        if found is not None:
            yield found
    if late:
        raise TimeoutError


def _least(scene: Scene, variants: list[Variant], trials: Trials) -> Remedy | None:
    """Return the least change of one kind: that variant which helps at the least of the sizes tried."""
    low = 0.0
    for size in variants[0].sizes if variants else ():
        for variant in variants:
            if size in variant.sizes and _helps(scene, variant, size, trials):
                return _verified(scene, variant, _bisected(scene, variant, low, size, trials), trials)
        low = size
    return None


def _helps(scene: Scene, variant: Variant, size: float, trials: Trials) -> bool:
    there = _changed(scene, variant, size)
    return there is not None and trials.helps(there)


def _bisected(scene: Scene, variant: Variant, low: float, high: float, trials: Trials) -> float:
    """Return the least size that helps, to `CLOSE` of it, between one that does not and one that does."""
    while high - low > max(variant.step, CLOSE * high):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _helps(scene, variant, middle, trials) else (middle, high)
    return high


def _verified(scene: Scene, variant: Variant, size: float, trials: Trials) -> Remedy | None:
    """Return the remedy of a size or one a little larger that the longer plan verifies."""
    for factor in FURTHER:
        larger = variant.step * math.ceil(factor * size / variant.step - 1e-6)
        there = _changed(scene, variant, larger)
        if there is None:
            return None
        verified, tried = trials.sure(there)
        if verified >= ENOUGH:
            changes = variant.changes(larger)
            amount, text = variant.amount(larger), variant.text(larger)
            return Remedy(variant.kind, text, amount, variant.unit, changes, verified, tried)
    return None


def _changed(scene: Scene, variant: Variant, size: float) -> Scene | None:
    """Return the scene with a change; None where there is no such change."""
    try:
        return Remedy(variant.kind, "", 0.0, variant.unit, variant.changes(size), 0, 0).apply(scene)
    except (InputError, ValueError):
        return None


def _proposed_for(model: TaskModel) -> tuple[Any, Any]:
    """Return what proposals depend on: the object, but for its pose, and the task, but for its load and walls."""
    body, task = (data.model_dump(mode="json") for data in (model.scene.objects[model.task.object], model.task))
    del body["pose"], body["mass"], task["wrench"], task["margin"]["enclosure"]
    return body, task
