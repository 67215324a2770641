"""Building, resuming and growing a database.

Batches are inserted as they are done, each with its line in `batches`, in one transaction: whatever happens, the file
holds whole batches. When the batches 0 .. n - 1 give at least `size` rows, with the least such n, their rows are
written in the order of the curve to a new file, which then takes the place of the old one. So the rows depend on
seed and size only: not on the number of workers, nor on how often the building was killed.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Generator
from contextlib import closing
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import get_args

from ..collision.solids import link_bodies
from ..descriptions import Scene
from ..descriptions.task import Margins
from ..disk import as_path, is_there
from ..errors import (
    DatabaseMismatchError,
    UnknownNameError,
    close_names,
    require_kind,
    require_report,
    whole_number,
)
from ..execution import own_workers
from ..interrupts import held
from ..kinematics.robot import Robot
from ..progress import Progress, Report, no_report
from .files import aside, create, writing
from .identity import Identity
from .layout import columns, create_tables, literal
from .lock import building
from .sampling import DRAWS, Batch, BatchSampler
from .spread import Spread
from .store import Database, interruptible, require_identity, set_metadata

HOPELESS = 8
"""Batches without a single free configuration after which a build ends with none."""
_USUAL = 1 / 16
"""Share of samples that are taken to be free before a batch has told."""


def build_database(
    robot: Robot,
    scene: Scene,
    file: Path | str,
    *,
    size: int,
    seed: int = 0,
    margins: Margins | None = None,
    spread: Spread = "joints",
    workers: int | None = None,
    wait: bool = False,
    progress: Report = no_report,
) -> Database:
    """Build a database of `size` collision-free configurations, or resume or grow the one that is there.

    Args:
        robot: from `load_robot`.
        scene: its enclosure, mounting and fixed obstacles count; objects and tasks do not.
        file: the database; made if it does not exist.
        size: number of configurations wanted.
        seed: of the samples.
        margins: least distances; by default those that a task has by default.
        spread: "joints": uniform over the joint limits; "wrist": thinned so that wrist positions are even.
        workers: number of processes; None: one for each core.
        wait: whether to wait while another process builds this database, instead of refusing.
        progress: called after every batch, of `start database` and with the `rows per second` of this run; before that
            of the `convex pieces` of the robot's meshes, once on a machine, and after it of the `sorting`.

    Returns:
        The database, open for reading. It has no row if none of `HOPELESS` batches of samples is free of collision.

    Raises:
        FileError: the file is no database.
        UnwritableError: it cannot be written, as where the disk is full; whole batches stay.
        DatabaseMismatchError: it is one for another robot, enclosure, margin, seed or spread.
        InputError: a number is out of range, or there is no such spread.
    """
    require_kind("robot", robot, Robot, remedy="Make it with `load_robot`")
    require_kind("scene", scene, Scene, remedy="Make it with `load_scene`, or in Python")
    require_report(progress)
    path, processes = as_path("file", file), own_workers(workers)
    size, seed = whole_number("size", size, 1), whole_number("seed", seed, 0, None)
    if spread not in (known := get_args(Spread)):
        raise UnknownNameError(f"no spread {spread!r}", key="spread", remedy=close_names(spread, known))
    if margins is not None:
        require_kind("margins", margins, Margins)
    margins = margins or Margins()
    identity = Identity.of(robot, scene, margins)
    prepare = partial(BatchSampler, robot, scene, margins, seed, spread)
    pace = _Pace(size, progress)
    link_bodies(robot, progress)
    with held(), interruptible(), building(path, wait=wait), processes as pool:
        with writing(path):
            _make(path, identity, seed, spread)
        while missing := _missing_batches(path, size):
            Database.open(path, read_only=False).close()  # refused before the work if somebody reads it
            _add(path, pool.run(prepare, missing, chunk=1), pace)
        with writing(path):
            _finish(path, size, pace)
    return Database.open(path)


def _add(path: Path, batches: Generator[Batch], pace: _Pace) -> None:
    """Insert batches as they come."""
    with closing(batches):
        # Wait for the first before the file is opened: workers must not be forked with DuckDB's threads.
        first = next(batches)
        with Database.open(path, read_only=False) as database:
            with writing(path):
                set_metadata(database, "layout", "unsorted")
            for batch in itertools.chain([first], batches):
                with writing(path):
                    _insert(database, batch)
                pace.step(batch.accepted, database)


class _Pace:
    """Reports rows and rate."""

    def __init__(self, size: int, report: Report) -> None:
        self._size, self._report = size, report
        self._began = time.perf_counter()
        self._inserted = 0
        self._there = 0

    def step(self, inserted: int, database: Database) -> None:
        if not self._inserted:
            self._there = database.rows() - inserted
        self._inserted += inserted
        rate = self._inserted / max(time.perf_counter() - self._began, 1e-9)
        rows = self._there + self._inserted
        self._report(Progress("start database", rows, max(rows, self._size), {"rows per second": rate}))

    def sorting(self, rows: int) -> None:
        self._report(Progress("sorting", 0, rows))


def _make(path: Path, identity: Identity, seed: int, spread: Spread) -> None:
    """Make the database if it is not there; refuse one made otherwise. Others may read what is complete."""
    if not is_there(path):
        facts = {"seed": seed, "spread": spread, "layout": "unsorted", "size": 0, "versions": _versions()}
        create(path, identity, facts)
        return
    with Database.open(path) as database:
        require_identity(database, identity)
        found = database.metadata()
    for key, wanted in (("seed", seed), ("spread", spread)):
        if found[key] != wanted:
            raise DatabaseMismatchError(f"was made with {key} {found[key]!r}, not {wanted!r}", file=path, key=key)


def _versions() -> dict[str, str]:
    return {name: version(name) for name in ("pinograsp", "pin", "coal", "numpy", "duckdb")}


def _needed(accepted: dict[int, int], size: int) -> int | None:
    """Return the least n for which the batches 0 .. n - 1 are there and give `size` rows, or None."""
    rows = 0
    for n in itertools.count():
        if rows >= size:
            return n
        if n not in accepted:
            return None
        rows += accepted[n]
    raise AssertionError("unreachable")


def _missing_batches(path: Path, size: int) -> list[int]:
    """Return the batches to compute next: as many as `size` rows are likely to take; none if they are there."""
    with Database.open(path) as database:
        accepted = dict(database.select("SELECT batch, accepted FROM batches"))
    if _needed(accepted, size) is not None:
        return []
    mean = sum(accepted.values()) / len(accepted) if accepted else 0.0
    if len(accepted) >= HOPELESS and mean == 0.0:
        return []
    if mean:
        likely = math.ceil(1.005 * size / mean)
    else:
        likely = HOPELESS if accepted else min(math.ceil(size / (_USUAL * DRAWS)), HOPELESS)
    missing = [batch for batch in range(likely) if batch not in accepted]
    return missing or [max(accepted) + 1]


def _insert(database: Database, batch: Batch) -> None:
    """Insert a batch with its line in `batches`, both or neither."""
    rows = batch.columns  # read by its name in the statement below
    listed = ", ".join(rows)
    connection = database.connection
    connection.execute("BEGIN")
    connection.execute(f"INSERT INTO configurations ({listed}) SELECT {listed} FROM rows")
    connection.execute("INSERT INTO batches VALUES (?, ?, ?)", [batch.number, DRAWS, batch.accepted])
    connection.execute("COMMIT")


def _finish(path: Path, size: int, pace: _Pace) -> None:
    """Write the rows that `size` needs, sorted, to a new file in the place of the old one; or leave that as it is."""
    with Database.open(path) as database:
        if database.metadata()["layout"] == "sorted":
            return
    with aside(path, ".sorting") as sorting:
        with Database.open(path, read_only=False) as database:
            accepted = dict(database.select("SELECT batch, accepted FROM batches"))
            needed = _needed(accepted, size)
            if needed is None:
                return
            pace.sorting(sum(accepted[batch] for batch in range(needed)))
            joints = len(database.joints())
            listed = ", ".join(columns(joints))
            connection = database.connection
            connection.execute(f"ATTACH {literal(sorting)} AS sorted")
            create_tables(connection, joints, "sorted.")
            rows = (
                f"INSERT INTO sorted.configurations SELECT {listed} FROM configurations "
                f"WHERE sample < {needed} * {DRAWS}::BIGINT ORDER BY cell, sample"
            )
            database.run(lambda: connection.execute(rows))
            kept = f"SELECT * FROM batches WHERE batch < {needed} ORDER BY batch"
            connection.execute(f"INSERT INTO sorted.batches {kept}")
            connection.execute("INSERT INTO sorted.metadata SELECT * FROM metadata")
            for key, value in (("layout", '"sorted"'), ("size", str(size))):
                connection.execute("UPDATE sorted.metadata SET value = ? WHERE key = ?", [value, key])
            connection.execute("DETACH sorted")
        sorting.replace(path)
