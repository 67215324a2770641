"""Values that nobody can change: arrays, mappings, and records of them; compared exactly, pickled, written as JSON.

What a record holds is frozen when it is made, all the way down: arrays are read-only copies, mappings are
`FrozenMapping`, lists are tuples. Two records are equal if everything that they hold is: arrays in every number, and
not a number equals itself. The JSON data of a record has its fields by their own names.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from types import NoneType
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from .errors import UnknownNameError, close_names

Value = TypeVar("Value", covariant=True)

_ATOMS = frozenset({bool, float, int, str, NoneType})
"""Types of what is frozen already; asked before `frozen` is called, since grasps cross processes by the thousand."""
_BRIEF = 6
"""Numbers of an array, or entries of a mapping or a tuple, that a representation shows."""


class FrozenMapping(Mapping[str, Value]):
    """Values by name, in an order, that cannot be written; `{**mapping, name: value}` makes a changed one.

    Raises:
        UnknownNameError: (a `KeyError`, when a name is looked up) there is none of this name; close ones are named.
    """

    __slots__ = ("_content",)

    def __init__(self, content: Mapping[str, Value]) -> None:
        self._content = {n: part if type(part) in _ATOMS else frozen(part) for n, part in content.items()}

    def __getitem__(self, name: str) -> Value:
        try:
            value: Value = self._content[name]
            return value
        except KeyError:
            raise unknown(name, self) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._content)

    def __len__(self) -> int:
        return len(self._content)

    def __contains__(self, name: object) -> bool:
        return name in self._content

    def get(self, name: str, default: Any = None) -> Any:
        """Return the value of a name, or a default."""
        return self._content.get(name, default)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mapping) and same(self, other)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[object, ...]:
        return (FrozenMapping, (self._content,))

    def __repr__(self) -> str:
        return repr(self._content)


@dataclass(frozen=True, eq=False, repr=False)
class Record:
    """Base of dataclasses that are frozen in fact; those are `@dataclass(frozen=True, eq=False, repr=False)`, too.

    Fields with `compare=False` do not count when records are compared, fields with `repr=False` are not shown.
    """

    not_in_json: ClassVar[tuple[str, ...]] = ()
    """Fields that JSON data does not have."""
    also_in_json: ClassVar[tuple[str, ...]] = ()
    """Properties that JSON data has besides the fields."""

    def __post_init__(self) -> None:
        """Freeze what the fields hold."""
        self.__setstate__(self.__dict__)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Hold values by field, frozen: arrays of what was pickled or copied come back writable."""
        content = self.__dict__
        for name, value in state.items():
            content[name] = value if type(value) in _ATOMS else frozen(value)

    def __eq__(self, other: object) -> bool:
        """Whether another record of the same class holds the same."""
        if type(other) is not type(self):
            return NotImplemented
        return all(same(getattr(self, f.name), getattr(other, f.name)) for f in fields(self) if f.compare)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        shown = (f"{field.name}={brief(getattr(self, field.name))}" for field in fields(self) if field.repr)
        return f"{type(self).__name__}({', '.join(shown)})"

    @classmethod
    def of_json(cls, values: Mapping[str, Any]) -> Self:
        """Return the record of values by field, as they were read from JSON data."""
        return cls(**values)

    def to_json(self) -> dict[str, Any]:
        """Return the content as JSON data, by attribute: SI units and radians, numbers that are not finite None."""
        names = [field.name for field in fields(self) if field.name not in self.not_in_json]
        return {name: json_data(getattr(self, name)) for name in (*names, *self.also_in_json)}


def frozen(value: Any) -> Any:
    """Return a value as records hold it; an array that somebody else could write is copied."""
    kind = type(value)
    if kind in _ATOMS or kind is FrozenMapping or isinstance(value, Record):
        return value
    if kind is tuple or kind is list:
        return tuple([part if type(part) in _ATOMS else frozen(part) for part in value])
    if isinstance(value, np.ndarray):
        return _read_only(value)
    if isinstance(value, Mapping):
        return FrozenMapping(value)
    return value


def _read_only(array: Any) -> Any:
    if array.base is None and not array.flags.writeable:
        return array
    copied = np.array(array)
    copied.flags.writeable = False
    return copied


def same(one: Any, other: Any) -> bool:
    """Whether two values are equal in all that they hold; lists and tuples are alike, so are mappings."""
    if one is other:
        return True
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return type(one) is type(other) and np.array_equal(one, other, equal_nan=True)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, Mapping) and isinstance(other, Mapping) and not isinstance(one, Record):  # a certificate is both
        return one.keys() == other.keys() and all(same(value, other[name]) for name, value in one.items())
    return bool(one == other or (one != one and other != other))


def json_data(value: Any) -> Any:
    """Return a value that records hold as JSON data; numbers that are not finite, which JSON lacks, are None."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Record):
        return value.to_json()
    if isinstance(value, np.ndarray):
        return json_data(value.tolist())
    if isinstance(value, Mapping):
        return {name: json_data(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [json_data(part) for part in value]
    return value


def unknown(name: object, known: Mapping[str, Any]) -> UnknownNameError:
    """Return the error of a name that is none of those known, with the names that are close to it."""
    return UnknownNameError(f"there is no {name!r}", remedy=close_names(str(name), list(known)))


def brief(value: Any) -> str:
    """Return a value in few words."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, np.ndarray):
        if value.size > _BRIEF:
            return f"<array of shape {value.shape}>"
        return np.array2string(value, precision=4, suppress_small=True, separator=", ").replace("\n", "")
    if isinstance(value, FrozenMapping) and len(value) > _BRIEF:
        return f"{{{len(value)} entries}}"
    if isinstance(value, FrozenMapping):
        return "{" + ", ".join(f"{name!r}: {brief(part)}" for name, part in value.items()) + "}"
    if isinstance(value, tuple) and len(value) > _BRIEF:
        return f"({len(value)} of {type(value[0]).__name__})"
    if isinstance(value, tuple):
        return "(" + ", ".join(map(brief, value)) + ("," if len(value) == 1 else "") + ")"
    return repr(value)
