"""Marks in the types of a record's fields: what JSON data may hold there, where the type alone does not say it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any

from .arrays import Array
from .errors import MOST


@dataclass(frozen=True)
class Shape:
    """An array has these sizes; without the mark it is a vector of any length."""

    sizes: tuple[int, ...]


@dataclass(frozen=True)
class Null:
    """A number may be null, which stands for one that is not finite."""

    value: float
    """The number that is taken for it."""


@dataclass(frozen=True)
class Whole:
    """A whole number is within these bounds; without the mark from 0 to `MOST`."""

    least: int
    most: int | None = MOST
    """None: however great."""


@dataclass(frozen=True)
class Pattern:
    """A text fits a regular expression as a whole."""

    expression: re.Pattern[str]
    words: str
    """The same as an error says it."""


@dataclass(frozen=True)
class Keys:
    """A mapping has keys of its own, each with its type: those of a `TypedDict`."""

    block: type


@dataclass(frozen=True)
class Names:
    """A mapping has only names that are words of a `Literal`."""

    words: Any


Vector = Annotated[Array, Shape((3,))]
Transform = Annotated[Array, Shape((4, 4))]
Sha256 = Annotated[str, Pattern(re.compile("[0-9a-f]{64}"), "64 hexadecimal digits are wanted")]
