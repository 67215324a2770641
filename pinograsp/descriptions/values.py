"""Types of the values in robot and scene files: numbers, names, vectors, intervals, tables; one definition each.

Vectors are tuples when they have been read; lists and NumPy arrays are taken for them, which type checkers know. Tables
of named parts become mappings that cannot be written.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, TypeVar

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, FiniteFloat, WrapSerializer
from pydantic_core import PydanticCustomError, PydanticKnownError

from ..errors import close_names
from ..frozen import FrozenMapping

if TYPE_CHECKING:
    from ..arrays import Numbers, Rows, Takes

ABSENT = object()
"""In place of a `format` that a file does not give."""
FARTHEST = 1e9
"""Greatest number, in any unit: nothing that is meant has more, and powers of much greater ones overflow."""
NEAREST = 1e-9
"""Least positive number, in any unit, where nothing is not allowed: what is divided by it does not overflow."""
LEAST_SIZE = 1e-5
"""Of a shape, m: what is smaller is no body, and computations with it are about nothing but rounding."""


def wrong(problem: str, *path: str | int, remedy: str | None = None) -> PydanticCustomError:
    """Return what a validator raises: the problem is with the key at `path` below the part that it validates."""
    return PydanticCustomError("wrong", "{problem}", {"problem": problem, "path": path, "remedy": remedy})


def wrong_name(problem: str, name: str, known: list[str], *path: str | int) -> PydanticCustomError:
    """Return what a validator raises where a name is none of those known; the remedy lists close ones."""
    context = {"problem": problem, "path": path, "remedy": close_names(name, known)}
    return PydanticCustomError("unknown_name", "{problem}", context)


def _number(value: object) -> object:
    """Refuse booleans and texts as numbers; -0 is 0: equal content has one digest."""
    if isinstance(value, bool | np.bool_):
        raise ValueError(f"a number is wanted, not {value}")
    if isinstance(value, str | bytes | bytearray):  # which pydantic would read as numbers
        raise PydanticKnownError("float_type")
    return 0.0 if isinstance(value, float) and value == 0.0 else value


def _in_reach(number: float) -> float:
    if abs(number) > FARTHEST:
        raise wrong(f"a number between {-FARTHEST:g} and {FARTHEST:g} is wanted (given: {number!r})")
    return number


def _not_tiny(number: float) -> float:
    if 0.0 < number < NEAREST:
        raise wrong(f"a number of {NEAREST:g} or more is wanted (given: {number!r})")
    return number


def _has_size(size: float) -> float:
    if 0.0 < size < LEAST_SIZE:
        raise wrong(f"a size of {LEAST_SIZE:g} m or more is wanted (given: {size!r})", remedy="Sizes are in metres")
    return size


def _format(value: object) -> object:
    if value is ABSENT:
        raise PydanticKnownError("missing")
    return _number(value)


def listed(value: object) -> object:
    """Return a NumPy array as a list; refuse what has no order or can be read only once."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if not isinstance(value, list | tuple):
        raise PydanticKnownError("tuple_type")
    return value


LONGEST_NAME = 64
"""Bytes, as UTF-8, of a name that becomes part of a file's name: three of them and more are in one, of 255 at most."""


def _fit_for_files(name: str) -> str:
    if "/" in name or "\\" in name:
        raise ValueError("a slash is not allowed: the name becomes part of a file's name")
    for character in name:
        if unicodedata.category(character) in {"Cc", "Cf", "Cs", "Zl", "Zp"}:
            shown = f"U+{ord(character):04X}"
            raise ValueError(f"the invisible character {shown} is not allowed: the name becomes part of a file's name")
    if (size := len(name.encode())) > LONGEST_NAME:
        said = f"{size} bytes (UTF-8) are too long, {LONGEST_NAME} are allowed: the name becomes part of a file's name"
        raise ValueError(said)
    return name


def _without_null(file: Path) -> Path:
    if "\0" in str(file):
        raise ValueError("no file has the character U+0000 in its name")
    return file


