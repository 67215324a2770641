"""Benchmark of the main job: the sphere task with the real Gen3 and 2F-85.

    python tools/benchmark.py [--starts 1304] [--workers 2] [--compare 200] [--database box.duckdb]

prints the figures of a full run, how the time of a start divides, and, on one set of starts, what the projection
is worth. Absolute times are those of this machine; the ratios are what to compare.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import time
from collections import Counter
from pathlib import Path
from typing import Any, get_args

import numpy as np

import pinograsp
from pinograsp.database.cache import cached_database
from pinograsp.database.store import Database
from pinograsp.problem import TaskModel
from pinograsp.results.table import outcome_lines
from pinograsp.solve.local import LocalSolver
from pinograsp.solve.options import Projection, SolverOptions
from pinograsp.solve.starts import starts_near

# Where the time goes: the first part whose name is in the file name of a function gets its own time.
PARTS = {
    "distances": ("pinograsp/collision", "constraints/clearance"),
    "kinematics": ("pinograsp/kinematics", "arrays"),
    "statics and forces": ("pinograsp/mechanics",),
    "terms and assembly": ("pinograsp/problem", "pinograsp/geometry"),
    "projection and NLopt": ("pinograsp/solve", "nlopt"),
}


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=1304)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--compare", type=int, default=200, help="starts of the profile and the comparison")
    parser.add_argument("--database", type=Path, help="start database; by default the small cached one")
    arguments = parser.parse_args()
    robot, scene = pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox")
    model = TaskModel(robot, scene, "sphere")
    given = arguments.database
    with Database.open(given) if given else cached_database(robot, scene, model.task.margin) as database:
        run(robot, scene, arguments.starts, arguments.workers, database)
        starts = starts_near(database, model, arguments.compare, seed=0)
    divide(model, starts)
    compare(model, starts)


def run(robot: Any, scene: Any, starts: int, workers: int, database: Database) -> None:
    """Print the figures of a whole run."""
    result = pinograsp.plan(robot, scene, "sphere", starts=starts, workers=workers, seed=0, database=database)
    best = next(iter(result.ranked("U")), None)
    print(f"sphere, {starts} starts of a database of {database.rows():,}, seed 0, {workers} workers")
    for line in outcome_lines(result):
        print("  " + line)
    if best:
        print(f"  best U {best.cost.U:.5f}, Phi {best.cost.phi_mm2:.1e} mm^2, V {best.cost.V:.5f}")
    times = result.times
    print(f"  {times['total']:.1f} s in all, of which {times['starts']:.2f} s for the query of the starts")
    print(
        f"  a start on one core: solver mean {1e3 * times['solver_mean']:.1f} ms, median "
        f"{1e3 * times['solver_median']:.1f} ms; check mean {1e3 * times['verification_mean']:.1f} ms"
    )


def divide(model: TaskModel, starts: np.ndarray) -> None:
    """Print how the time of a solve divides, by a profile of one process."""
    solver = LocalSolver(model, SolverOptions())
    profile = cProfile.Profile()
    profile.enable()
    for index, start in enumerate(starts):
        solver.solve(index, start)
    profile.disable()
    own: Counter[str] = Counter()
    stats: dict[tuple[str, int, str], Any] = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    for (file, _, _), (_, _, own_time, _, callers) in stats.items():
        part = part_of(file)
        if part:
            own[part] += own_time
        else:  # NumPy, Coal and the like count for whoever called them
            for (caller, _, _), entry in callers.items():
                own[part_of(caller) or "other"] += entry[2]
    total = sum(own.values())
    print(f"how the time of a start divides (profile of {len(starts)} starts)")
    for part, seconds in own.most_common():
        print(f"  {part:22} {100 * seconds / total:5.1f} %")


def part_of(file: str) -> str | None:
    """Return the part that a source file belongs to."""
    return next((part for part, names in PARTS.items() if any(name in file for name in names)), None)


def compare(model: TaskModel, starts: np.ndarray) -> None:
    """Print what each way of projecting gives on the same starts."""
    print(f"projection, {len(starts)} starts (feasible by the solver's own measure)")
    print(f"  {'onto':24} {'feasible':>8} {'mean ms':>8} {'ratio':>6} {'evaluations':>12}")
    base = None
    for onto in reversed(get_args(Projection)):
        solver = LocalSolver(model, SolverOptions(projection=onto))
        began = time.perf_counter()
        solutions = [solver.solve(index, start) for index, start in enumerate(starts)]
        mean = (time.perf_counter() - began) / len(starts)
        base = base or mean
        share = np.mean([solution.feasible for solution in solutions])
        evaluations = np.mean([solution.evaluations for solution in solutions])
        print(f"  {onto:24} {100 * share:6.1f} % {1e3 * mean:8.1f} {mean / base:6.2f} {evaluations:12.1f}")


if __name__ == "__main__":
    main()
