"""Regions of a database, and starts that spread over them.

A region is a ball or a box around a point, optionally with a cone of approach directions and intervals of joints. The
comparisons of x, y, z let DuckDB skip every row group outside: rows lie in the order of a space-filling curve of the
wrist position.

A spread selection divides the region into classes (cell of the wrist position, approach direction by its largest
component, signs of the sines of the first four joints) and takes one row of each class in turn, instead of the
neighbours that a plain LIMIT would give.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array, Numbers, real_array
from ..errors import InputError, UnknownNameError, close_names, real_number, require_kind, whole_number
from ..frozen import Record
from ..geometry.cone import DirectionCone
from .store import Database

_CANDIDATES = 40
"""Rows a selection looks at for every row that it returns, at most."""
ALL = 1e9
"""Half edge of a region that holds every configuration, m: larger numbers are none of the columns'."""
_CELLS = 6
"""Cells along each axis of a region, for the spread."""
_ROUND = "xor({0}, {0} >> 15) * 1540483477 % 4294967296"
_HASH = _ROUND.format("(" + _ROUND.format("((sample + $offset::BIGINT) % 4294967296)") + ")")
"""A scattered number of each sample and offset, from 0 to 2^32 - 1 (products stay below 2^63)."""
_STRIDE = 1000003
"""Offset from one seed to the next; offsets are below 2^32."""

Intervals = Mapping[str, Sequence[tuple[float, float]]]
"""Arm joints by name, with intervals, rad (m), of which one must hold the angle."""


@dataclass(frozen=True, eq=False, repr=False)
class Configurations(Record):
    """Rows of a database, from `configurations_near` or `spread_configurations`."""

    joints: tuple[str, ...]
    """Names of the l arm joints, in the order of the robot file."""
    q: Array
    """Their values, rad (m), shape (N, l)."""
    positions: Array
    """Wrist positions, m, world, shape (N, 3)."""
    approaches: Array
    """Approach directions, world, shape (N, 3)."""
    clearances: Array
    """Least distance of the robot to the enclosure, obstacles and itself, m, shape (N,)."""
    samples: Array
    """Numbers of the samples, shape (N,)."""

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.q)


def configurations_near(
    database: Database,
    center: Numbers,
    extent: float | Numbers,
    *,
    cone: DirectionCone | None = None,
    joints: Intervals | None = None,
    limit: int | None = None,
) -> Configurations:
    """Return configurations whose wrist is near a point, in the order of the file.

    Args:
        database: an open database.
        center: m, world, shape (3,).
        extent: radius of a ball, m, or half edges of a box, m, shape (3,).
        cone: approach directions wanted, world.
        joints: intervals of arm joints wanted.
        limit: at most so many rows.

    Raises:
        UnknownNameError: the database has no arm joint of a name.
        InputError: a number is out of range or not finite.
    """
    if limit is not None:
        whole_number("limit", limit, 0)
    where, values = _condition(database, center, extent, cone, joints or {})
    most = "" if limit is None else f" LIMIT {int(limit)}"
    return _fetch(database, f"SELECT {_listed(database)} FROM configurations WHERE {where}{most}", values)


def spread_configurations(
    database: Database,
    center: Numbers,
    extent: float | Numbers,
    count: int,
    *,
    cone: DirectionCone | None = None,
    joints: Intervals | None = None,
    seed: int = 0,
) -> Configurations:
    """Return up to `count` configurations of a region, spread over wrist position, approach and posture.

    Args:
        database: an open database.
        center: m, world, shape (3,).
        extent: radius of a ball, m, or half edges of a box, m, shape (3,).
        count: number of configurations wanted.
        cone: approach directions wanted, world.
        joints: intervals of arm joints wanted.
        seed: of the choice within each class.

    Raises:
        UnknownNameError: the database has no arm joint of a name.
        InputError: a number is out of range or not finite.
    """
    whole_number("count", count, 0)
    seed = whole_number("seed", seed, 0, None)
    where, values = _condition(database, center, extent, cone, joints or {})
    counted = database.select(f"SELECT count(*) FROM configurations WHERE {where}", values)
    there = int(counted[0][0])
    share = min(1.0, _CANDIDATES * count / there) if there else 1.0
    values |= {"offset": seed * _STRIDE % 2**32, "below": int(share * 2**32)}
    cell = 2.0 * float(np.max(extent)) / _CELLS
    signs = ", ".join(f"sin(q{i}) > 0" for i in range(1, min(len(database.joints()), 4) + 1))
    largest = "greatest(abs(ax), abs(ay), abs(az))"
    facing = f"CASE {largest} WHEN abs(ax) THEN 2 + sign(ax) WHEN abs(ay) THEN 12 + sign(ay) ELSE 22 + sign(az) END"
    classes = f"floor(x / {cell}), floor(y / {cell}), floor(z / {cell}), {facing}, {signs}"
    sql = (
        f"SELECT {_listed(database)} FROM (SELECT *, {_HASH} AS scattered FROM configurations WHERE {where}) "
        f"WHERE scattered < $below "
        f"ORDER BY row_number() OVER (PARTITION BY {classes} ORDER BY scattered, sample), scattered, sample "
        f"LIMIT {int(count)}"
    )
    return _fetch(database, sql, values)


