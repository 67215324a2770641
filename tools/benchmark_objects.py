"""Benchmark of the shapes of objects: verified starts of the Gen3 and 2F-85 in the glovebox.

    python tools/benchmark_objects.py [--starts 100] [--workers N]

prints a Markdown table with a row for each object: verified and refuted starts, least U, mean and median time of the
solver for a start. Exit code 1 if a grasp was refuted.
"""

from __future__ import annotations

import argparse
import math
import sys

import pinograsp
from pinograsp import Box, Capsule, Compound, Cone, Cylinder, Ellipsoid, Part, Pose, Sphere

POSITION = (0.80, 0.02, -0.12)
"""Where every object is, m, world."""
TURN = (0.0, 0.0, math.radians(30.0))
SIDE_Y = ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0))
SIDE_X = ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))
ENDS = ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0))
CAN = Compound(
    parts=(
        Part(shape=Cylinder(radius=0.033, height=0.1)),
        Part(shape=Cylinder(radius=0.035, height=0.008), pose=Pose(position=(0.0, 0.0, 0.054))),
        Part(shape=Box(size=(0.03, 0.01, 0.01)), pose=Pose(position=(0.045, 0.0, 0.025))),
        Part(shape=Box(size=(0.03, 0.01, 0.01)), pose=Pose(position=(0.045, 0.0, -0.025))),
        Part(shape=Capsule(radius=0.006, length=0.06), pose=Pose(position=(0.06, 0.0, 0.0))),
    )
)
"""With a lid that stands out and a handle."""
DUMB_BELL = Compound(
    parts=(
        Part(shape=Capsule(radius=0.014, length=0.12)),
        Part(shape=Sphere(radius=0.03), pose=Pose(position=(0.0, 0.0, 0.06))),
        Part(shape=Sphere(radius=0.03), pose=Pose(position=(0.0, 0.0, -0.06))),
    )
)
OBJECTS = {
    "sphere": (Sphere(radius=0.0373), SIDE_Y, 0.0373, (0.0, 0.0, 0.0)),
    "cylinder": (Cylinder(radius=0.035, height=0.1), SIDE_Y, 0.035, (0.0, 0.0, 0.0)),
    "box": (Box(size=(0.05, 0.06, 0.08)), SIDE_X, 0.025, (0.0, 0.0, 0.0)),
    "box, turned by 30 degrees": (Box(size=(0.05, 0.06, 0.08)), SIDE_X, 0.025, TURN),
    "flat box, by its large faces": (Box(size=(0.03, 0.06, 0.02)), ENDS, 0.01, TURN),
    "capsule": (Capsule(radius=0.03, length=0.06), SIDE_Y, 0.03, (0.0, 0.0, 0.0)),
    "cone, by its ends": (Cone(bottom_radius=0.04, top_radius=0.03, height=0.05), ENDS, 0.025, (0.0, 0.0, 0.0)),
    "ellipsoid": (Ellipsoid(semi_axes=(0.03, 0.035, 0.05)), SIDE_Y, 0.035, (0.0, 0.0, 0.0)),
    "can with a lid and a handle": (CAN, SIDE_Y, 0.033, TURN),
    "dumb-bell, by its bar": (DUMB_BELL, SIDE_Y, 0.014, (0.0, 0.0, 0.0)),
    "flat ellipsoid": (Ellipsoid(semi_axes=(0.06, 0.02, 0.03)), SIDE_Y, 0.02, (0.0, 0.0, 0.0)),
}
"""Shape, where to touch, how far that is from the origin, m, and roll, pitch, yaw, rad, by name."""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("objects", nargs="*", default=list(OBJECTS), metavar="object", help=", ".join(OBJECTS))
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--workers", type=int, help="processes; by default one for each core")
    arguments = parser.parse_args()
    if unknown := set(arguments.objects) - set(OBJECTS):
        parser.error(f"unknown: {', '.join(sorted(unknown))}; known: {', '.join(OBJECTS)}")
    robot, glovebox = pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox")
    print(
        "| object | verified | refuted | best U | solver, ms a start | median |", "|---|---|---|---|---|---|", sep="\n"
    )
    refuted = 0
    for name in arguments.objects:
        shape, sides, reach, rpy = OBJECTS[name]
        thing = pinograsp.Object(shape=shape, pose=Pose(position=POSITION, rpy=rpy))
        x, y = ((reach * side[0], reach * side[1], reach * side[2]) for side in sides)
        scene = glovebox.with_object("sphere", thing).with_task("sphere", desired_contacts=(x, y))
        result = pinograsp.plan(robot, scene, "sphere", starts=arguments.starts, workers=arguments.workers)
        best = "-" if result.best is None else f"{result.ranked('U')[0].cost.U:.4g}"
        mean, median = (1e3 * result.times[f"solver_{which}"] for which in ("mean", "median"))
        share = f"{result.verified} of {result.done} ({100 * result.verified / max(result.done, 1):.0f} %)"
        print(f"| {name} | {share} | {result.refuted} | {best} | {mean:.0f} | {median:.0f} |", flush=True)
        refuted += result.refuted
    sys.exit(1 if refuted else 0)


if __name__ == "__main__":
    main()
