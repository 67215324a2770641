"""A planner that stays warm: one robot in one scene, many tasks, objects that move."""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Self

from ..arrays import Rows
from ..compiled import compiling
from ..database.query import nearest_wrist
from ..database.store import Database
from ..descriptions import Scene
from ..descriptions.pose import Pose
from ..errors import InputError, real_number, require_kind, require_report, whole_number
from ..execution import GivenExecutor, Workers, own_workers
from ..interrupts import heard, taken, undisguised
from ..kinematics.robot import Robot
from ..problem.contact_pairs import ContactPairs
from ..progress import OnceTold, Report
from ..results import Grasp, Result, Setup
from ..results.configuration_check import ConfigurationCheck
from ..results.explanation import Explanation
from ..solve.local import LocalSolver
from ..solve.options import SolverOptions
from ..solve.starts import starts_near
from .attempt import attempts_of, items_of, lost_attempt, verifier_of
from .databases import Databases
from .defaults import DEFAULT_STARTS, EXPLAIN_SECONDS, EXPLAINED, PROPOSED
from .grading import all_graded
from .misses import explanation_of
from .outcomes import Run, facts_of
from .own_configuration import Configuration, checked
from .single_grasps import NEAREST, Limits, SingleGrasps
from .task_models import TaskModels
from .why import explained


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
            until then. None: of what is made once and takes long a line on standard error says so.

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
        progress: Report | None = None,
    ) -> None:
        require_kind("robot", robot, Robot, remedy="Make it with `load_robot`")
        require_kind("scene", scene, Scene, remedy="Make it with `load_scene`, or in Python")
        if options is not None:
            require_kind("options", options, SolverOptions, remedy="Give SolverOptions(...)")
        if database is not None:
            require_kind("database", database, Database, Path, str)
        progress = OnceTold() if progress is None else progress
        require_report(progress)
        if executor is not None and not isinstance(executor, Executor):
            raise InputError("is no concurrent.futures.Executor", key="executor")
        if executor is not None and workers is not None:
            raise InputError("is given with an executor", key="workers", remedy="Give one of them")
        self._robot = robot
        self._options = options or SolverOptions()
        self._report = progress
        self._databases = Databases(robot, database, workers, progress)
        self._workers: Workers = own_workers(workers) if executor is None else GivenExecutor(executor)
        self._models = TaskModels(robot, scene, progress)
        self._singles = SingleGrasps(self._models, self._databases, self._options)

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self._robot

    @property
    def scene(self) -> Scene:
        """The scene as it is now: objects may have been moved."""
        return self._models.scene

    def __enter__(self) -> Self:
        """Return the planner; its workers end with the block."""
        return self

    def __exit__(self, *error: object) -> None:
        """End the workers and close what was opened."""
        self._workers.__exit__(*error)
        self._databases.close()

    def plan(self, task: str, *, starts: int = DEFAULT_STARTS, seed: int = 0) -> Result:
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
            model, odd = self._models.checked(task)
            candidates = self._models.candidates(model, seed)
            run = Run(self._setup(task), self._robot.files, starts, odd)
            run.facts = {"seed": seed, "options": self._options.to_json()}
            self._models.evaluate_once(model, candidates)
        run.times["prepare"] = time.perf_counter() - began
        try:
            with heard():
                self._workers.begin()
                database = self._databases.of(self.scene, model.task.margin)
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
        return run.result(grasps, explanation_of(model, run.attempts))

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
        limits = Limits.of(most, deadline)
        with undisguised():
            model, _ = self._models.checked(task)
            items = self._singles.nearest(model)
        for done in self._singles.tried(model, items, limits, self._setup(task)):
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
        began, limits = time.perf_counter(), Limits.of(most, deadline)
        with heard():
            model, odd = self._models.checked(task)
        run = Run(self._setup(task), self._robot.files, NEAREST, odd)
        run.facts = {"most": most, "deadline": deadline, "options": self._singles.options.to_json()}
        try:
            with heard():
                items = self._singles.nearest(model)
            run.facts["database"] = facts_of(self._databases.of(self.scene, model.task.margin))
            run.starts = len(items)
            run.times["prepare"] = time.perf_counter() - began
            for done in self._singles.tried(model, items, limits, run.setup):
                run.add(done)
                self._report(run.progress(len(items)))
            run.count_tried(deadline)
        except KeyboardInterrupt:
            taken()
            run.interrupted = True
        run.times["total"] = time.perf_counter() - began
        return run.result(run.distinct(), explanation_of(model, run.attempts))

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
            self.scene,
            task,
            lambda: self.plan(task, starts=starts, seed=seed),
            lambda: self._databases.widest(self.scene, self.scene.task(task).margin),
            lambda: self._models.proposed(task, seed),
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
        self._models.move(name, pose)

    def check(self, task: str, joints: Configuration) -> ConfigurationCheck:
        """Check a configuration of the user's own: certificate figures, clearances by pair, and a grasp to draw.

        Args:
            task: name of a task of the scene: its object, margins and pads count.
            joints: values by name, of every arm joint and synergy at least (those of a grasp do); or arm joints and
                synergies in the order of the robot file, shape (l + s,); rad (m).

        Raises:
            InputError: there is no such task, or a value is missing, unknown or not finite.
        """
        with undisguised(), compiling(self._report):
            model = self._models.model(task)
            return checked(model, verifier_of(model), joints)

    def contacts(self, task: str, *, seed: int = 0, most: int = PROPOSED) -> ContactPairs:
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
        with undisguised():
            model, odd = self._models.checked(task)
            proposals = self._models.proposals(model, seed)
            return ContactPairs((found.pair for found in proposals.here(model, most)), proposals.remarks, odd)

    def _setup(self, task: str) -> Setup:
        return Setup(self._robot.description, self.scene, task)
