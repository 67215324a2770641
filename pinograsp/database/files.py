"""Database files that are made: whole or not at all, and in words where that fails."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import duckdb

from ..disk import reason_of
from ..errors import UnwritableError
from .identity import Identity
from .layout import APPLICATION, FORMAT, create_tables


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


def create(file: Path, identity: Identity, facts: dict[str, Any]) -> None:
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
