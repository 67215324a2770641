"""The DuckDB file.

    configurations   one row a collision-free arm configuration (columns: see `columns`)
    batches          batch, drawn, accepted: which batches of samples the rows come from
    metadata         key and value (JSON): format, identity, seed, spread, layout, size, versions

The file can be opened at any time. While it is being built its rows are unsorted (layout "unsorted"); a complete
one is stored in the order of a space-filling curve of the wrist position (layout "sorted").
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

import duckdb
from numpy.typing import NDArray

from ..disk import as_path, is_file, is_folder, reason_of, written_whole
from ..errors import DatabaseMismatchError, FileError, UnwritableError
from ..interrupts import heard
from .identity import Identity

Answer = TypeVar("Answer")

FORMAT = 1
APPLICATION = "pinograsp start database"
AGAIN = 0.02
"""Seconds after which a query that has not ended is told so again: it may not have begun when it was told."""


def columns(joints: int) -> dict[str, str]:
    """Return the columns of `configurations` with their SQL types.

    q1 .. ql: arm joints in the order of the robot file, rad (m); x, y, z: wrist position, m, world; ax, ay, az:
    approach direction (the wrist's z axis), world; clearance: least distance to walls, obstacles and itself, m,
    at most 0.05; cell: Morton index of the wrist position; sample: number of the random sample.
    """
    angles = {f"q{i}": "FLOAT" for i in range(1, joints + 1)}
    vectors = dict.fromkeys(("x", "y", "z", "ax", "ay", "az", "clearance"), "FLOAT")
    return {**angles, **vectors, "cell": "UINTEGER", "sample": "BIGINT"}


class Database:
    """An open database file, from `build_database` or `Database.open`; a context manager."""

    def __init__(self, file: Path, connection: duckdb.DuckDBPyConnection) -> None:
        self.file = file
        """Where it is."""
        self.connection = connection
        """To DuckDB: the rows are in its table `configurations`."""

    @classmethod
    def open(cls, file: Path | str, *, read_only: bool = True) -> Database:
        """Open an existing database.

        Args:
            file: the database.
            read_only: others may read it at the same time, and nobody can change it.

        Raises:
            FileError: the file is missing, damaged, foreign, of another format or in use.
        """
        path = as_path("file", file)
        if not is_file(path):
            problem = "is a folder" if is_folder(path) else "no such database"
            raise FileError(problem, file=path, remedy="Make it with `pinograsp database build`")
        if not _begins_as_duckdb(path):  # DuckDB opens files of other kinds, too
            raise FileError("is damaged or not a DuckDB file; it was left as it is", file=path)
        try:
            connection = duckdb.connect(str(path), read_only=read_only, config={"memory_limit": "2GB"})
        except duckdb.IOException as error:
            if "permission denied" in str(error).lower():
                raise FileError("cannot be opened: permission denied", file=path, remedy="Check the file") from None
            if "lock" in str(error).lower():
                raise FileError("is in use by another process", file=path, remedy="Wait until it is done") from None
            raise FileError("is damaged or not a DuckDB file; it was left as it is", file=path) from None
        except duckdb.ConnectionException:
            mode = "for writing" if read_only else "for reading"
            raise FileError(f"is open in this process {mode}", file=path, remedy="Close it first") from None
        except duckdb.Error:
            raise FileError("is damaged or not a DuckDB file; it was left as it is", file=path) from None
        database = cls(path, connection)
        try:
            found = database.metadata()
            if found.get("application") != APPLICATION or found.get("format") != FORMAT:
                raise FileError(
                    f"is not a {APPLICATION} of format {FORMAT}; it was left as it is",
                    file=path,
                    remedy="Name another file",
                )
        except duckdb.Error:
            database.close()
            raise FileError(f"is a DuckDB file, but not a {APPLICATION}; it was left as it is", file=path) from None
        except FileError:
            database.close()
            raise
        return database

    def __enter__(self) -> Database:
        """Return the database; it is closed at the end of the block."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        self.connection.close()

    def select(self, sql: str, values: Mapping[str, Any] | None = None) -> list[tuple[Any, ...]]:
        """Return the rows of a query; Ctrl-C ends it, and KeyboardInterrupt is raised.

        Args:
            sql: the query, with `$name` for values.
            values: by name.
        """
        return self._waited_for(lambda: self.connection.execute(sql, values).fetchall())

    def select_columns(self, sql: str, values: Mapping[str, Any] | None = None) -> dict[str, NDArray[Any]]:
        """Return the rows of a query as one array for each column.

        Args:
            sql: as for `select`.
            values: as for `select`.
        """
        return self._waited_for(lambda: dict(self.connection.execute(sql, values).fetchnumpy()))

    def _waited_for(self, query: Callable[[], Answer]) -> Answer:
        """Return the answer of a query, for which a thread of its own waits.

        DuckDB looks for Ctrl-C only in the thread that asks, and not while that one helps its other threads.
        """
        with interruptible(), ThreadPoolExecutor(1) as thread:
            running = thread.submit(query)
            try:
                with heard():
                    return running.result()
            except KeyboardInterrupt:
                while not wait([running], AGAIN).done:
                    self.connection.interrupt()
                raise

    def metadata(self) -> dict[str, Any]:
        """Return the metadata, JSON values read."""
        rows = self.select("SELECT key, value FROM metadata")
        return {key: json.loads(value) for key, value in rows}

    def rows(self) -> int:
        """Return the number of configurations."""
        return int(self.select("SELECT count(*) FROM configurations")[0][0])

    def joints(self) -> list[str]:
        """Return the arm joints in the order of q1, q2, ..."""
        return list(identity_of(self).robot["joints"])

    def info(self) -> dict[str, Any]:
        """Return counts, layout, size and metadata."""
        drawn, batches = self.select("SELECT coalesce(sum(drawn), 0), count(*) FROM batches")[0]
        facts = {key: value for key, value in self.metadata().items() if key != "identity"}
        identity = identity_of(self)
        return {
            "rows": self.rows(),
            "samples_drawn": int(drawn),
            "batches": int(batches),
            "bytes": self.file.stat().st_size,
            **facts,
            "joints": self.joints(),
            "hashes": {part: identity.hash_of(part) for part in ("robot", "enclosure", "margins")},
            "margins": identity.margins,
        }

    def export_parquet(self, file: Path | str) -> None:
        """Write the configurations as one Parquet file, q1 .. ql, rad (m), under the names of their joints.

        The file is there whole or not at all.

        Raises:
            UnwritableError: the file cannot be written.
        """
        names = ", ".join(f'q{i} AS "{name}"' for i, name in enumerate(self.joints(), 1))
        others = ", ".join(column for column in columns(len(self.joints())) if not column.startswith("q"))
        rows = f"SELECT {names}, {others} FROM configurations"
        path = as_path("file", file)
        with written_whole(path) as unfinished, writing(path):
            target = str(unfinished).replace("'", "''")
            self.select(f"COPY ({rows}) TO '{target}' (FORMAT parquet, COMPRESSION zstd)")


def _begins_as_duckdb(file: Path) -> bool:
    """Return whether a file has the mark of DuckDB's format, "DUCK" after a check sum of 8 bytes.

    Raises:
        FileError: it cannot be read.
    """
    try:
        with file.open("rb") as opened:
            return opened.read(12)[8:] == b"DUCK"
    except OSError as error:
        raise FileError(f"cannot be opened: {reason_of(error)}", file=file, remedy="Check the file") from None


@contextmanager
def interruptible() -> Iterator[None]:
    """Raise KeyboardInterrupt where Ctrl-C ends a query of the block: DuckDB raises a bare RuntimeError there."""
    try:
        yield
    except duckdb.InterruptException:
        raise KeyboardInterrupt from None
    except RuntimeError as error:
        if str(error) != "Query interrupted":
            raise
        raise KeyboardInterrupt from None


@contextmanager
def writing(file: Path) -> Iterator[None]:
    """Say in words what DuckDB, or the system, cannot write in the block.

    Raises:
        UnwritableError: as where the disk is full.
    """
    try:
        yield
    except (duckdb.IOException, duckdb.FatalException, duckdb.TransactionException, OSError) as error:
        said = reason_of(error) if isinstance(error, OSError) else str(error).strip().splitlines()[0].lower()
        reason = next((known for known in ("no space left on device", "file too large") if known in said), said)
        raise UnwritableError(f"cannot be written: {reason}", file=file, remedy="Check the folder") from None


def create_tables(connection: duckdb.DuckDBPyConnection, joints: int, catalog: str = "") -> None:
    """Create the three tables, in an attached catalog if one is named (`name.`)."""
    listed = ", ".join(f"{name} {kind}" for name, kind in columns(joints).items())
    connection.execute(f"CREATE TABLE {catalog}configurations ({listed})")
    connection.execute(f"CREATE TABLE {catalog}batches (batch INTEGER PRIMARY KEY, drawn INTEGER, accepted INTEGER)")
    connection.execute(f"CREATE TABLE {catalog}metadata (key VARCHAR PRIMARY KEY, value VARCHAR)")


@contextmanager
def aside(file: Path, suffix: str) -> Iterator[Path]:
    """Give a path beside a database for a new one; what a failure leaves there is removed."""
    path = file.with_name(file.name + suffix)
    parts = (path, path.with_name(path.name + ".wal"))

    def remove() -> None:
        for part in parts:
            part.unlink(missing_ok=True)

    remove()
    try:
        yield path
    finally:
        remove()


def create(file: Path, identity: Identity, facts: dict[str, Any]) -> Database:
    """Make a new, empty database; it appears whole or not at all.

    Args:
        file: the database; its folder is made.
        identity: what it belongs to.
        facts: further metadata, data for JSON.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    with aside(file, ".partial") as partial:
        with duckdb.connect(str(partial)) as connection:
            create_tables(connection, len(identity.robot["joints"]))
            facts = {"application": APPLICATION, "format": FORMAT, **facts}
            rows = [(key, json.dumps(value)) for key, value in facts.items()]
            rows.append(("identity", identity.to_json()))
            connection.executemany("INSERT INTO metadata VALUES (?, ?)", rows)
        partial.replace(file)
    return Database.open(file, read_only=False)


def set_metadata(database: Database, key: str, value: Any) -> None:
    """Set one value of the metadata, data for JSON."""
    database.connection.execute("INSERT OR REPLACE INTO metadata VALUES (?, ?)", [key, json.dumps(value)])


def identity_of(database: Database) -> Identity:
    """Return robot, enclosure and margins that a database belongs to."""
    rows = database.select("SELECT value FROM metadata WHERE key = 'identity'")
    return Identity.from_json(rows[0][0])


def require_identity(database: Database, wanted: Identity) -> None:
    """Refuse a database unless it belongs to this robot, enclosure and margins.

    Raises:
        DatabaseMismatchError: it does not; the message says in what it differs.
    """
    differences = identity_of(database).differences(wanted)
    if differences:
        raise DatabaseMismatchError(
            "was made for " + " and ".join(differences),
            file=database.file,
            remedy="Build one for this robot and scene, or use the scene it was made for",
        )
