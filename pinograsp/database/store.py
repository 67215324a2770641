"""The DuckDB file, opened.

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
import numpy as np
from numpy.typing import NDArray

from ..disk import as_path, is_file, is_folder, reason_of, written_whole
from ..errors import DamagedError, DatabaseMismatchError, FileError
from ..interrupts import heard
from .files import writing
from .identity import Identity
from .layout import COLUMNS, columns, exported, identifier, literal, require_layout

Answer = TypeVar("Answer")

AGAIN = 0.02
"""Seconds after which a query that has not ended is told so again: it may not have begun when it was told."""


LIMITS: dict[str, str | bool | int | float | list[str]] = {"memory_limit": "2GB"}
"""Settings of every connection."""
CLOSED: dict[str, str | bool | int | float | list[str]] = {**LIMITS, "enable_external_access": "false"}
"""Settings of connections to files that anybody may have made: nothing that is in them reads or writes another file."""
DAMAGED = "is damaged or not a DuckDB file; it was left as it is"
NOT_FINITE = "is damaged: there is a row with a number that is missing or not finite"


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
            raise DamagedError(DAMAGED, file=path)
        if not read_only:  # what it holds is seen before anything can reach beyond it
            cls.open(path).close()
        try:
            connection = duckdb.connect(str(path), read_only=read_only, config=CLOSED if read_only else LIMITS)
        except duckdb.IOException as error:
            if "permission denied" in str(error).lower():
                raise FileError("cannot be opened: permission denied", file=path, remedy="Check the file") from None
            if "lock" in str(error).lower():
                raise FileError("is in use by another process", file=path, remedy="Wait until it is done") from None
            raise DamagedError(DAMAGED, file=path) from None
        except duckdb.ConnectionException:
            mode = "for writing" if read_only else "for reading"
            raise FileError(f"is open in this process {mode}", file=path, remedy="Close it first") from None
        except duckdb.Error:
            raise DamagedError(DAMAGED, file=path) from None
        database, tables = cls(path, connection), dict[str, dict[str, str]]()
        try:
            for table, column, kind in database.select(COLUMNS):
                tables.setdefault(table, {})[column] = kind
            require_layout(path, tables, database.metadata)
        except FileError:
            database.close()
            raise
        return database

    def require_sound(self) -> None:
        """Read every row, and refuse a number that is missing or not finite.

        Raises:
            DamagedError: there is one, or the rows cannot be read.
        """
        angles = " AND ".join(
            f"isfinite({name})" for name, kind in columns(len(self.joints())).items() if kind == "FLOAT"
        )
        if self.select(f"SELECT count(*) FROM configurations WHERE NOT coalesce({angles}, false)") != [(0,)]:
            raise DamagedError(NOT_FINITE, file=self.file)

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
        with self._sound():
            return self.run(lambda: self.connection.execute(sql, values).fetchall())

    def select_columns(self, sql: str, values: Mapping[str, Any] | None = None) -> dict[str, NDArray[Any]]:
        """Return the rows of a query as one array for each column.

        Args:
            sql: as for `select`.
            values: as for `select`.
        """
        with self._sound():
            found = self.run(lambda: dict(self.connection.execute(sql, values).fetchnumpy()))
        if any(np.ma.is_masked(column) or not np.isfinite(column).all() for column in found.values()):
            raise DamagedError(NOT_FINITE, file=self.file)
        return found

    @contextmanager
    def _sound(self) -> Iterator[None]:
        """Take what DuckDB cannot read in the block for damage: the queries are ours, and right."""
        try:
            yield
        except duckdb.InterruptException:
            raise
        except duckdb.Error as error:
            raise DamagedError(f"is damaged: {str(error).splitlines()[0]}", file=self.file) from None

    def run(self, query: Callable[[], Answer]) -> Answer:
        """Return the answer of a query of the connection, for which a thread of its own waits; errors are DuckDB's.

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
        try:
            return {key: json.loads(value) for key, value in self.select("SELECT key, value FROM metadata")}
        except (TypeError, ValueError, RecursionError):
            raise DamagedError("is damaged: its metadata are no JSON", file=self.file, key="metadata") from None

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

        The file is there whole or not at all. Its columns are those of `exported`.

        Raises:
            UnwritableError: the file cannot be written.
            FileError: what is there is no Parquet file.
        """
        path = as_path("file", file)
        _require_parquet(path)
        self.require_sound()
        there, wanted = columns(len(self.joints())), exported(self.joints())
        listed = ", ".join(f"{name} AS {identifier(shown)}" for name, shown in zip(there, wanted, strict=True))
        # Of what is open here nothing can be written anywhere: another connection reads the file, and no other file.
        with written_whole(path) as unfinished, duckdb.connect(config=LIMITS) as writer, writing(path):
            writer.execute(f"ATTACH {literal(self.file)} AS source (READ_ONLY)")
            writer.execute(f"SET allowed_directories = [{literal(unfinished.parent)}]")
            writer.execute("SET enable_external_access = false")
            rows = f"SELECT {listed} FROM source.configurations"
            target = literal(unfinished)
            copy = f"COPY ({rows}) TO {target} (FORMAT parquet, COMPRESSION zstd)"
            Database(path, writer).run(lambda: writer.execute(copy))


def _require_parquet(file: Path) -> None:
    """Refuse to put an export in the place of what is no Parquet file, such as the database itself."""
    if is_folder(file):
        raise FileError("is a folder", file=file, remedy="Name the Parquet file in it")
    if is_file(file):
        with file.open("rb") as opened:
            if opened.read(4) not in {b"PAR1", b""}:
                raise FileError("is there and is no Parquet file", file=file, remedy="Give the export another name")


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
