"""Results, databases and caches, damaged and used."""

from __future__ import annotations

import contextlib
import json
import random
import shutil
from pathlib import Path
from typing import Any

import duckdb
import numpy as np

import pinograsp
from fuzz_kind import require_finite, written
from fuzz_mutations import mutate_bytes, mutate_tree
from fuzz_sources import SOURCES, content_of, sources
from pinograsp.array_cache import kept
from pinograsp.cache_folder import cache_folders
from pinograsp.database.layout import exported
from pinograsp.database.query import configurations_near, spread_configurations
from pinograsp.database.store import Database
from pinograsp.results.encoding import encode
from pinograsp.results.table import grasp_table, outcome_lines


def make_result(folder: Path, rng: random.Random) -> None:
    """Write a mutated result."""
    written(folder / "result.json", content_of(rng.choice(sources(Path(SOURCES[0]))["result"])), rng)


def use_result(folder: Path) -> None:
    """Read a result, and show and write it."""
    result = pinograsp.read_json(folder / "result.json")
    repr(result), result._repr_html_(), outcome_lines(result)
    if result.grasps:
        grasp_table(result).drawn(80)
        result.ranked("Q"), result.pareto(), result.different()
        require_finite([grasp.T_object_wrist.tolist() for grasp in result], "wrist")
    json.dumps(encode(result), allow_nan=False)


def make_database(folder: Path, rng: random.Random) -> None:
    """Write a database with changed tables, rows, metadata or bytes."""
    file = folder / "small.duckdb"
    shutil.copy(rng.choice(sources(Path(SOURCES[0]))["database"]), file)
    if rng.random() < 0.3:
        file.write_bytes(mutate_bytes(file.read_bytes(), rng))
        return
    with (
        duckdb.connect(str(file)) as connection,
        contextlib.suppress(duckdb.Error),
    ):  # not all that is tried can be done
        _mutate_database(connection, rng)


def _mutate_database(connection: duckdb.DuckDBPyConnection, rng: random.Random) -> None:
    if rng.random() < 0.6:
        metadata = {key: json.loads(value) for key, value in connection.execute("FROM metadata").fetchall()}
        mutate_tree(metadata, rng)
        connection.execute("DELETE FROM metadata")
        for key, value in metadata.items():
            connection.execute("INSERT INTO metadata VALUES (?, ?)", [str(key).replace("\0", ""), json.dumps(value)])
    places = (("configurations", "q1"), ("configurations", "x"), ("batches", "drawn"), ("metadata", "value"))
    table, column = rng.choice(places)
    statements = (
        f"DROP TABLE {table}",
        f"ALTER TABLE {table} DROP COLUMN {column}",
        f"ALTER TABLE {table} RENAME COLUMN {column} TO other",
        f"ALTER TABLE {table} ADD COLUMN more DOUBLE",
        f"UPDATE {table} SET {column} = NULL",
        "UPDATE configurations SET x = 'nan' WHERE sample % 7 = 0",
        "UPDATE configurations SET q2 = 'inf' WHERE sample % 5 = 0",
        f"DELETE FROM {table}",
        "CREATE VIEW more AS SELECT * FROM read_text('/etc/hostname')",
        "CREATE MACRO isfinite(a) AS true",
    )
    if rng.random() < 0.6:
        connection.execute(rng.choice(statements))


def use_database(folder: Path) -> None:
    """Open a database, ask it and export it."""
    with Database.open(folder / "small.duckdb") as database:
        json.dumps(database.info(), allow_nan=False)
        found = configurations_near(database, [0.6, 0.0, 0.0], 0.5, limit=50)
        require_finite([found.q.tolist(), found.positions.tolist()], "configurations")
        spread_configurations(database, [0.6, 0.0, 0.0], 0.5, 20)
        database.export_parquet(folder / "out.parquet")
        wanted = exported(database.joints())
    if duckdb.sql(f"SELECT * FROM '{folder / 'out.parquet'}'").columns != wanted:
        raise AssertionError("an export has other columns")


def make_cache(folder: Path, rng: random.Random) -> None:
    """Write nothing: the cache that is damaged is made where it is used."""
    (folder / "seed").write_text(str(rng.randrange(2**32)))


def use_cache(folder: Path) -> None:
    """Keep arrays, damage their file, and get them again."""
    rng, wanted = random.Random(int((folder / "seed").read_text())), np.arange(100.0)
    place = next(iter(cache_folders())) / "fuzz"

    def get() -> Any:
        return kept("fuzz", "arrays", lambda: wanted, lambda value: {"a": value}, lambda arrays: arrays["a"])

    get()
    file = place / "arrays.npz"
    file.write_bytes(mutate_bytes(file.read_bytes(), rng))
    if not np.array_equal(get(), wanted):
        raise AssertionError("a damaged cache was taken")
