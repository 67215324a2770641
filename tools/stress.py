"""Random tasks for all robots: no grasp may be refuted, nothing may crash, and what fails is explained.

    python tools/stress.py [--scenes 300] [--seed 0] [--robots NAME ...] [--starts 48] [--workers N] [--deadline 30]

Each scene has a room of its robot, an object of a random kind, size and pose, shelves or posts around it, margins and a
load. It is planned; a task without a grasp is explained, and every remedy is applied and planned again with another
seed. Prints a Markdown table with a row for each robot. Exit code 1 if a grasp was refuted, a plan crashed, a task was
not explained, or more than a tenth of the remedies did not work.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
import traceback
from collections import Counter
from typing import Any

import numpy as np

import pinograsp
from pinograsp import Box, Capsule, Cone, Cylinder, Ellipsoid, Enclosure, Object, Pose, Result, Scene, Sphere
from pinograsp.kinematics.reach import arm_reach
from pinograsp.kinematics.robot import Robot

ROOMS = 2
"""Rooms of a robot: each needs a start database."""
MARGINS = (0.005, 0.002)
"""From walls, of the tasks in each of them, m."""
WORKING = 0.9
"""Part of the remedies that must work."""
COLUMNS = ("scenes", "with grasps", "refused", "failed", "explained", "remedies", "working", "refuted", "crashed")


def room(robot: Robot, number: int) -> Enclosure:
    """Return a room around a robot that stands on its floor; one of `ROOMS`."""
    base, reach = arm_reach(robot)
    half = (0.75, 0.9)[number % ROOMS] * reach
    return Enclosure(min=(-half, -half, -0.05), max=(half, half, float(base[2]) + half))


def shape(rng: np.random.Generator) -> Any:
    """Return a random shape."""
    a, b, c = rng.uniform(0.01, 0.05, 3).tolist()
    kinds = (
        lambda: Sphere(radius=a),
        lambda: Box(size=(2.0 * a, 2.0 * b, 3.0 * c)),
        lambda: Cylinder(radius=a, height=4.0 * b),
        lambda: Capsule(radius=a, length=2.0 * b),
        lambda: Cone(bottom_radius=a, top_radius=0.6 * a, height=3.0 * b),
        lambda: Ellipsoid(semi_axes=(a, b, c)),
    )
    return kinds[int(rng.integers(len(kinds)))]()


def random_scene(robot: Robot, rng: np.random.Generator, name: str) -> Scene:
    """Return a random scene with the task "t"."""
    kind, (_, reach) = int(rng.integers(ROOMS)), arm_reach(robot)
    enclosure = room(robot, kind)
    distance, angle = rng.uniform(0.3, 0.75) * reach, rng.uniform(-math.pi, math.pi)
    place = np.array([distance * math.cos(angle), distance * math.sin(angle), rng.uniform(0.02, 0.6 * reach)])
    position = tuple(np.clip(place, np.array(enclosure.min) + 0.06, np.array(enclosure.max) - 0.06).tolist())
    turned = (0.0, 0.0, float(rng.uniform(-math.pi, math.pi)))
    there = np.array(position)
    around = dict[str, Object]()  # things, not obstacles: those would each need a start database of their own
    gap, depth = rng.uniform(0.08, 0.25, 2).tolist()
    if rng.random() < 0.6:
        board = Box(size=(0.3, 0.3, 0.015))
        around["shelf"] = Object(shape=board, pose=Pose(position=(there[0], there[1], there[2] - gap)))
        around["shelf_top"] = Object(shape=board, pose=Pose(position=(there[0], there[1], there[2] + depth)))
    for number in range(int(rng.integers(4))):
        way = rng.uniform(-math.pi, math.pi)
        off = rng.uniform(0.05, 0.2) * np.array([math.cos(way), math.sin(way), 0.0])
        post = Cylinder(radius=0.012, height=0.2)
        around[f"post_{number}"] = Object(shape=post, pose=Pose(position=tuple((there + off).tolist())))
    task = {
        "object": "thing",
        "wrench": {"force": (0.0, 0.0, -float(rng.uniform(0.2, 12.0)))},
        "contact": {"friction": float(rng.uniform(0.3, 1.0))},
        "margin": {"enclosure": MARGINS[kind], "object": float(rng.uniform(0.0005, 0.002))},
    }
    thing = Object(shape=shape(rng), pose=Pose(position=position, rpy=turned))
    pads = [pad.name for pad in robot.description.pads]
    if len(pads) > 2:
        task["pads"] = pads[:2]
    return Scene(name=name, enclosure=enclosure, objects={"thing": thing, **around}, tasks={"t": task})


def works(result: Result, counts: Counter[str]) -> bool:
    """Count refuted starts of a result, and return whether it has a grasp."""
    counts["refuted"] += result.refuted
    return bool(result.grasps)


def tried(robot: Robot, scene: Scene, options: argparse.Namespace, seed: int, counts: Counter[str]) -> None:
    """Plan a scene; explain it if it fails, and apply every remedy."""
    plan = {"starts": options.starts, "workers": options.workers}
    try:
        if works(pinograsp.plan(robot, scene, "t", seed=seed, **plan), counts):
            counts["with grasps"] += 1
            return
        counts["failed"] += 1
    except pinograsp.TaskError:
        counts["refused"] += 1
    why = pinograsp.explain(robot, scene, "t", seed=seed, deadline=options.deadline, **plan)
    counts["explained"] += bool(why.refusal or why.causes or why.warnings)
    for remedy in why.remedies:
        counts["remedies"] += 1
        try:
            done = works(pinograsp.plan(robot, remedy.apply(scene), "t", seed=seed + 1000, **plan), counts)
        except pinograsp.InputError as error:
            done = False
            print(f"{scene.name}: {error}", file=sys.stderr)
        counts["working"] += done
        if not done:
            print(f"{scene.name}: does not work: {remedy.text}", file=sys.stderr)


def main() -> int:
    """Run the tool."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--robots", nargs="+", default=sorted(pinograsp.shipped_robots()), metavar="NAME")
    parser.add_argument("--starts", type=int, default=48)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--deadline", type=float, default=30.0, help="time for the remedies of a task, s")
    options = parser.parse_args()
    robots = {name: pinograsp.load_robot(name) for name in options.robots}
    table = {name: Counter[str]() for name in robots}
    began = time.perf_counter()
    for number in range(options.scenes):
        name = options.robots[number % len(robots)]
        counts, seed = table[name], 10_000 * options.seed + number
        counts["scenes"] += 1
        try:
            scene = random_scene(robots[name], np.random.default_rng(seed), f"stress_{seed}")
            tried(robots[name], scene, options, seed, counts)
        except Exception:
            counts["crashed"] += 1
            print(f"scene {seed} of {name}:\n{traceback.format_exc()}", file=sys.stderr)
        print(f"{number + 1} of {options.scenes}, {time.perf_counter() - began:.0f} s", file=sys.stderr)
    whole = sum(table.values(), Counter[str]())
    print(f"| robot | {' | '.join(COLUMNS)} |\n|---|{'---:|' * len(COLUMNS)}")
    for name, counts in {**table, "all": whole}.items():
        print(f"| {name} | {' | '.join(str(counts[column]) for column in COLUMNS)} |")
    unexplained = whole["refused"] + whole["failed"] - whole["explained"]
    too_few = whole["working"] < WORKING * whole["remedies"]
    return int(bool(whole["refuted"] or whole["crashed"] or unexplained or too_few))


if __name__ == "__main__":
    raise SystemExit(main())
