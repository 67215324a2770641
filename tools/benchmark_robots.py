"""Benchmark of every shipped robot in its scene: verified starts, and how close its collision pieces are.

    python tools/benchmark_robots.py [robot ...] [--starts 500] [--can-starts 100]

prints a Markdown table with a row for each robot: verified starts of the tasks `sphere` and `can`, mean time of the
solver for a start, and the largest 95th percentile, over the links, of how far the surface of the collision pieces,
and of single convex hulls, is from the mesh.
"""

from __future__ import annotations

import argparse

import numpy as np

import pinograsp
from benchmark_covers import SAMPLES, covered
from pinograsp.geometry.mesh_file import read_triangles
from pinograsp.kinematics.collision_elements import CollisionElement, collision_elements
from pinograsp.kinematics.robot import Robot
from pinograsp.onboarding.excess import excess

SCENES = {
    "gen3_2f85": {"sphere": "glovebox", "can": "glovebox_can"},
    "gen3_2f85_paper": {"sphere": "glovebox", "can": "glovebox_can"},
    "panda": {"sphere": "panda_table", "can": "panda_table"},
    "fr3": {"sphere": "fr3_ceiling", "can": "fr3_ceiling"},
    "ur5_2f85": {"sphere": "ur5_wall", "can": "ur5_wall"},
    "xarm7_2f85": {"sphere": "xarm7_table", "can": "xarm7_table"},
    "xarm7_allegro": {"sphere": "allegro_ceiling", "can": "allegro_ceiling"},
}
"""Scene of every shipped robot's tasks."""
HEAD = ("robot", "scene", "sphere verified", "can verified", "sphere, ms a start", "pieces, mm", "one hull, mm")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robots", nargs="*", default=list(SCENES), metavar="robot", help=", ".join(SCENES))
    parser.add_argument("--starts", type=int, default=500, help="for the sphere")
    parser.add_argument("--can-starts", type=int, default=100, help="for the can")
    parser.add_argument("--workers", type=int, help="processes; by default one for each core")
    arguments = parser.parse_args()
    if unknown := set(arguments.robots) - set(SCENES):
        parser.error(f"no scene is known for {', '.join(sorted(unknown))}; known: {', '.join(SCENES)}")
    print(row(HEAD), row(["---"] * len(HEAD)), sep="\n", flush=True)
    for name in arguments.robots:
        robot, scenes = pinograsp.load_robot(name), SCENES[name]
        results = [
            pinograsp.plan(robot, pinograsp.load_scene(scenes[task]), task, starts=starts, workers=arguments.workers)
            for task, starts in (("sphere", arguments.starts), ("can", arguments.can_starts))
        ]
        shares = [f"{r.verified} of {r.done} ({100 * r.verified / r.done:.1f} %)" for r in results]
        time = f"{1e3 * results[0].times['solver_mean']:.0f}"
        print(row([name, scenes["sphere"], *shares, time, *closeness(robot)]), flush=True)


def row(cells: list[str] | tuple[str, ...]) -> str:
    """Return a row of a Markdown table."""
    return f"| {' | '.join(cells)} |"


def closeness(robot: Robot) -> list[str]:
    """Return the largest 95th percentile of distances from the mesh, mm, of the pieces and of single hulls."""
    meshes = [element for element in collision_elements(robot) if element.mesh is not None]
    pieces = [worst(element, robot.description.collision.of(element.link)) for element in meshes]
    return [f"{1e3 * max(pieces):.1f}", f"{1e3 * max(worst(element, (1, 1.0)) for element in meshes):.1f}"]


def worst(element: CollisionElement, limits: tuple[int, float]) -> float:
    """Return the 95th percentile of distances between the pieces of a mesh, for a number and a tolerance, and it."""
    assert element.mesh is not None
    triangles = read_triangles(element.mesh, element.size)
    return float(np.percentile(excess(covered(element, limits), triangles, SAMPLES), 95))


if __name__ == "__main__":
    main()
