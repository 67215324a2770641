"""A planner that stays warm: one robot in one scene, many tasks, objects that move."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Self

import numpy as np

from ..arrays import Rows
from ..collision.solids import link_bodies
from ..compiled import compiling
from ..database.query import nearest_wrist
from ..database.store import Database
from ..descriptions import Scene
from ..descriptions.pose import Pose
from ..errors import InputError, real_number, require_kind, require_report, whole_number
from ..execution import GivenExecutor, Workers, own_workers
from ..interrupts import heard, taken
from ..kinematics.robot import Robot
from ..problem import GraspProblem, TaskModel, check_placement, check_task
from ..problem.proposals import Candidate, ContactPair, Proposals, desired_points, proposal
from ..progress import Report, no_report
from ..results import Grasp, Result, Setup
from ..results.configuration_check import ConfigurationCheck
from ..results.explanation import Explanation
from ..solve.local import LocalSolver
from ..solve.options import SolverOptions
from ..solve.pair_trials import PairTrials
from ..solve.start_index import HeldHand
from ..solve.starts import starts_near
from .attempt import (
    Attempt,
    Item,
    attempt,
    attempts_of,
    items_of,
    lost_attempt,
    opened,
    require_consistent,
    verifier_of,
)
from .bound import least_U
from .databases import Databases
from .defaults import DEFAULT_STARTS, EXPLAIN_SECONDS, EXPLAINED, PROPOSED
from .grading import all_graded, graded
from .meshes import prepare_meshes
from .misses import explanation_of
from .outcomes import Run, facts_of
from .own_configuration import Configuration, checked
from .why import explained

NEAREST = 400
"""Starts that a search for single grasps tries at most."""
QUICK = 30
"""Evaluations that it spends on a start at most: where one fails, the next start is better than a second try."""
AT_THE_BOUND = 1e-3
"""A U within this part of its lower bound cannot be bettered by more than that."""


@dataclass(frozen=True)
class _Limits:
    """Where a search for single grasps ends."""

    most: int | None
    """Number of grasps."""
    end: float
    """On the clock `time.perf_counter`, s."""

    @classmethod
    def of(cls, most: int | None, deadline: float | None) -> _Limits:
        """Return limits from now on.

        Raises:
            InputError: a number is out of range.
        """
        most = None if most is None else whole_number("most", most, 1)
        seconds = math.inf if deadline is None else real_number("deadline", deadline, 0.0)
        return cls(most, time.perf_counter() + seconds)


class Planner:
    """Plans grasps of one robot in one scene; models, database, verifier and workers stay warm. A context manager.

    Args:
        robot: from `load_robot`; it is mounted where the scene says.
        scene: from `load_scene`.
        database: where the starts come from; None: a small one in the user's cache folder, built on first use.
        workers: number of processes for `plan`; None: one for each core. They are begun at the first plan.
        executor: takes their place: any `concurrent.futures.Executor` of processes, such as Dask's
            `client.get_executor()`. It is not shut down.
        options: how each start is solved.
        progress: called as the work goes on, in this process: once on a machine the `meshes` of the scene, `convex
            pieces` of the robot's meshes, `compiling`, and `start database` with its `sorting`; then `starts` and the
            `resistance` of the grasps. What it raises ends the plan; KeyboardInterrupt does so with what was found
            until then.

    Raises:
        InputError: an argument is of another class, a number is out of range, or workers and executor are both given.
    """

    def __init__(
        self,
        robot: Robot,
        scene: Scene,
        *,
        database: Database | Path | str | None = None,
        workers: int | None = None,
        executor: Executor | None = None,
        options: SolverOptions | None = None,
        progress: Report = no_report,
    ) -> None:
        require_kind("robot", robot, Robot, remedy="Make it with `load_robot`")
        require_kind("scene", scene, Scene, remedy="Make it with `load_scene`, or in Python")
        if options is not None:
            require_kind("options", options, SolverOptions, remedy="Give SolverOptions(...)")
        if database is not None:
            require_kind("database", database, Database, Path, str)
        require_report(progress)
        if executor is not None and not isinstance(executor, Executor):
            raise InputError("is no concurrent.futures.Executor", key="executor")
        if executor is not None and workers is not None:
            raise InputError("is given with an executor", key="workers", remedy="Give one of them")
        self._robot, self._scene = robot, scene
        self._options = options or SolverOptions()
        self._report = progress
        self._databases = Databases(robot, database, workers, progress)
        self._workers: Workers = own_workers(workers) if executor is None else GivenExecutor(executor)
        self._models: dict[str, TaskModel] = {}
        self._hands: dict[str, HeldHand] = {}
        self._bounds: dict[str, float] = {}
        self._proposed: dict[tuple[str, int], Proposals] = {}

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self._robot

    @property
    def scene(self) -> Scene:
        """The scene as it is now: objects may have been moved."""
        return self._scene

    def __enter__(self) -> Self:
        """Return the planner; its workers end with the block."""
        return self

    def __exit__(self, *error: object) -> None:
        """End the workers and close what was opened."""
        self._workers.__exit__(*error)
        self._databases.close()

    def plan(
        self,
        task: str,
        *,
        starts: int = DEFAULT_STARTS,
        seed: int = 0,
    ) -> Result:
        """Find, verify and rank grasps.

        The same seed gives the same grasps for any number of workers. Ctrl-C ends the search and returns what was
        found until then.

        Args:
            task: name of a task of the scene.
            starts: number of starts; by default 1304, as in the paper.
            seed: of the choice of starts.

        Raises:
            InputError: the task does not exist or makes no sense for this robot and scene, the database belongs to
                another robot, enclosure or margin, or a number is out of range.
        """
        starts, seed = whole_number("starts", starts, 1), whole_number("seed", seed, 0, None)
        began = time.perf_counter()
        with heard():
            model, odd = self._checked(task)
            candidates = self._candidates(model, seed)
            run = Run(self._setup(task), self._robot.files, starts, odd)
            run.facts = {"seed": seed, "options": self._options.to_json()}
            self._evaluate_once(model, candidates)
        run.times["prepare"] = time.perf_counter() - began
        try:
            with heard():
                self._workers.begin()
                database = self._databases.of(self._scene, model.task.margin)
                run.times["database"] = time.perf_counter() - began - run.times["prepare"]
                postures = starts_near(database, model, starts, seed)
            run.facts["database"] = facts_of(database)
            nearest = nearest_wrist(database, model.load.center_of_mass)
            run.count_starts(len(postures), model.task.start_radius, nearest)
            run.times["starts"] = time.perf_counter() - began - sum(run.times.values())
            solver_of = partial(LocalSolver, options=self._options)
            prepare = partial(attempts_of, model, solver_of)
            items = items_of(model, postures, candidates)
            with closing(self._workers.run(prepare, items, lost=lost_attempt)) as running:
                for done in running:
                    run.add(done)
                    self._report(run.progress(len(postures)))
        except KeyboardInterrupt:
            taken()
            run.interrupted = True
        searched = time.perf_counter()
        grasps, whole = all_graded(run.distinct(), model, self._workers, self._report)
        run.interrupted |= not whole
        run.count_graded(grasps)
        run.times |= {"resistance": time.perf_counter() - searched, "total": time.perf_counter() - began}
        return run.result(grasps, self._explained(model, run))

    def grasps(self, task: str, *, most: int | None = None, deadline: float | None = None) -> Iterator[Grasp]:
        """Yield verified grasps as they come, in this process, from the starts whose hand is nearest to the object.

        It ends after `most` grasps; at the deadline, after which no start begins; where a grasp's U is within 0.1 % of
        its proven lower bound; or when the nearest starts are used up.

        Args:
            task: name of a task of the scene.
            most: number of grasps.
            deadline: seconds from the first call of `next`.

        Raises:
            InputError: as `plan`; at the first call of `next`.
        """
        limits = _Limits.of(most, deadline)
        model, _ = self._checked(task)
        for done in self._tried(model, self._nearest(model), limits):
            if done.grasp is not None:
                yield done.grasp

    def first(self, task: str, *, most: int | None = None, deadline: float | None = None) -> Result:
        """Return as a result what `grasps` yields, with what became of the starts without a grasp.

        Near-identical grasps are one. Ctrl-C ends the search and returns what was found until then.

        Args:
            task: name of a task of the scene.
            most: number of grasps, near-identical ones counted.
            deadline: seconds from the call.

        Raises:
            InputError: as `plan`.
        """
        began, limits = time.perf_counter(), _Limits.of(most, deadline)
        with heard():
            model, odd = self._checked(task)
        run = Run(self._setup(task), self._robot.files, NEAREST, odd)
        run.facts = {"most": most, "deadline": deadline, "options": self._quick.to_json()}
        try:
            with heard():
                items = self._nearest(model)
            run.facts["database"] = facts_of(self._databases.of(self._scene, model.task.margin))
            run.starts = len(items)
            run.times["prepare"] = time.perf_counter() - began
            for done in self._tried(model, items, limits):
                run.add(done)
                self._report(run.progress(len(items)))
            run.count_tried(deadline)
        except KeyboardInterrupt:
            taken()
            run.interrupted = True
        run.times["total"] = time.perf_counter() - began
        return run.result(run.distinct(), self._explained(model, run))

    def explain(
        self, task: str, *, starts: int = EXPLAINED, seed: int = 0, deadline: float = EXPLAIN_SECONDS
    ) -> Explanation:
        """Return why a task finds no grasp, and the least changes that make it work.

        Each remedy was found by short plans and verified by a longer one with another seed. Ctrl-C and the deadline
        end the search for them, and keep those that were found until then.

        Args:
            task: name of a task of the scene.
            starts: of the plan that is explained.
            seed: of the choice of starts.
            deadline: time for remedies, s.

        Raises:
            InputError: as `plan`; but a task that is refused because it cannot work is explained.
        """
        deadline = real_number("deadline", deadline, 0.0)
        return explained(
            self._robot,
            self._scene,
            task,
            lambda: self.plan(task, starts=starts, seed=seed),
            lambda: self._databases.widest(self._scene, self._scene.task(task).margin),
            options=self._options,
            seed=seed,
            deadline=deadline,
            report=self._report,
        )

    def move(self, name: str, pose: Pose | Rows) -> None:
        """Put an object of the scene at another pose; nothing is rebuilt.

        Args:
            name: of the object.
            pose: of the object in the world, m; as an array: homogeneous, shape (4, 4).

        Raises:
            InputError: there is no such object, or the array is no pose.
        """
        there = pose if isinstance(pose, Pose) else Pose.of(pose)
        self._scene = self._scene.with_object_pose(name, there)
        self._models = {task: model.moved(name, self._scene) for task, model in self._models.items()}

    def check(self, task: str, joints: Configuration) -> ConfigurationCheck:
        """Check a configuration of the user's own: certificate figures, clearances by pair, and a grasp to draw.

        Args:
            task: name of a task of the scene: its object, margins and pads count.
            joints: values by name, of every arm joint and synergy at least (those of a grasp do); or arm joints and
                synergies in the order of the robot file, shape (l + s,); rad (m).

        Raises:
            InputError: there is no such task, or a value is missing, unknown or not finite.
        """
        model = self._model(task)
        with compiling(self._report):
            return checked(model, verifier_of(model), joints)

    def contacts(self, task: str, *, seed: int = 0, most: int = PROPOSED) -> tuple[ContactPair, ...]:
        """Return pairs of opposite points of a task's object that the hand can hold where the object stands.

        A task that leaves out `desired_contacts` proposes these to its starts; of others they are what would be
        proposed. The first one is near the centre of mass, each further one as far as possible from those before it.

        Args:
            task: name of a task of the scene.
            seed: of the points that are drawn on the surface.
            most: number of pairs.

        Raises:
            InputError: there is no such task, it does not make sense in this scene, the hand has not two pads, or no
                pair suits; the message says why.
        """
        seed, most = whole_number("seed", seed, 0, None), whole_number("most", most, 1)
        model, _ = self._checked(task)
        return tuple(candidate.pair for candidate in self._proposals(model, seed).here(model, most))

    def _checked(self, task: str) -> tuple[TaskModel, tuple[str, ...]]:
        """Return the model of a task, and what is odd about it.

        Raises:
            InputError: the task does not exist, or makes no sense for this robot and scene.
        """
        prepare_meshes(self._scene, self._scene.task(task), self._report)
        check_placement(self._scene, task)  # before the convex pieces, which take long on a new machine
        model = self._model(task)
        return model, tuple(check_task(model))

    def _explained(self, model: TaskModel, run: Run) -> Explanation | None:
        """Return why a run found no grasp, if it tried some starts and found none."""
        if run.verified or not run.attempts:
            return None
        return explanation_of(model, verifier_of(model), run.attempts)

    def _setup(self, task: str) -> Setup:
        return Setup(self._robot.description, self._scene, task)

    def _candidates(self, model: TaskModel, seed: int) -> tuple[Candidate, ...]:
        """Return the pairs that are proposed to the starts of a task; none if it desires some points."""
        if model.task.desired_contacts is not None:
            return ()
        return self._proposals(model, seed).here(model, PROPOSED)

    def _proposals(self, model: TaskModel, seed: int) -> Proposals:
        key = model.task_name, seed
        if key not in self._proposed:  # they do not depend on where objects stand
            self._proposed[key] = Proposals(model, seed, PairTrials(model).held)
        return self._proposed[key]

    def _nearest(self, model: TaskModel) -> list[Item]:
        """Return the starts whose hand is nearest to the object, the most promising first."""
        task, candidates = model.task_name, self._candidates(model, 0)
        if task not in self._hands:  # neither depends on where objects stand
            self._evaluate_once(model, candidates)
            self._hands[task], self._bounds[task] = HeldHand(model), least_U(model)
        hand, index = self._hands[task], self._databases.index(self._scene, model.task.margin)
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

    def _tried(self, model: TaskModel, items: Sequence[Item], limits: _Limits) -> Iterator[Attempt]:
        """Yield what becomes of one start after the other, within limits; grasps have all their figures."""
        with heard():
            solver, verifier = LocalSolver(model, self._quick), verifier_of(model)
        setup = self._setup(model.task_name)
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

    @property
    def _quick(self) -> SolverOptions:
        """How a start is solved where the next one is better than a second try."""
        return replace(self._options, max_evaluations=min(QUICK, self._options.budget), tries=1)

    def _model(self, task: str) -> TaskModel:
        self._scene.task(task)  # refuses what is no name before it is looked up
        if task not in self._models:
            require_consistent(self._robot.unmounted)
            link_bodies(self._robot, self._report)
            self._models[task] = TaskModel(self._robot, self._scene, task)
        return self._models[task]

    def _evaluate_once(self, model: TaskModel, candidates: Sequence[Candidate]) -> None:
        """Have everything compiled that evaluations need, here and once, not in every worker."""
        desired = desired_points(candidates[0].pair, model) if candidates else None
        with compiling(self._report):
            problem = GraspProblem(model, tuple(range(len(model.robot.pads))), desired=desired)
            problem.evaluate(0.5 * (problem.lower + problem.upper))
