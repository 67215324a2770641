"""What the DuckDB file holds: three tables, and the names and texts of its SQL.

configurations   one row a collision-free arm configuration (columns: see `columns`)
batches          batch, drawn, accepted: which batches of samples the rows come from
metadata         key and value (JSON): format, identity, seed, spread, layout, size, versions
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import duckdb
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ..descriptions.problems import input_error
from ..errors import DamagedError
from .identity import IdentityContent
from .spread import Spread

FORMAT = 1
APPLICATION = "pinograsp start database"
METADATA = {"key": "VARCHAR", "value": "VARCHAR"}
"""Columns of `metadata` with their SQL types."""
BATCHES = dict.fromkeys(("batch", "drawn", "accepted"), "INTEGER")
"""Columns of `batches` with their SQL types."""
COLUMNS = """
    SELECT table_name, column_name, data_type || coalesce(' ' || column_default, '')
    FROM duckdb_columns() WHERE NOT internal AND database_name = current_database()
    UNION ALL SELECT view_name, '', 'VIEW' FROM duckdb_views() WHERE NOT internal
    UNION ALL SELECT function_name, '', 'MACRO' FROM duckdb_functions() WHERE NOT internal
"""
"""Asks for the columns of all tables, and for what has no place there."""


def columns(joints: int) -> dict[str, str]:
    """Return the columns of `configurations` with their SQL types.

    q1 .. ql: arm joints in the order of the robot file, rad (m); x, y, z: wrist position, m, world; ax, ay, az:
    approach direction (the wrist's z axis), world; clearance: least distance to walls, obstacles and itself, m,
    at most 0.05; cell: Morton index of the wrist position; sample: number of the random sample.
    """
    angles = {f"q{i}": "FLOAT" for i in range(1, joints + 1)}
    vectors = dict.fromkeys(("x", "y", "z", "ax", "ay", "az", "clearance"), "FLOAT")
    return {**angles, **vectors, "cell": "UINTEGER", "sample": "BIGINT"}


def exported(joints: Sequence[str]) -> list[str]:
    """Return the names of the columns of an export, in the order of `columns`.

    A joint has its own name, and q1, q2, ... by its number where another column has that already: no two columns may
    have the same, whatever the case.
    """
    numbered = columns(len(joints))
    others = [name for name in numbered if not name.startswith("q")]
    taken, names = set(others), list[str]()
    for number, joint in zip(numbered, joints, strict=False):
        name = number if joint.lower() in taken else joint
        while name.lower() in taken:
            name += "_"
        taken.add(name.lower())
        names.append(name)
    return names + others


class Metadata(BaseModel):
    """The content of `metadata`."""

    model_config = ConfigDict(strict=True, extra="forbid")

    application: Literal["pinograsp start database"]
    format: Literal[1]
    identity: IdentityContent
    seed: Annotated[int, Field(ge=0)]
    spread: Spread
    layout: Literal["sorted", "unsorted"]
    size: Annotated[int, Field(ge=0)]
    versions: dict[str, str]


def require_layout(
    file: Path, tables: Mapping[str, Mapping[str, str]], metadata: Callable[[], Mapping[str, Any]]
) -> None:
    """Refuse a file with other tables, columns or metadata than `create` makes.

    Args:
        file: the database.
        tables: columns of its tables with their SQL types.
        metadata: gives its metadata, if there is a table of them.

    Raises:
        DamagedError: it is none of ours, or damaged.
    """
    problem, remedy = f"is a DuckDB file, but not a {APPLICATION}", "Name another file"
    if tables.get("metadata") != METADATA:
        raise DamagedError(f"{problem}; it was left as it is", file=file, remedy=remedy)
    found = metadata()
    if found.get("application") != APPLICATION or found.get("format") != FORMAT:
        problem = f"is not a {APPLICATION} of format {FORMAT}"
        raise DamagedError(f"{problem}; it was left as it is", file=file, remedy=remedy)
    try:
        facts = Metadata.model_validate(found)
    except ValidationError as error:
        wrong = input_error(error, Metadata, found)
        raise DamagedError(f"is damaged: metadata: {wrong.problem}", file=file, key=wrong.key) from None
    wanted = {"configurations": columns(len(facts.identity.robot.joints)), "batches": BATCHES, "metadata": METADATA}
    if tables != wanted:
        different = [name for name in {**wanted, **tables} if wanted.get(name) != tables.get(name)]
        problem = f"is damaged: other tables or columns than those of a {APPLICATION}: {', '.join(different)}"
        raise DamagedError(problem, file=file)


def create_tables(connection: duckdb.DuckDBPyConnection, joints: int, catalog: str = "") -> None:
    """Create the three tables, in an attached catalog if one is named (`name.`)."""
    listed = ", ".join(f"{name} {kind}" for name, kind in columns(joints).items())
    connection.execute(f"CREATE TABLE {catalog}configurations ({listed})")
    for table, parts in (("batches", BATCHES), ("metadata", METADATA)):
        (key, kind), *others = parts.items()
        listed = ", ".join((f"{key} {kind} PRIMARY KEY", *(f"{name} {other}" for name, other in others)))
        connection.execute(f"CREATE TABLE {catalog}{table} ({listed})")


def identifier(name: str) -> str:
    """Return a name as an identifier of SQL, whatever is in it."""
    return '"' + name.replace('"', '""') + '"'


def literal(text: Path | str) -> str:
    """Return a text as a literal of SQL, whatever is in it."""
    return "'" + str(text).replace("'", "''") + "'"
