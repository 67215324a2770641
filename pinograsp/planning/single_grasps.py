"""Grasps one by one, in this process, from the starts whose hand is nearest to the object."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import real_number, whole_number
from ..interrupts import heard
from ..problem import TaskModel
from ..problem.contact_pairs import proposal
from ..results import Setup
from ..solve.local import LocalSolver
from ..solve.options import SolverOptions
from ..solve.start_index import HeldHand
from .attempt import Attempt, Item, attempt, items_of, opened, verifier_of
from .bound import least_U
from .databases import Databases
from .grading import graded
from .task_models import TaskModels

NEAREST = 400
"""Starts that a search for single grasps tries at most."""
QUICK = 30
"""Evaluations that it spends on a start at most: where one fails, the next start is better than a second try."""
AT_THE_BOUND = 1e-3
"""A U within this part of its lower bound cannot be bettered by more than that."""


@dataclass(frozen=True)
class Limits:
    """Where a search for single grasps ends."""

    most: int | None
    """Number of grasps."""
    end: float
    """On the clock `time.perf_counter`, s."""

    @classmethod
    def of(cls, most: int | None, deadline: float | None) -> Limits:
        """Return limits from now on.

        Raises:
            InputError: a number is out of range.
        """
        most = None if most is None else whole_number("most", most, 1)
        seconds = math.inf if deadline is None else real_number("deadline", deadline, 0.0)
        return cls(most, time.perf_counter() + seconds)


class SingleGrasps:
    """The search for single grasps of a session's tasks.

    Args:
        models: of the tasks.
        databases: where the starts come from.
        options: how a start is solved by a whole plan.
    """

    def __init__(self, models: TaskModels, databases: Databases, options: SolverOptions) -> None:
        self._models, self._databases = models, databases
        self.options = replace(options, max_evaluations=min(QUICK, options.budget), tries=1)
        """How a start is solved where the next one is better than a second try."""
        self._hands: dict[str, HeldHand] = {}
        self._bounds: dict[str, float] = {}

    def nearest(self, model: TaskModel) -> list[Item]:
        """Return the starts whose hand is nearest to the object, the most promising first.

        Raises:
            InputError: there is no database for the task, or no contacts can be proposed.
        """
        task, candidates = model.task_name, self._models.candidates(model, 0)
        if task not in self._hands:  # neither depends on where objects stand
            self._models.evaluate_once(model, candidates)
            self._hands[task], self._bounds[task] = HeldHand(model), least_U(model)
        hand, index = self._hands[task], self._databases.index(self._models.scene, model.task.margin)
        if not candidates:
            return items_of(model, index.starts(model, hand, model.desired_points[None], NEAREST), ())
        pairs = [proposal(candidate, model) for candidate in candidates]
        points = np.array([pair.desired.points for pair in pairs])
        postures = index.starts(model, hand, points, NEAREST)
        own = hand.misses(postures[:, : model.robot.arm_size], points).argmin(axis=0)
        return [
            Item(number, opened(model, posture, candidates[k]), (pairs[k],))
            for number, (posture, k) in enumerate(zip(postures, own, strict=True))
        ]

    def tried(self, model: TaskModel, items: Sequence[Item], limits: Limits, setup: Setup) -> Iterator[Attempt]:
        """Yield what becomes of one start of `nearest` after the other, within limits.

        Args:
            model: the task.
            items: its starts.
            limits: where it ends.
            setup: to which the grasps belong; they have all their figures.
        """
        with heard():
            solver, verifier = LocalSolver(model, self.options), verifier_of(model)
        bound, found = (1.0 + AT_THE_BOUND) * self._bounds[model.task_name], 0
        for item in items:
            if time.perf_counter() > limits.end:
                return
            with heard():
                done = attempt(solver, verifier, item)
                if done.grasp is not None:
                    done = replace(done, grasp=replace(graded(done.grasp, verifier), setup=setup))
            yield done
            if done.grasp is None:
                continue
            found += 1
            if found == limits.most or bound >= done.grasp.cost.U:
                return