Format1 = Annotated[Literal[1], BeforeValidator(_format)]
Number = Annotated[FiniteFloat, BeforeValidator(_number), AfterValidator(_in_reach)]
Positive = Annotated[Number, Field(gt=0.0), AfterValidator(_not_tiny)]
NotNegative = Annotated[Number, Field(ge=0.0)]
Size = Annotated[Positive, AfterValidator(_has_size)]
"""Of a shape, m."""
SizeOrNone = Annotated[NotNegative, AfterValidator(_has_size)]
"""Of a shape, m; may be 0."""
Name = Annotated[str, Field(min_length=1)]
FileName = Annotated[Name, AfterValidator(_fit_for_files)]
"""A name that becomes part of a file's name."""
FilePath = Annotated[Path, AfterValidator(_without_null)]
"""Of a file or folder, which may be there."""
Interval = Annotated[tuple[Number, Number], BeforeValidator(listed)]


def ordered(interval: tuple[float, float], *path: str | int) -> tuple[float, float]:
    """Return the interval, or raise what a validator raises if its lower end is not below the upper one."""
    if interval[0] >= interval[1]:
        raise wrong(f"the lower end {interval[0]:g} is not below the upper end {interval[1]:g}", *path)
    return interval


def _not_above(interval: tuple[float, float]) -> tuple[float, float]:
    if interval[0] > interval[1]:
        raise wrong(f"the lower end {interval[0]:g} is above the upper end {interval[1]:g}")
    return interval


def _unit(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    length = float(np.linalg.norm(vector))
    if abs(length - 1.0) > 1e-6:
        raise wrong(f"must have length 1, not {length:.4g}")
    return vector


Key = TypeVar("Key")
Value = TypeVar("Value")


def _frozen(table: Mapping[str, Any]) -> FrozenMapping[Any]:
    return FrozenMapping(table)


def _written(table: Mapping[str, Any], write: Callable[[dict[str, Any]], Any]) -> Any:
    return write(dict(table))


Table = Annotated[Mapping[Key, Value], AfterValidator(_frozen), WrapSerializer(_written)]
"""Parts by name; cannot be written."""


def empty() -> Any:
    """Return a table without entries, whatever its field takes."""
    return FrozenMapping({})


def as_default(value: object) -> Any:
    """Return a value as the default of a field below, whose type has no values for type checkers."""
    return value


MOST_POINTS = 1000
"""Of a list of points: each costs time wherever the list is looked at."""

if TYPE_CHECKING:
    Vector3: TypeAlias = Takes[Numbers, tuple[float, float, float]]
    Sizes3: TypeAlias = Vector3
    UnitVector3: TypeAlias = Vector3
    OptionalVector3: TypeAlias = Takes[Numbers | None, tuple[float, float, float] | None]
    Points: TypeAlias = Takes[Rows, tuple[tuple[float, float, float], ...]]
    OptionalContactPoints: TypeAlias = Takes[Rows | None, tuple[tuple[float, float, float], ...] | None]
    OrderedInterval: TypeAlias = Takes[Numbers, tuple[float, float]]
    Ranges: TypeAlias = Takes[Mapping[str, Numbers], Mapping[str, tuple[float, float]]]
else:
    Vector3 = Annotated[tuple[Number, Number, Number], BeforeValidator(listed)]
    Sizes3 = Annotated[tuple[Size, Size, Size], BeforeValidator(listed)]
    UnitVector3 = Annotated[Vector3, AfterValidator(_unit)]
    OptionalVector3 = Vector3 | None
    Points = Annotated[tuple[Vector3, ...], Field(min_length=1, max_length=MOST_POINTS), BeforeValidator(listed)]
    OptionalContactPoints = Annotated[tuple[Vector3, ...], Field(min_length=2), BeforeValidator(listed)] | None
    OrderedInterval = Annotated[Interval, AfterValidator(ordered)]
    """An interval that has a width."""
    Ranges = Table[Name, Annotated[Interval, AfterValidator(_not_above)]]
    """Intervals by name that may have no width."""
