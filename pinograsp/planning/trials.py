"""Short plans of changed scenes: whether a change helps, and whether it surely does.

Starts are those of one database of the scene as it was, with the usual margins where its own are larger. They keep off
walls by these: where a change is to smaller ones, some starts may be missing, which makes a remedy larger, never wrong.
"""

from __future__ import annotations

import json
import time
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..database.store import Database
from ..descriptions import Scene
from ..errors import InputError, TaskError
from ..kinematics.robot import Robot
from ..problem import TaskModel, check_placement, check_task
from ..problem.contact_pairs import Candidate
from ..problem.proposals import Proposals
from ..solve.guesses import NEAR, held_guesses
from ..solve.local import LocalSolver
from ..solve.options import SolverOptions
from ..solve.pair_trials import PairTrials
from ..solve.projection import initial_guesses, nearest_assignment
from ..solve.starts import starts_near
from .attempt import Item, attempt, items_of, verifier_of
from .defaults import PROPOSED

STARTS = 12
"""Of a short plan that asks whether a change helps; it ends with its first grasp."""
FAILURES = 2
"""Solves of promising starts that may fail before a short plan is given up."""
FEW = 8
"""Pairs of contacts that are proposed to the starts of a short plan."""
KEPT = 3
"""Postures of grasps that are kept as starts of further short plans."""
EVALUATIONS = 60
"""Of a solve of a short plan."""
SURE, ENOUGH = 32, 3
"""Starts of the plan that verifies a remedy, with another seed, at most; it ends with so many verified ones."""
PATIENCE = 12
"""Starts after which it ends if none is verified."""


class Trials:
    """Short plans of changed scenes.

    Args:
        robot: what is planned for.
        database: where the starts come from.
        task: name of the task.
        options: how a start is solved.
        seed: of the choice of starts.
        end: when the last start may begin, on the clock `time.perf_counter`, s.
        proposed: model of the plan that failed, and what was proposed to its starts, if anything was.
    """

    def __init__(
        self,
        robot: Robot,
        database: Database,
        task: str,
        options: SolverOptions,
        seed: int,
        end: float,
        proposed: tuple[TaskModel, Proposals] | None = None,
    ) -> None:
        self._robot, self._database, self._task, self._seed, self._end = robot, database, task, seed, end
        self._until = end
        self._proposed: dict[str, Proposals | None] = {}
        """By all that they depend on; None where there are none."""
        if proposed is not None:
            self._proposed[_proposed_for(proposed[0])] = proposed[1]
        self._quick = replace(options, max_evaluations=min(EVALUATIONS, options.budget), tries=1)
        self._options = options
        self._led: list[Array] = []
        """Postures of grasps, the last one first."""

    def share(self, parts: float) -> None:
        """Let plans go on for one of so many equal parts of the time that is left."""
        now = time.perf_counter()
        self._until = self._end if parts == 1 else now + (self._end - now) / parts

    def helps(self, scene: Scene) -> bool:
        """Whether a start of a short plan is verified; a scene that is refused is of no help.

        Its first starts are the postures of grasps that were found before. Those starts are solved that can be brought
        onto the object with nothing in the way: of these nine of ten lead to a grasp, of others one of ten.

        Raises:
            TimeoutError: the share of the time is over; so of `sure`.
        """
        self._in_time()
        found = self._prepared(scene, FEW)
        if found is None:
            return False
        model, candidates = found
        solver, verifier, failures = LocalSolver(model, self._quick), verifier_of(model), 0
        for item in self._items(model, candidates):
            self._in_time()
            if not _promising(solver, model, item, self._quick):
                continue
            done = attempt(solver, verifier, item)
            if done.grasp is not None:
                self._led = [done.solution.x[: model.robot.posture_size], *self._led][:KEPT]
                return True
            failures += 1
            if failures == FAILURES:
                break
        return False

    def sure(self, scene: Scene) -> tuple[int, int]:
        """Return how many of other starts, spread as in a plan, are verified, up to `ENOUGH`, of how many tried."""
        found = self._prepared(scene, PROPOSED)
        if found is None:
            return 0, 0
        model, candidates = found
        solver, verifier = LocalSolver(model, self._options), verifier_of(model)
        verified = tried = 0
        for item in items_of(model, starts_near(self._database, model, SURE, self._seed + 1), candidates):
            self._in_time()
            tried += 1
            verified += attempt(solver, verifier, item).grasp is not None
            if verified == ENOUGH or (tried == PATIENCE and not verified):
                break
        return verified, tried

    def _in_time(self) -> None:
        if time.perf_counter() > self._until:
            raise TimeoutError

    def _prepared(self, scene: Scene, most: int) -> tuple[TaskModel, tuple[Candidate, ...]] | None:
        """Return the model of a scene and what is proposed to its starts; None if it is refused."""
        try:
            check_placement(scene, self._task)
            model = TaskModel(self._robot, scene, self._task)
            check_task(model)
            return model, self._candidates(model, most)
        except InputError:
            return None

    def _items(self, model: TaskModel, candidates: tuple[Candidate, ...]) -> list[Item]:
        """Return the starts of a short plan: postures of grasps, then others."""
        postures = starts_near(self._database, model, STARTS, self._seed)
        return items_of(model, np.array([*self._led, *postures]).reshape(-1, model.robot.posture_size), candidates)

    def _candidates(self, model: TaskModel, most: int) -> tuple[Candidate, ...]:
        """Return the pairs that are proposed to the starts of a task; none if it desires some points.

        Raises:
            TaskError: there are none.
        """
        if model.task.desired_contacts is not None:
            return ()
        key = _proposed_for(model)
        if key not in self._proposed:
            self._proposed[key] = None
            self._proposed[key] = Proposals(model, self._seed, PairTrials(model).held)
        known = self._proposed[key]
        if known is None:
            raise TaskError("no contacts can be proposed", key=f"objects.{model.task.object}.shape")
        return known.here(model, most)


def _promising(solver: LocalSolver, model: TaskModel, item: Item, options: SolverOptions) -> bool:
    """Whether a start can be brought to hold the object with nothing in the way, whatever the forces."""
    none = tuple(range(len(model.robot.pads)))
    first = solver.problem(none, item.proposed[0].desired if item.proposed else None)
    centers = 0.5 * (first.lower + first.upper)[model.robot.posture_size :]
    start = first.state(np.clip(np.concatenate([item.posture, centers]), first.lower, first.upper))
    if any(pair.holds for pair in item.proposed):
        return next(held_guesses(solver.problem, start, item.proposed), None) is not None
    desired = item.proposed[0].desired if item.proposed else None
    problem = solver.problem(nearest_assignment(model, start, desired), desired)
    guess = next(initial_guesses(problem, start.x, options.projection))
    return float(np.linalg.norm(problem.projection_residual(guess, 0.0, 1.0).values)) <= NEAR


def _proposed_for(model: TaskModel) -> str:
    """Return what proposals depend on: the object, but for its pose, and the task, but for its load and walls."""
    body, task = (data.model_dump(mode="json") for data in (model.scene.objects[model.task.object], model.task))
    del body["pose"], body["mass"], task["wrench"], task["margin"]["enclosure"]
    return json.dumps([body, task], sort_keys=True)
