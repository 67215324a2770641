"""Benchmark of a warm session: time to the first verified grasp of an object that stands anywhere in the box.

    python tools/benchmark_session.py [--poses 100] [--seed 0]

moves the sphere and the can of the glovebox to random poses and prints, for each, median and 95th percentile of the
time to the first verified grasp on one core, and of what is neither solving nor checking. Poses where the object does
not fit between the walls, or no grasp is found within a second, are counted. Then it prints the time until the first
start is solved of what is new in a process that has planned before: a scene, a task, an object moved.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

import pinograsp
from pinograsp.descriptions import Scene
from pinograsp.descriptions.pose import Pose
from pinograsp.planning import attempt as attempts

TASKS = (("glovebox", "sphere", "sphere"), ("glovebox_can", "can", "can"))
"""Scene, task, object."""
DEADLINE = 1.0
REPEATS = 9
ROOM = 0.06
"""Between object centres and walls, m."""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--robot", default="gen3_2f85")
    arguments = parser.parse_args()
    robot = pinograsp.load_robot(arguments.robot)
    for scene, task, name in TASKS:
        report(robot, scene, task, name, arguments.poses, arguments.seed)
    beginning_times(robot)


def report(robot: pinograsp.Robot, scene_name: str, task: str, name: str, count: int, seed: int) -> None:
    """Print the figures of one task."""
    scene = pinograsp.load_scene(scene_name)
    began = time.perf_counter()
    with pinograsp.Planner(robot, scene, workers=1) as planner:
        first = next(planner.grasps(task), None)
        print(f"{task}: first grasp of a cold session after {time.perf_counter() - began:.2f} s ({first is not None})")
        moves, firsts, overheads, missed = [], [], [], 0
        for pose in poses(scene, name, count, seed):
            spent.clear()
            began = time.perf_counter()
            planner.move(name, pose)
            moved = time.perf_counter()
            try:
                grasp = next(planner.grasps(task, most=1, deadline=DEADLINE), None)
            except pinograsp.InputError:
                missed += 1
                continue
            ended = time.perf_counter()
            moves.append(moved - began)
            overheads.append(ended - began - sum(spent))
            if grasp is None:
                missed += 1
            else:
                firsts.append(ended - began)
    for what, values in (
        ("move", moves),
        ("first verified grasp", firsts),
        ("besides solving and checking", overheads),
    ):
        low, middle, high = (1e3 * float(np.quantile(values, q)) for q in (0.5, 0.95, 1.0))
        print(f"  {what:30} median {low:6.1f} ms, 95 % {middle:6.1f} ms, most {high:6.1f} ms")
    print(f"  {len(firsts)} of {count} poses; no grasp within {DEADLINE:g} s in {missed}", flush=True)


def beginning_times(robot: pinograsp.Robot) -> None:
    """Print how long it takes to the first start, median of `REPEATS`, where something is new."""
    first, second = (pinograsp.load_scene(scene) for scene in ("glovebox", "glovebox_can"))
    shifts = iter(np.linspace(0.001, 0.02, 2 * REPEATS * len(CALLS)))

    def shifted(scene: Scene, body: str) -> Pose:
        T = scene.objects[body].pose.matrix.copy()
        T[0, 3] += next(shifts)
        return Pose.of(T)

    def new_scene(call: Call) -> None:
        with pinograsp.Planner(robot, second.with_object_pose("can", shifted(second, "can")), workers=1) as planner:
            call(planner, "can")

    def new_task(call: Call) -> None:
        with pinograsp.Planner(robot, second, workers=1) as planner:
            call(planner, "can")
            anew()
            call(planner, "can_region")

    for name, call in CALLS.items():
        with pinograsp.Planner(robot, first, workers=1) as warm:
            call(warm, "sphere")

            def moved(call: Call, planner: pinograsp.Planner = warm) -> None:
                planner.move("sphere", shifted(first, "sphere"))
                call(planner, "sphere")

            for what, change in (("a new scene", new_scene), ("another task", new_task), ("an object moved", moved)):
                values = [until_first_start(change, call) for _ in range(REPEATS)]
                print(f"{name}, {what}: first start after {1e3 * float(np.median(values)):.1f} ms", flush=True)


Call = Callable[[pinograsp.Planner, str], object]
CALLS: dict[str, Call] = {
    "grasps": lambda planner, task: next(planner.grasps(task, most=1)),
    "plan": lambda planner, task: planner.plan(task, starts=1),
}


def until_first_start(change: Callable[[Call], None], call: Call) -> float:
    """Return the time from the beginning of a change, or of its last part, to its first start, s."""
    anew()
    change(call)
    return first_start[0] - began[0]


def anew() -> None:
    """Begin to measure."""
    first_start.clear()
    began[:] = [time.perf_counter()]


def poses(scene: Scene, name: str, count: int, seed: int) -> list[Pose]:
    """Return random poses of an object within the enclosure."""
    rng = np.random.default_rng(seed)
    low, high = np.array(scene.enclosure.min) + ROOM, np.array(scene.enclosure.max) - ROOM
    found = []
    for _ in range(count):
        rpy = rng.uniform(-np.pi, np.pi, 3)
        found.append(Pose(position=tuple(rng.uniform(low, high).tolist()), rpy=tuple(rpy.tolist())))
    return found


spent: list[float] = []
"""Seconds of every start that was solved and checked."""
first_start: list[float] = []
"""When starts were begun."""
began: list[float] = []
"""When what is measured was begun."""


def timed(*arguments: object, real=attempts.attempt) -> attempts.Attempt:
    """Solve and check a start, and keep its time."""
    start = time.perf_counter()
    first_start.append(start)
    done = real(*arguments)
    spent.append(time.perf_counter() - start)
    return done


if __name__ == "__main__":
    from pinograsp.planning import session

    session.attempt = timed
    attempts.attempt = timed
    main()
