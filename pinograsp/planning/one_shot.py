"""One plan, from robot file and scene file to verified grasps; one check of a configuration; one list of contacts."""

from __future__ import annotations

from concurrent.futures import Executor
from pathlib import Path

from ..database.store import Database
from ..descriptions import Scene
from ..descriptions.pose import ZERO
from ..descriptions.scene_keys import scene_keys
from ..descriptions.task import ContactConstants, Task, Wrench
from ..errors import InputError, UnknownNameError, close_names, require_kind
from ..kinematics.robot import Robot
from ..problem.contact_pairs import ContactPairs
from ..progress import Report
from ..results import Result
from ..results.configuration_check import ConfigurationCheck
from ..results.explanation import Explanation
from ..solve.options import SolverOptions
from .defaults import DEFAULT_STARTS, EXPLAIN_SECONDS, EXPLAINED, PROPOSED
from .own_configuration import Configuration
from .session import Planner

PLAIN = "contacts"
"""Name of a task about an object and nothing else."""
FRICTION = 0.5
"""Of the contacts on an object that no task is about."""


def plan(
    robot: Robot,
    scene: Scene,
    task: str,
    *,
    starts: int = DEFAULT_STARTS,
    workers: int | None = None,
    executor: Executor | None = None,
    seed: int = 0,
    database: Database | Path | str | None = None,
    options: SolverOptions | None = None,
    progress: Report | None = None,
) -> Result:
    """Find, verify and rank grasps: one plan of a `Planner`, which has more for who plans again and again.

    The same seed gives the same grasps for any number of workers and on any executor. Ctrl-C ends the search and
    returns what was found until then.

    Args:
        robot: from `load_robot`; it is mounted where the scene says.
        scene: from `load_scene`.
        task: name of a task of the scene.
        starts: number of starts; by default 1304, as in the paper.
        workers: number of processes; None: one for each core.
        executor: takes their place: any `concurrent.futures.Executor` of processes.
        seed: of the choice of starts.
        database: where the starts come from; None: a small one in the user's cache folder, built on first use.
        options: how each start is solved.
        progress: called as the work goes on, stage by stage (see `Planner`).

    Raises:
        InputError: the task does not exist or makes no sense for this robot and scene, the database belongs to
            another robot, enclosure or margin, or a number is out of range.
    """
    with Planner(
        robot,
        scene,
        database=database,
        workers=workers,
        executor=executor,
        options=options,
        progress=progress,
    ) as planner:
        return planner.plan(task, starts=starts, seed=seed)


def explain(
    robot: Robot,
    scene: Scene,
    task: str,
    *,
    starts: int = EXPLAINED,
    seed: int = 0,
    deadline: float = EXPLAIN_SECONDS,
    workers: int | None = None,
    database: Database | Path | str | None = None,
    options: SolverOptions | None = None,
    progress: Report | None = None,
) -> Explanation:
    """Return why a task finds no grasp, and the least changes that make it work: `Planner.explain`.

    Causes and the nearest miss are those of a plan. A remedy is the least change of its kind (move the object or what
    is in its way, smaller margins, a lighter load, a wider jaw, a larger region) with which a start of a short plan is
    verified; a longer plan with another seed verified it. Ctrl-C and the deadline end the search for remedies, and
    keep those that were found until then.

    Args:
        robot: from `load_robot`; it is mounted where the scene says.
        scene: from `load_scene`.
        task: name of a task of the scene.
        starts: of the plan that is explained.
        seed: of the choice of starts.
        deadline: time for remedies, s.
        workers: number of processes of the plan; None: one for each core.
        database: where the starts come from; None: a small one in the user's cache folder, built on first use.
        options: how each start is solved.
        progress: called as the work goes on, stage by stage (see `Planner`), last with the stage `remedies`.

    Raises:
        InputError: as `plan`; but a task that is refused because it cannot work is explained.
    """
    session = Planner(robot, scene, database=database, workers=workers, options=options, progress=progress)
    with session as planner:
        return planner.explain(task, starts=starts, seed=seed, deadline=deadline)


def check(robot: Robot, scene: Scene, task: str, joints: Configuration) -> ConfigurationCheck:
    """Check a configuration of the user's own: `Planner.check`, which is quicker for who checks many.

    Pads and object are taken to touch where they are nearest to it, with the best contact forces (8) there. The
    independent check then recomputes every figure; nothing of the configuration is changed.

    Args:
        robot: from `load_robot`; it is mounted where the scene says.
        scene: from `load_scene`.
        task: name of a task of the scene: its object, margins and pads count.
        joints: values by name, of every arm joint and synergy at least (the `joints` of a grasp do); or arm joints and
            synergies in the order of the robot file, shape (l + s,); rad (m).

    Returns:
        The configuration as a grasp, verified or not, with its certificate, and distances pair by pair, m.

    Raises:
        InputError: there is no such task, or a value is missing, unknown or not finite.
    """
    with Planner(robot, scene) as planner:
        return planner.check(task, joints)


def contacts(
    robot: Robot,
    scene: Scene,
    *,
    task: str | None = None,
    object: str | None = None,
    seed: int = 0,
    most: int = PROPOSED,
    progress: Report | None = None,
) -> ContactPairs:
    """Return pairs of opposite points of an object that the hand can hold where the object stands.

    A task that leaves out `desired_contacts` proposes them to its starts. `Planner.contacts` is quicker for who asks
    again and again.

    Args:
        robot: from `load_robot`; it is mounted where the scene says.
        scene: from `load_scene`.
        task: name of a task of the scene: its pads, regions, margins and approach directions count.
        object: in place of a task, the name of an object: all pads, its whole surface, the default margins.
        seed: of the points that are drawn on the surface.
        most: number of pairs.
        progress: called while convex pieces of the robot's meshes are made, once on a machine.

    Returns:
        The first pair is near the centre of mass, each further one as far as possible from those before it.

    Raises:
        InputError: not one of task and object is given, it does not exist or makes no sense in the scene, the hand has
            not two pads, or no pair suits; the message says why.
    """
    require_kind("scene", scene, Scene, remedy="Make it with `load_scene`, or in Python")
    if (task is None) == (object is None):
        raise InputError("one of both is wanted", key="task, object", remedy="Give a task, or an object")
    asked = scene
    if object is not None:
        if object not in scene.objects:
            remedy = close_names(object, scene.objects)
            problem = f"no object {object!r} in this scene"
            raise UnknownNameError(problem, file=scene.source, key="objects", remedy=remedy)
        plain = Task(object=object, wrench=Wrench(force=ZERO), contact=ContactConstants(friction=FRICTION))
        task, asked = PLAIN, scene.with_task(PLAIN, plain)
    with scene_keys(scene, scene.source), Planner(robot, asked, workers=1, progress=progress) as planner:
        return planner.contacts(str(task), seed=seed, most=most)
