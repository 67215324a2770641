"""Benchmark of clutter: what obstacles cost that the robot stays away from.

    python tools/benchmark_clutter.py [--obstacles 200] [--starts 20] [--rows 20000]

prints a Markdown table for the Gen3 and 2F-85 in the glovebox: CPU time of one evaluation of the problem, of a start
(median), of the certificate of a grasp, of a random row of the start database, of a model and of a verifier, without
obstacles and with boxes, balls and compounds that lie along the walls; and the ratio. Both scenes take turns.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import pinograsp
from pinograsp import Body, Box, Capsule, Compound, Cylinder, Part, Pose, Scene, Sphere
from pinograsp.collision.batch_clearance import BatchClearance
from pinograsp.collision.scene_world import enclosure_world
from pinograsp.kinematics.hand_posture import hand_opening
from pinograsp.problem import TaskModel
from pinograsp.solve.local import LocalSolver, Solution
from pinograsp.solve.options import SolverOptions
from pinograsp.verification.check import Verifier

AWAY = 0.22
"""Least distance of an obstacle from the object, and from the robot's base, m."""
ALONG = 0.08
"""Depth of the layer along the walls in which obstacles lie, m."""
TURNS = 3
PILL = Compound(
    parts=(
        Part(shape=Cylinder(radius=0.015, height=0.03)),
        Part(shape=Sphere(radius=0.018), pose=Pose(position=(0.0, 0.0, 0.02))),
        Part(shape=Capsule(radius=0.006, length=0.03), pose=Pose(position=(0.02, 0.0, 0.0), rpy=(0.5, 0.0, 0.0))),
    )
)


def cluttered(scene: Scene, count: int, seed: int = 0) -> Scene:
    """Return the scene with so many obstacles along its walls."""
    rng = np.random.default_rng(seed)
    low, high = np.array(scene.enclosure.min), np.array(scene.enclosure.max)
    kept_free = [np.array(body.pose.position) for body in scene.objects.values()]
    kept_free.append(np.array(scene.mounting.position))
    obstacles: dict[str, Body] = {}
    while len(obstacles) < count:
        place = rng.uniform(low + 0.02, high - 0.02)
        to_wall = min((place - low).min(), (high - place).min())
        if to_wall > ALONG or min(float(np.linalg.norm(place - at)) for at in kept_free) < AWAY:
            continue
        shapes = (Box(size=tuple(rng.uniform(0.015, 0.04, 3).tolist())), Sphere(radius=rng.uniform(0.01, 0.02)), PILL)
        pose = Pose(position=tuple(place.tolist()), rpy=tuple(rng.uniform(-math.pi, math.pi, 3).tolist()))
        obstacles[f"thing {len(obstacles)}"] = Body(shape=shapes[len(obstacles) % 3], pose=pose)
    return scene.model_copy(update={"obstacles": obstacles})


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--obstacles", type=int, default=200)
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--rows", type=int, default=20_000)
    arguments = parser.parse_args()
    robot, empty = pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox")
    empty = empty.without_task("near_wall") if "near_wall" in empty.tasks else empty
    scenes = {"none": empty, "obstacles": cluttered(empty, arguments.obstacles)}
    found = {name: Measured(robot, empty, scene, arguments.starts, arguments.rows) for name, scene in scenes.items()}
    print(f"| what | without | with {arguments.obstacles} | ratio |", "|---|---|---|---|", sep="\n")
    for what, measure, scale, unit in WHAT:
        least = dict.fromkeys(found, math.inf)
        for _ in range(TURNS):
            for name, measured in found.items():
                least[name] = min(least[name], measure(measured))
        without, with_them = least["none"], least["obstacles"]
        print(f"| {what} | {scale * without:.3g} {unit} | {scale * with_them:.3g} {unit} | {with_them / without:.2f} |")
    converged = {name: measured.converged for name, measured in found.items()}
    print("converged starts: " + ", ".join(f"{name} {count}" for name, count in converged.items()))


class Measured:
    """One scene, with what is measured in it."""

    def __init__(self, robot: Any, empty: Scene, scene: Scene, starts: int, rows: int) -> None:
        self.robot, self.scene, self.rows = robot, scene, rows
        self.model = TaskModel(robot, scene, "sphere")
        self.verifier = Verifier(robot, scene, "sphere")
        self.solver = LocalSolver(self.model, SolverOptions())
        plan = pinograsp.plan(robot, empty, "sphere", starts=starts, workers=1)
        self.grasps = plan.grasps
        self.starts = [np.concatenate([grasp.q_arm, grasp.synergy]) for grasp in plan.grasps]
        rng = np.random.default_rng(0)
        self.starts = [start + rng.uniform(-0.15, 0.15, len(start)) for start in self.starts]
        self.converged = 0

    def evaluation(self) -> float:
        """Time of one evaluation."""
        problem = self.solver.problem((0, 1))
        points = [np.concatenate([grasp.q_arm, grasp.synergy, grasp.contact_parameters]) for grasp in self.grasps]
        return spent(lambda: [problem.evaluate(x + 1e-7 * k) for k in range(10) for x in points]) / (10 * len(points))

    def start(self) -> float:
        """Time of a start."""
        outcomes = list[Solution]()
        times = [spent(lambda i=i, x=x: outcomes.append(self.solver.solve(i, x))) for i, x in enumerate(self.starts)]
        self.converged = sum(solution.feasible for solution in outcomes)
        return statistics.median(times)

    def certificate(self) -> float:
        """Time of a check."""
        return spent(lambda: [self.verifier.check(grasp.claim) for grasp in self.grasps]) / len(self.grasps)

    def row(self) -> float:
        """Time of a random configuration of the arm."""
        mounted = self.robot.mounted(self.scene.mounting.matrix)
        world = enclosure_world(mounted, self.scene, self.model.task.margin)
        clearance = BatchClearance(mounted, world, hand_opening(mounted))
        size = mounted.arm_size
        low, high = (np.clip(ends[:size], -math.pi, math.pi) for ends in (mounted.lower, mounted.upper))
        q = np.random.default_rng(0).uniform(low, high, (self.rows, size))
        return spent(lambda: clearance.measure(q)) / self.rows

    def model_made(self) -> float:
        """Time to build a model."""
        return spent(lambda: TaskModel(self.robot, self.scene, "sphere"))

    def verifier_made(self) -> float:
        """Time to build a verifier."""
        return spent(lambda: Verifier(self.robot, self.scene, "sphere"))


WHAT = [
    ("evaluation", Measured.evaluation, 1e6, "us"),
    ("start", Measured.start, 1e3, "ms"),
    ("certificate", Measured.certificate, 1e3, "ms"),
    ("database row", Measured.row, 1e6, "us"),
    ("model", Measured.model_made, 1e3, "ms"),
    ("verifier", Measured.verifier_made, 1e3, "ms"),
]


def spent(work: Callable[[], Any]) -> float:
    """Return the CPU time that something takes, s."""
    began = time.process_time()
    work()
    return time.process_time() - began


if __name__ == "__main__":
    main()
