"""Benchmark of the convex pieces that stand for collision meshes: how close they are, and what they cost.

    python tools/benchmark_covers.py [robot] [--scene glovebox] [--task sphere] [--starts 150] [--pieces N]

prints, link by link, the excess of the single convex hull and of the pieces: distances to the mesh of points spread
evenly over the outer boundary of the union of the pieces. Then, each with the pieces and with single hulls in turn,
the time of distances and of whole evaluations at start postures near the object and at what a solve makes of them,
and of the tests of a database; the ratios are what to compare.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import pinograsp
from pinograsp.arrays import Array
from pinograsp.collision.batch_clearance import BatchClearance
from pinograsp.collision.scene_world import enclosure_world
from pinograsp.database.cache import cached_database
from pinograsp.descriptions import Scene
from pinograsp.descriptions.robot import CollisionDescription
from pinograsp.descriptions.task import Margins
from pinograsp.geometry.cover_cache import mesh_cover
from pinograsp.geometry.mesh_file import read_triangles
from pinograsp.kinematics.collision_elements import CollisionElement, collision_elements
from pinograsp.kinematics.forward import forward
from pinograsp.kinematics.hand_posture import hand_opening
from pinograsp.kinematics.robot import Robot
from pinograsp.onboarding.excess import excess
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.solve.local import LocalSolver
from pinograsp.solve.options import SolverOptions
from pinograsp.solve.starts import starts_near

SAMPLES = 4000


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", nargs="?", default="gen3_2f85")
    parser.add_argument("--scene", default="glovebox")
    parser.add_argument("--task", default="sphere")
    parser.add_argument("--starts", type=int, default=150)
    parser.add_argument("--pieces", type=int, help="for all links, instead of what the robot file says")
    arguments = parser.parse_args()
    robot, scene = pinograsp.load_robot(arguments.robot), pinograsp.load_scene(arguments.scene)
    if arguments.pieces is not None:
        robot = with_collision(robot, CollisionDescription(pieces=arguments.pieces))
    began = time.perf_counter()
    figures(robot)
    print(f"{time.perf_counter() - began:.1f} s for these figures, with making the pieces if they were not cached")
    costs(robot, scene, arguments.task, arguments.starts)


def with_collision(robot: Robot, collision: CollisionDescription) -> Robot:
    """Return the robot with other pieces."""
    return Robot(robot.description.model_copy(update={"collision": collision}))


def figures(robot: Robot) -> None:
    """Print the excess, mesh by mesh."""
    print(f"{robot.description.name}: excess in mm (95th percentile, largest, mean), pieces and vertices")
    print(f"  {'link':38} {'single hull':>19} {'vertices':>9}   {'pieces':>19} {'number':>7} {'vertices':>9}")
    total: dict[str, list[Array]] = {"hull": [], "cover": []}
    for element in collision_elements(robot):
        if element.mesh is None:
            continue
        hull, cover = (covered(element, limits) for limits in ((1, 1.0), robot.description.collision.of(element.link)))
        triangles = read_triangles(element.mesh, element.size)
        total["hull"].append(of_hull := excess(hull, triangles, SAMPLES))
        total["cover"].append(of_cover := excess(cover, triangles, SAMPLES))
        counts = [sum(map(len, pieces)) for pieces in (hull, cover)]
        print(
            f"  {element.link:38} {in_words(of_hull):>19} {counts[0]:9}   "
            f"{in_words(of_cover):>19} {len(cover):7} {counts[1]:9}"
        )
    for name, distances in total.items():
        worst = max(float(np.percentile(d, 95)) for d in distances)
        print(f"  largest 95th percentile of a {name}: {1e3 * worst:.1f} mm")


def covered(element: CollisionElement, limits: tuple[int, float]) -> tuple[Array, ...]:
    """Return the pieces of a mesh for a number and a tolerance, m."""
    assert element.mesh is not None
    return mesh_cover(element.mesh, element.size, *limits)


def in_words(distances: Array) -> str:
    """Return 95th percentile, maximum and mean, mm."""
    return " ".join(f"{1e3 * v:6.2f}" for v in (np.percentile(distances, 95), distances.max(), distances.mean()))


def costs(robot: Robot, scene: Scene, task: str, count: int) -> None:
    """Print what distances, evaluations and the tests of a database cost, pieces against single hulls."""
    models = {
        "hulls": TaskModel(with_collision(robot, CollisionDescription(pieces=1)), scene, task),
        "pieces": TaskModel(robot, scene, task),
    }
    began = time.perf_counter()
    pieces = TaskModel(robot, scene, task)
    print(f"a model with cached pieces: {time.perf_counter() - began:.2f} s; {len(pieces.collisions.pairs)} pairs")
    with cached_database(robot, scene, pieces.task.margin) as database:
        starts = starts_near(database, pieces, count, seed=0)
    problems = {name: GraspProblem(model, tuple(range(len(model.robot.pads)))) for name, model in models.items()}
    middle = pieces.robot.parameter_limits.mean(axis=1)
    solver = LocalSolver(pieces, SolverOptions())
    places = {
        "starts": [np.concatenate([start, middle]) for start in starts],
        "solutions": [solver.solve(index, start).x for index, start in enumerate(starts[: count // 3])],
    }
    size, data = robot.posture_size, pieces.robot.model.createData()
    for name, points in places.items():
        configurations = [forward(pieces.robot, data, x[:size]) for x in points]
        compare(f"distances at {name}", {n: over(m.collisions.distances, configurations) for n, m in models.items()})
        compare(f"evaluations at {name}", {n: over(p.evaluate, points) for n, p in problems.items()})
    rng, size = np.random.default_rng(0), robot.arm_size
    q = rng.uniform(np.maximum(robot.lower[:size], -np.pi), np.minimum(robot.upper[:size], np.pi), (20_000, size))
    margins, opening = Margins(), hand_opening(robot)
    batches = {
        name: BatchClearance(model.robot, enclosure_world(model.robot, scene, margins), opening)
        for name, model in models.items()
    }
    compare("tests of a database", {name: over(batch.measure, [q]) for name, batch in batches.items()}, per=len(q))


def over(function: Callable[[Any], object], arguments: Sequence[Any]) -> Callable[[], int]:
    """Return a function that calls another with each argument and returns how often."""

    def call() -> int:
        for argument in arguments:
            function(argument)
        return len(arguments)

    return call


def compare(what: str, calls: dict[str, Callable[[], int]], rounds: int = 10, per: int = 1) -> None:
    """Print the time of one call of each kind, the kinds taking turns, and the ratio."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            began = time.process_time()
            number = call()
            times[name].append((time.process_time() - began) / (number * per))
    medians = {name: 1e6 * float(np.median(taken)) for name, taken in times.items()}
    print(f"  {what:26}" + "".join(f"{name} {value:8.1f} us   " for name, value in medians.items()), end="")
    print(f"ratio {medians['pieces'] / medians['hulls']:.2f}")


if __name__ == "__main__":
    main()
