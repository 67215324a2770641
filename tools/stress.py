"""Random tasks for all robots: no grasp may be refuted, nothing may crash, and what fails is explained.

    python tools/stress.py [--scenes 300] [--first 0] [--seed 0] [--robots NAME ...] [--starts 24] [--deadline 30]
        [--workers 1] [--out out/stress]

Each scene has a room of its robot, an object of a random kind, size and pose, shelves or posts around it, margins and a
load. It is planned; a task without a grasp is explained, and every remedy is applied and planned again with another
seed. A line for each scene is kept in the folder at once, and so are the start databases, one for each robot and room:
the same command goes on where it was stopped. Prints a Markdown table with a row for each robot, and one of where the
time goes. Exit code 1 if a grasp was refuted, a plan crashed, a task was not explained, or more than a tenth of the
remedies did not work.
"""

from __future__ import annotations

import argparse
import json
import math
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import pinograsp
from pinograsp import Box, Capsule, Cone, Cylinder, Ellipsoid, Enclosure, Object, Planner, Pose, Scene, Sphere
from pinograsp.database.identity import Identity
from pinograsp.database.store import Database, set_metadata
from pinograsp.kinematics.reach import arm_reach
from pinograsp.kinematics.robot import Robot

ROOMS = 2
"""Rooms of a robot: each needs a start database."""
ROWS = 1
"""Least size of a start database: a single batch of samples is enough for the few starts of a plan."""
MARGINS = (0.005, 0.002)
"""From walls, of the tasks in each of them, m."""
OTHER = 1000
"""What the seed of plans with a remedy is beyond that of the scene."""
WORKING = 0.9
"""Part of the remedies that must work."""
COLUMNS = (
    "scenes",
    "with grasps",
    "refused",
    "failed",
    "explained",
    "with remedies",
    "remedies",
    "working",
    "refuted",
    "crashed",
)
STAGES = ("database", "plan", "explain", "apply")
"""What takes time."""


@dataclass
class Row:
    """What became of one scene."""

    scene: int
    robot: str
    counts: Counter[str] = field(default_factory=Counter)
    """By the names of `COLUMNS`; remedies also by their kinds, "margin" and "margin working"."""
    seconds: Counter[str] = field(default_factory=Counter)
    """Of this process, by the names of `STAGES`."""
    said: list[str] = field(default_factory=list)
    """What kept the task from a grasp, the remedies, and what did not work."""

    @contextmanager
    def timed(self, stage: str) -> Iterator[None]:
        """Count the time of a block."""
        began = time.process_time()
        try:
            yield
        finally:
            self.seconds[stage] += round(time.process_time() - began, 3)  # type: ignore[assignment]


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
        "wrench": {"force": (0.0, 0.0, -float(rng.uniform(0.2, 6.0)))},
        "contact": {"friction": float(rng.uniform(0.3, 1.0))},
        "margin": {"enclosure": MARGINS[kind], "object": float(rng.uniform(0.0005, 0.002))},
    }
    thing = Object(shape=shape(rng), pose=Pose(position=position, rpy=turned))
    pads = [pad.name for pad in robot.description.pads]
    if len(pads) > 2:
        task["pads"] = pads[:2]
    return Scene(name=name, enclosure=enclosure, objects={"thing": thing, **around}, tasks={"t": task})


@contextmanager
def planner(robot: Robot, scene: Scene, options: argparse.Namespace) -> Iterator[Planner]:
    """Open a planner with the start database of a room, for smaller margins, too.

    What keeps larger margins keeps smaller ones: a plan has fewer starts then than with a database of its own.
    """
    margins = scene.task("t").margin
    file = options.out / f"{robot.description.name}_{round(1e3 * scene.enclosure.max[0])}.duckdb"
    wide = margins.model_copy(update={"enclosure": margin_of(robot, scene.enclosure)})
    pinograsp.build_database(robot, scene, file, size=ROWS, margins=wide, workers=options.workers, wait=True).close()
    with tempfile.TemporaryDirectory() as folder:
        if margins != wide:
            file = Path(shutil.copyfile(file, Path(folder) / file.name))
            with Database.open(file, read_only=False) as lent:
                set_metadata(lent, "identity", json.loads(Identity.of(robot, scene, margins).to_json()))
        with Planner(robot, scene, database=file, workers=options.workers) as opened:
            yield opened


def margin_of(robot: Robot, enclosure: Enclosure) -> float:
    """Return the margin from walls of the tasks in a room."""
    return next(margin for number, margin in enumerate(MARGINS) if room(robot, number) == enclosure)


def planned(
    robot: Robot, scene: Scene, options: argparse.Namespace, seed: int, counts: Counter[str], starts: int = 0
) -> bool:
    """Plan a scene with so many starts at least, count refuted ones, and return whether there is a grasp."""
    with planner(robot, scene, options) as opened:
        result = opened.plan("t", starts=max(starts, options.starts), seed=seed)
    counts["refuted"] += result.refuted
    return bool(result.grasps)


