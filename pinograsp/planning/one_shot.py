"""One plan, from a robot file and a scene file to verified grasps."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path

from ..database.build import BuildProgress
from ..database.store import Database
from ..descriptions import Scene
from ..kinematics.robot import Robot
from ..results import Result
from ..solve.options import SolverOptions
from .defaults import DEFAULT_STARTS
from .outcomes import Progress
from .session import Planner


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
    progress: Callable[[Progress], None] | None = None,
    build_progress: Callable[[BuildProgress], None] | None = None,
) -> Result:
    """Find, verify and rank grasps: one plan of a `Planner`, which has more for who plans again and again.

    The same seed gives the same grasps for any number of workers and on any executor. Ctrl-C ends the search and
    returns what was found until then.

    Args:
        robot: from `load_robot`; it is mounted where the scene says.
        scene: from `load_scene`.
        task: name of a task of the scene.
        starts: number of starts.
        workers: number of processes; None: one for each core.
        executor: takes their place: any `concurrent.futures.Executor` of processes.
        seed: of the choice of starts.
        database: where the starts come from; None: a small one in the user's cache folder, built on first use.
        options: how each start is solved.
        progress: called after every start.
        build_progress: called after every batch while a database is built.

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
        build_progress=build_progress,
    ) as planner:
        return planner.plan(task, starts=starts, seed=seed, progress=progress)