def nearest_wrist(database: Database, point: Numbers) -> float:
    """Return the distance of the nearest wrist position from a point, world, shape (3,), m; infinite if there is none.

    Raises:
        InputError: a number is not finite.
    """
    values = dict(zip("abc", real_array("point", point, 3).tolist(), strict=True))
    square = database.select("SELECT min((x - $a) ** 2 + (y - $b) ** 2 + (z - $c) ** 2) FROM configurations", values)
    return math.inf if square[0][0] is None else math.sqrt(square[0][0])


def _condition(
    database: Database, center: Numbers, extent: float | Numbers, cone: DirectionCone | None, joints: Intervals
) -> tuple[str, dict[str, Any]]:
    """Return a WHERE clause with its parameters."""
    require_kind("database", database, Database, remedy="Open it with `Database.open`")
    ball = np.ndim(extent) == 0
    half = real_array("extent", np.broadcast_to(extent, 3) if ball else extent, 3)
    real_number("extent", half.min(), 0.0)
    half, middles = np.minimum(half, ALL), np.clip(real_array("center", center, 3), -ALL, ALL)
    values: dict[str, Any] = {}
    parts = []
    for name, middle, reach in zip("xyz", middles.tolist(), half.tolist(), strict=True):
        values |= {f"{name}_low": middle - reach, f"{name}_high": middle + reach}
        # FLOAT bounds, like the column: a comparison in DOUBLE could not use the row groups' statistics.
        parts.append(f"{name} BETWEEN ${name}_low::FLOAT AND ${name}_high::FLOAT")
        if ball:
            values[f"{name}_center"] = middle
    if ball:
        square = " + ".join(f"({name} - ${name}_center) ** 2" for name in "xyz")
        parts.append(f"{square} <= $radius ** 2")
        values["radius"] = float(half[0])
    if cone is not None:
        require_kind("cone", cone, DirectionCone)
        values |= {
            "cone_x": cone.axis[0],
            "cone_y": cone.axis[1],
            "cone_z": cone.axis[2],
            "cosine": math.cos(cone.half_angle),
        }
        parts.append("ax * $cone_x + ay * $cone_y + az * $cone_z >= $cosine")
    known = database.joints() if joints else []
    for name, intervals in joints.items():
        if name not in known:
            raise UnknownNameError(f"there is no arm joint {name!r}", key="joints", remedy=close_names(name, known))
        column = f"q{known.index(name) + 1}"
        choices = []
        for number, (low, high) in enumerate(intervals):
            if not low <= high:
                raise InputError(f"{low:g} .. {high:g} is no interval of {name}", key="joints")
            values |= {f"{column}_low{number}": low, f"{column}_high{number}": high}
            choices.append(f"{column} BETWEEN ${column}_low{number} AND ${column}_high{number}")
        parts.append(f"({' OR '.join(choices) or 'false'})")
    return " AND ".join(parts), values


def _listed(database: Database) -> str:
    angles = ", ".join(f"q{i}" for i in range(1, len(database.joints()) + 1))
    return f"{angles}, x, y, z, ax, ay, az, clearance, sample"


def _fetch(database: Database, sql: str, values: dict[str, Any]) -> Configurations:
    columns = database.select_columns(sql, values)

    def stacked(*names: str) -> Array:
        return np.column_stack([np.asarray(columns[name], dtype=float) for name in names])

    angles = [name for name in columns if name.startswith("q")]
    return Configurations(
        tuple(database.joints()),
        stacked(*angles),
        stacked("x", "y", "z"),
        stacked("ax", "ay", "az"),
        np.asarray(columns["clearance"], dtype=float),
        np.asarray(columns["sample"]),
    )
