"""The models of a session's tasks: made and checked once, moved with the objects of the scene."""

from __future__ import annotations

from collections.abc import Sequence

from ..arrays import Rows
from ..collision.solids import link_bodies
from ..compiled import compiling
from ..descriptions import Scene
from ..descriptions.mesh_keys import mesh_keys
from ..descriptions.pose import Pose
from ..kinematics.robot import Robot
from ..problem import GraspProblem, TaskModel, check_placement, check_task
from ..problem.contact_pairs import Candidate, desired_points
from ..problem.proposals import Proposals
from ..progress import Report
from ..solve.pair_trials import PairTrials
from .attempt import require_consistent
from .defaults import PROPOSED
from .meshes import prepare_meshes


class TaskModels:
    """What is known of the tasks of a scene before any start is solved.

    Args:
        robot: what is planned for.
        scene: with the tasks.
        report: called as meshes, convex pieces and compiled code are made, once on a machine.
    """

    def __init__(self, robot: Robot, scene: Scene, report: Report) -> None:
        self._robot, self._report = robot, report
        self.scene = scene
        """As it is now: objects may have been moved."""
        self._models: dict[str, TaskModel] = {}
        self._proposed: dict[tuple[str, int], Proposals] = {}

    def move(self, name: str, pose: Pose | Rows) -> None:
        """Put an object at another pose in the world, m; as an array: homogeneous, shape (4, 4).

        Raises:
            InputError: there is no such object, or the array is no pose.
        """
        there = pose if isinstance(pose, Pose) else Pose.of(pose)
        self.scene = self.scene.with_object_pose(name, there)
        self._models = {task: model.moved(name, self.scene) for task, model in self._models.items()}

    def model(self, task: str) -> TaskModel:
        """Return the model of a task.

        Raises:
            InputError: there is no such task, or a file of the robot has changed.
        """
        self.scene.task(task)  # refuses what is no name before it is looked up
        if task not in self._models:
            require_consistent(self._robot.unmounted)
            link_bodies(self._robot, self._report)
            with mesh_keys(self.scene):
                self._models[task] = TaskModel(self._robot, self.scene, task)
        return self._models[task]

    def checked(self, task: str) -> tuple[TaskModel, tuple[str, ...]]:
        """Return the model of a task, and what is odd about it.

        Raises:
            InputError: the task does not exist, or makes no sense for this robot and scene.
        """
        with mesh_keys(self.scene):
            prepare_meshes(self.scene, self.scene.task(task), self._report)
            check_placement(self.scene, task)  # before the convex pieces, which take long on a new machine
            model = self.model(task)
            return model, tuple(check_task(model))

    def proposals(self, model: TaskModel, seed: int) -> Proposals:
        """Return the pairs of contacts that are proposed for a task, drawn with a seed.

        Raises:
            TaskError: there are none.
        """
        key = model.task_name, seed
        if key not in self._proposed:  # they do not depend on where objects stand
            self._proposed[key] = Proposals(model, seed, PairTrials(model).held)
        return self._proposed[key]

    def proposed(self, task: str, seed: int) -> tuple[TaskModel, Proposals] | None:
        """Return the model of a task and what was proposed for it with a seed, if anything was until now."""
        known = self._proposed.get((task, seed))
        return None if known is None else (self._models[task], known)

    def candidates(self, model: TaskModel, seed: int) -> tuple[Candidate, ...]:
        """Return the pairs that are proposed to the starts of a task; none if it desires some points.

        Raises:
            TaskError: there are none.
        """
        if model.task.desired_contacts is not None:
            return ()
        return self.proposals(model, seed).here(model, PROPOSED)

    def evaluate_once(self, model: TaskModel, candidates: Sequence[Candidate]) -> None:
        """Have everything compiled that evaluations need, here and once, not in every worker."""
        desired = desired_points(candidates[0].pair, model) if candidates else None
        with compiling(self._report):
            problem = GraspProblem(model, tuple(range(len(model.robot.pads))), desired=desired)
            problem.evaluate(0.5 * (problem.lower + problem.upper))
