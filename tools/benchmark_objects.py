"""Benchmark of what is grasped: verified starts of the Gen3 and 2F-85 in the glovebox, contacts proposed.

    python tools/benchmark_objects.py [--foreign] [--starts 100] [--workers N] [OBJECT ...]

Shapes and compounds, or, with --foreign, the meshes of `foreign_objects.yaml`, which are downloaded once. Prints a
Markdown table with a row for each object: verified and refuted starts; the best cost (V alone, since nothing is
desired); the worst gap of a contact, median and worst tilt of a pad against the object, as the check measures them;
mean and median time of the solver for a start, mean time of a check, and time before the starts, most of it spent on
preparing robot and object where the cache has them not. Exit code 1 if a grasp was refuted.
"""

from __future__ import annotations

import argparse
import math
import sys

import numpy as np

import pinograsp
from foreign_objects import ForeignObject, fetch, foreign_objects
from pinograsp import Box, Capsule, Compound, Cone, Cylinder, Ellipsoid, Mesh, Part, Pose, Result, Sphere
from pinograsp.descriptions.shapes import ShapeDescription
from pinograsp.geometry.object_mesh import object_mesh

POSITION = np.array([0.80, 0.02, -0.12])
"""Where the middle of every object is, m, world."""
TURN = (0.0, 0.0, math.radians(30.0))
STRAIGHT = (0.0, 0.0, 0.0)
BOX = Box(size=(0.05, 0.06, 0.08))
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
RollPitchYaw = tuple[float, float, float]
OBJECTS: dict[str, tuple[ShapeDescription, RollPitchYaw]] = {
    "sphere": (Sphere(radius=0.0373), STRAIGHT),
    "cylinder": (Cylinder(radius=0.035, height=0.1), STRAIGHT),
    "box": (BOX, STRAIGHT),
    "box, turned by 30 degrees": (BOX, TURN),
    "flat box": (Box(size=(0.03, 0.06, 0.02)), TURN),
    "capsule": (Capsule(radius=0.03, length=0.06), STRAIGHT),
    "cone": (Cone(bottom_radius=0.04, top_radius=0.03, height=0.05), STRAIGHT),
    "ellipsoid": (Ellipsoid(semi_axes=(0.03, 0.035, 0.05)), STRAIGHT),
    "flat ellipsoid": (Ellipsoid(semi_axes=(0.06, 0.02, 0.03)), STRAIGHT),
    "can with a lid and a handle": (CAN, TURN),
    "dumb-bell": (DUMB_BELL, STRAIGHT),
}
"""Shape, and roll, pitch, yaw, rad, by name."""
GRIP = 20.0
"""Greatest force of a pad on a foreign mesh, N: the least that a 2F-85 can be set to. On shapes, the paper's 5 N."""
FACTS = ("triangles", "width, mm", "convex", "watertight")
COLUMNS = (
    *("verified", "refuted", "best V", "gap, um", "tilt, deg", "worst"),
    *("ms a start", "median", "ms a check", "before, s"),
)


def scene_with(
    shape: ShapeDescription, middle: np.ndarray, rpy: tuple[float, float, float] = STRAIGHT
) -> pinograsp.Scene:
    """Return the glovebox with an object for its sphere, the point `middle` of its frame at `POSITION`."""
    turned = Pose(rpy=rpy).matrix[:3, :3] @ middle
    thing = pinograsp.Object(shape=shape, pose=Pose(position=tuple(POSITION - turned), rpy=rpy))
    scene = pinograsp.load_scene("glovebox").with_object("sphere", thing)
    return scene.with_task("sphere", desired_contacts=None)


def scene_of_mesh(thing: ForeignObject) -> pinograsp.Scene:
    """Return the glovebox with a foreign mesh."""
    mesh = Mesh(file=thing.file, scale=thing.scale, unit="m", largest_hole=thing.largest_hole)
    corners = object_mesh(mesh).vertices
    scene = scene_with(mesh, (corners.min(axis=0) + corners.max(axis=0)) / 2)
    return scene.with_task("sphere", contact=scene.task("sphere").contact.model_copy(update={"max_force": GRIP}))


def row(result: Result) -> list[str]:
    """Return the cells of a row, as `COLUMNS` says."""
    figures = [{figure.name: figure.value for figure in grasp.certificate.figures} for grasp in result.grasps]
    gaps = [1e6 * of["contact gap"] for of in figures]
    tilts = [math.degrees(of["pad tangency"]) for of in figures]
    share = f"{result.verified} of {result.done} ({100 * result.verified / max(result.done, 1):.0f} %)"
    found = ["-"] * 4
    if result.best:
        best = min(grasp.cost.U for grasp in result.grasps)
        found = [f"{best:.4g}", f"{max(gaps):.1f}", f"{np.median(tilts):.1f}", f"{max(tilts):.1f}"]
    mean, median, check = (1e3 * result.times[key] for key in ("solver_mean", "solver_median", "verification_mean"))
    times = (f"{mean:.0f}", f"{median:.0f}", f"{check:.0f}", f"{result.times['prepare']:.1f}")
    return [share, str(result.refuted), *found, *times]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("objects", nargs="*", metavar="object", help="names of some; all if not given")
    parser.add_argument("--foreign", action="store_true", help="meshes that others made")
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--workers", type=int, help="processes; by default one for each core")
    arguments = parser.parse_args()
    known = foreign_objects() if arguments.foreign else OBJECTS
    if unknown := set(arguments.objects) - set(known):
        parser.error(f"unknown: {', '.join(sorted(unknown))}; known: {', '.join(known)}")
    chosen = {name: known[name] for name in arguments.objects or known}
    if arguments.foreign:
        fetch(chosen.values())
    columns = ("object", *(FACTS if arguments.foreign else ()), *COLUMNS)
    print(f"| {' | '.join(columns)} |", "|---" * len(columns) + "|", sep="\n")
    robot, refuted = pinograsp.load_robot("gen3_2f85"), 0
    for name, thing in chosen.items():
        foreign = isinstance(thing, ForeignObject)
        cells = [name, *thing.cells] if foreign else [name]
        try:
            scene = scene_of_mesh(thing) if foreign else scene_with(thing[0], np.zeros(3), thing[1])
            result = pinograsp.plan(robot, scene, "sphere", starts=arguments.starts, workers=arguments.workers)
        except pinograsp.InputError as error:  # such as a hole, or no pair of points that fits the hand
            cells.append(str(error))
        else:
            cells += row(result)
            refuted += result.refuted
        print(f"| {' | '.join(cells)} |", flush=True)
    sys.exit(1 if refuted else 0)


if __name__ == "__main__":
    main()