def tried(robot: Robot, scene: Scene, options: argparse.Namespace, row: Row) -> None:
    """Plan a scene; explain it if it fails, and apply every remedy."""
    counts, said = row.counts, row.said
    with row.timed("database"), planner(robot, scene, options):
        pass
    with row.timed("plan"):
        try:
            if planned(robot, scene, options, row.scene, counts):
                counts["with grasps"] += 1
                return
            counts["failed"] += 1
        except pinograsp.TaskError:
            counts["refused"] += 1
    with row.timed("explain"), planner(robot, scene, options) as opened:
        why = opened.explain("t", starts=options.starts, seed=row.scene, deadline=options.deadline)
    said += [why.refusal] if why.refusal else [f"{c.kind} {c.body} {c.share:.2f}" for c in why.causes[:3]]
    said += why.warnings
    counts["explained"] += bool(why.refusal or why.causes or why.warnings)
    said += [f"tried: {tried.text}, {tried.ending}" for tried in why.tried]
    counts["with remedies"] += bool(why.remedies)
    for remedy in why.remedies:
        counts["remedies"] += 1
        counts[remedy.kind] += 1
        with row.timed("apply"):
            try:
                starts = int(remedy.amount) if remedy.kind == "starts" else 0
                done = planned(robot, remedy.apply(scene), options, row.scene + OTHER, counts, starts)
                reason = "no grasp"
            except pinograsp.InputError as error:
                done, reason = False, str(error)
        counts["working"] += done
        counts[f"{remedy.kind} working"] += done
        said.append(f"{'works' if done else f'does not work ({reason})'}: {remedy.text}")


def read_rows(file: Path) -> dict[int, Row]:
    """Return the rows of a file by the number of their scene; none if it is not there."""
    lines = file.read_text().splitlines() if file.exists() else []
    rows = [Row(**json.loads(line)) for line in lines]
    return {row.scene: Row(row.scene, row.robot, Counter(row.counts), Counter(row.seconds), row.said) for row in rows}


def table(title: str, columns: tuple[str, ...], rows: dict[str, Counter[str]]) -> str:
    """Return a Markdown table of the sums of the rows, and of all of them."""
    lines = [f"| {title} | {' | '.join(columns)} |", f"|---|{'---:|' * len(columns)}"]
    for name, numbers in {**rows, "all": sum(rows.values(), Counter[str]())}.items():
        lines.append(f"| {name} | {' | '.join(f'{numbers[column]:.4g}' for column in columns)} |")
    return "\n".join(lines)


def report(rows: list[Row]) -> int:
    """Print the tables, and return the exit code."""
    counts, seconds, whole = dict[str, Counter[str]](), dict[str, Counter[str]](), Counter[str]()
    for row in sorted(rows, key=lambda row: row.robot):
        counts.setdefault(row.robot, Counter()).update(row.counts)
        seconds.setdefault(row.robot, Counter()).update(row.seconds)
        whole.update(row.counts)
    kinds = {
        name: Counter({"remedies": number, "working": whole[f"{name} working"]})
        for name, number in whole.items()
        if f"{name} working" in whole
    }
    print(table("robot", COLUMNS, counts))
    print("\n" + table("kind of remedy", ("remedies", "working"), kinds))
    print("\n" + table("CPU time, s", STAGES, seconds))
    unexplained = whole["refused"] + whole["failed"] - whole["explained"]
    too_few = whole["working"] < WORKING * whole["remedies"]
    return int(bool(whole["refuted"] or whole["crashed"] or unexplained or too_few))


def main() -> int:
    """Run the tool."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--robots", nargs="+", default=sorted(pinograsp.shipped_robots()), metavar="NAME")
    parser.add_argument("--starts", type=int, default=24)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--deadline", type=float, default=30.0, help="time for the remedies of a task, s")
    parser.add_argument("--out", type=Path, default=Path("out/stress"), help="folder of rows and start databases")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    file = options.out / f"rows_{options.seed}_{options.starts}_{options.deadline:g}.jsonl"
    rows, robots = read_rows(file), {name: pinograsp.load_robot(name) for name in options.robots}
    try:
        for number in range(options.first, options.first + options.scenes):
            name, seed = options.robots[number % len(robots)], 10_000 * options.seed + number
            if seed in rows:
                continue
            row, began = Row(seed, name, Counter(scenes=1)), time.perf_counter()
            try:
                scene = random_scene(robots[name], np.random.default_rng(seed), f"stress_{seed}")
                tried(robots[name], scene, options, row)
            except Exception:
                row.counts["crashed"] += 1
                row.said.append(traceback.format_exc())
            rows[seed] = row
            with file.open("a") as opened:
                opened.write(json.dumps(vars(row)) + "\n")
            print(f"{seed} {name}, {time.perf_counter() - began:.0f} s: {'; '.join(row.said)}", file=sys.stderr)
    except KeyboardInterrupt:
        print("stopped; the same command goes on", file=sys.stderr)
    return report(list(rows.values()))


if __name__ == "__main__":
    raise SystemExit(main())
