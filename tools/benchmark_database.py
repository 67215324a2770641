"""Benchmark of the start database: building, region queries, and an independent check of its rows.

    python tools/benchmark_database.py box.duckdb [--size 21e6] [--workers 2] [--check 20000]

builds (resumes, grows) the database for the Gen3 and 2F-85 in the glovebox, or measures the one that is there; times
region queries on it and on an unsorted copy of it, side by side; and checks rows drawn at random with the
independent mesh distances. The copy is made beside the file and removed.
"""

from __future__ import annotations

import argparse
import resource
import time
from functools import partial
from pathlib import Path
from typing import Any

import duckdb
import numpy as np

import pinograsp
from pinograsp.database.query import configurations_near, spread_configurations
from pinograsp.database.store import Database
from pinograsp.execution import own_workers
from pinograsp.kinematics.hand_posture import hand_opening
from pinograsp.verification.check import Verifier


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--size", type=float, default=21e6)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--check", type=int, default=20_000, help="rows drawn for the independent check")
    arguments = parser.parse_args()
    robot, scene = pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene("glovebox")
    build(robot, scene, arguments.file, int(arguments.size), arguments.workers)
    queries(arguments.file)
    check(robot, scene, arguments.file, arguments.check, arguments.workers)


def build(robot: Any, scene: Any, file: Path, size: int, workers: int) -> None:
    """Build and print time, rate, memory and file size."""
    began, printed = time.perf_counter(), 0.0

    def show(progress: pinograsp.Progress) -> None:
        nonlocal printed
        if progress.stage == "sorting" or time.perf_counter() - printed > 60:
            printed = time.perf_counter()
            rate = progress.numbers.get("rows per second", 0.0)
            print(f"  {progress.stage}: {progress.done:,} of {progress.total:,}, {rate:,.0f} a second", flush=True)

    with pinograsp.build_database(robot, scene, file, size=size, workers=workers, progress=show) as database:
        rows = database.rows()
    minutes = (time.perf_counter() - began) / 60
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    worker = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 2**20
    print(f"{rows:,} configurations, this run took {minutes:.1f} min with {workers} workers")
    print(f"  peak memory {own:.2f} GiB, and {worker:.2f} GiB in the largest worker")
    print(f"  file {file.stat().st_size / 1e9:.2f} GB ({file.stat().st_size / rows:.0f} bytes a row)")


def queries(file: Path) -> None:
    """Time region queries on the file and on a copy in the order of the samples."""
    unsorted = file.with_name(file.name + ".unsorted")
    unsorted.unlink(missing_ok=True)
    with duckdb.connect(str(unsorted)) as connection:
        connection.execute(f"ATTACH '{file}' AS source (READ_ONLY)")
        connection.execute("CREATE TABLE metadata AS SELECT * FROM source.metadata")
        connection.execute("CREATE TABLE configurations AS SELECT * FROM source.configurations ORDER BY sample")
        connection.execute("DETACH source")
    rng = np.random.default_rng(0)
    print("region queries, 20 centres at rows drawn at random; median (90th percentile) in ms")
    with Database.open(file) as by_curve, Database.open(unsorted) as by_sample:
        rows = by_curve.connection.execute("SELECT x, y, z FROM configurations USING SAMPLE 20 ROWS (reservoir, 1)")
        centers = np.array(rows.fetchall())[rng.permutation(20)]
        for radius in (0.02, 0.05, 0.1):
            first, found = timed(by_curve, centers, radius, spread=False)
            second, _ = timed(by_sample, centers, radius, spread=False)
            spread, _ = timed(by_curve, centers, radius, spread=True)
            ratio = np.median(second) / np.median(first)
            print(
                f"  ball of {1e3 * radius:.0f} mm, {int(np.median(found)):,} rows: sorted {summary(first)}, "
                f"unsorted {summary(second)}, ratio {ratio:.1f}; spread selection of 1304 {summary(spread)}"
            )
    unsorted.unlink()


def timed(database: Database, centers: np.ndarray, radius: float, *, spread: bool) -> tuple[list[float], list[int]]:
    """Return milliseconds of a query, its rows fetched, and the number of rows in each region."""
    milliseconds, found = [], []
    for center in centers:
        began = time.perf_counter()
        if spread:
            spread_configurations(database, center, radius, 1304)
        else:
            configurations_near(database, center, radius)
        milliseconds.append(1e3 * (time.perf_counter() - began))
        near = " + ".join(f"({name} - {value}) ** 2" for name, value in zip("xyz", center, strict=True))
        counted = database.connection.execute(f"SELECT count(*) FROM configurations WHERE {near} <= {radius**2}")
        found.append(counted.fetchall()[0][0])
    return milliseconds, found


def summary(milliseconds: list[float]) -> str:
    """Return median and 90th percentile."""
    return f"{np.median(milliseconds):.1f} ({np.quantile(milliseconds, 0.9):.1f})"


def check(robot: Any, scene: Any, file: Path, count: int, workers: int) -> None:
    """Check rows drawn at random with the meshes; print how many fail."""
    with Database.open(file) as database:
        angles = ", ".join(f"q{i}" for i in range(1, robot.arm_size + 1))
        sql = f"SELECT {angles} FROM configurations USING SAMPLE {count} ROWS (reservoir, 2)"
        rows = np.column_stack(list(database.connection.execute(sql).fetchnumpy().values())).astype(float)
    hand = hand_opening(robot)
    postures = [robot.joints_by_name(np.concatenate([row, hand])) for row in rows]
    began = time.perf_counter()
    with own_workers(workers) as pool:
        failed = [failure for failure in pool.run(partial(checker, robot, scene), postures, chunk=200) if failure]
    seconds = time.perf_counter() - began
    print(f"independent check of {len(rows):,} rows drawn at random: {len(failed)} fail ({seconds:.0f} s)")
    for failure in failed[:10]:
        print("  " + failure)


def checker(robot: Any, scene: Any) -> Any:
    """Return a function that names what a posture violates, or gives an empty text."""
    verifier = Verifier(robot.description, scene, "sphere")

    def failure(joints: dict[str, float]) -> str:
        figures = verifier.check_posture(joints).refuted_by
        return ", ".join(f"{figure.name} {figure.value:.4g} m at {figure.where}" for figure in figures)

    return failure


if __name__ == "__main__":
    main()
