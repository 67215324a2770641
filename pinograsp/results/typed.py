"""JSON data into what a type says: `Result` with all that it holds is read by the types of its fields.

A record has all of its keys and no more, a number is finite unless its type says what null stands for, an array has
the shape of its type, a word is one of those known. Whoever adds a field to a record has it read and refused.
"""

from __future__ import annotations

import dataclasses
import json
import math
import types
import typing
from collections.abc import Callable, Mapping
from functools import cache
from typing import Annotated, Any, Literal, TypeVar, Union

import numpy as np
from pydantic import ValidationError

from ..arrays import Array
from ..descriptions.model import FileRoot
from ..descriptions.problems import input_error
from ..errors import InputError, close_names
from ..frozen import Record
from ..json_types import Keys, Names, Null, Pattern, Shape, Whole

Mark = TypeVar("Mark")
SHOWN = 80
"""Characters of what is wrong that an error shows."""


def read(kind: Any, data: Any, *marks: Any) -> Any:
    """Return JSON data as a value of a type.

    Args:
        kind: of a field of a record, marks of `json_types` included.
        data: what JSON data has there.
        marks: of the field.

    Raises:
        InputError: it is of another kind; the key is the path from `data` on.
    """
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin is Annotated:
        return read(parts[0], data, *parts[1:], *marks)
    if origin in (types.UnionType, Union):
        given = [part for part in parts if part is not types.NoneType]
        return None if data is None and len(given) < len(parts) else read(given[0], data, *marks)
    if origin is Literal:
        return _word(parts, data)
    if origin is tuple:
        return tuple(part(data, index, parts[0]) for index in range(len(_listed(data))))
    if origin is np.ndarray:
        return _array(data, *marks)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return _named(parts, data, *marks)
    if typing.is_typeddict(kind):
        return _keyed(kind, data)
    if issubclass(kind, Record):
        return _record(kind, data)
    if issubclass(kind, FileRoot):
        return _described(kind, data)
    return _ATOMS[kind](data, *marks)


def part(data: Any, key: str | int, kind: Any) -> Any:
    """Return a part of JSON data as a value of a type; errors as of `read`, with the key before theirs."""
    step = f"[{key}]" if isinstance(key, int) else key
    try:
        return read(kind, data[key])
    except InputError as error:
        inner = error.key or ""
        path = step + ("." if inner and not inner.startswith("[") else "") + inner
        raise InputError(error.problem, key=path, remedy=error.remedy) from None


def shown(data: Any) -> str:
    """Return JSON data in few characters."""
    text = json.dumps(data)
    return text if len(text) <= SHOWN else text[:SHOWN] + " ..."


def _refused(wanted: str, data: Any) -> InputError:
    return InputError(f"{wanted} (given: {shown(data)})")


def _mark(kind: type[Mark], marks: tuple[Any, ...]) -> Mark | None:
    return next((mark for mark in marks if isinstance(mark, kind)), None)


@cache
def _fields(record: Any) -> dict[str, Any]:
    """Return the types of the keys of a record, those that follow from its fields included."""
    hints = typing.get_type_hints(record, include_extras=True)
    names = (field.name for field in dataclasses.fields(record) if field.name not in record.not_in_json)
    own = {name: hints[name] for name in names}
    derived = (getattr(record, name).fget for name in record.also_in_json)
    return own | {getter.__name__: typing.get_type_hints(getter)["return"] for getter in derived}


def _record(kind: Any, data: Any) -> Any:
    keys = _fields(kind)
    values = _block(keys, frozenset(keys), data)
    return kind.of_json({name: value for name, value in values.items() if name not in kind.also_in_json})


def _block(keys: Mapping[str, Any], wanted: frozenset[str], data: Any) -> dict[str, Any]:
    """Return the values of a block that has keys of its own, of which some may be left out."""
    _mapping(data)
    for name in data:
        if name not in keys:
            raise InputError("unknown key", key=name, remedy=close_names(name, keys))
    for name in wanted:
        if name not in data:
            raise InputError("this key is missing", key=name)
    return {name: part(data, name, keys[name]) for name in keys if name in data}


def _keyed(kind: Any, data: Any) -> dict[str, Any]:
    """Return the values of a block whose keys are those of a `TypedDict`."""
    return _block(typing.get_type_hints(kind, include_extras=True), kind.__required_keys__, data)


def _named(parts: tuple[Any, ...], data: Any, *marks: Any) -> dict[str, Any]:
    if (own := _mark(Keys, marks)) is not None:
        return _keyed(own.block, data)
    names = _mark(Names, marks)
    for name in _mapping(data):
        if names is not None and name not in (known := typing.get_args(names.words)):
            raise InputError("unknown key", key=name, remedy=close_names(name, known))
    return {name: part(data, name, parts[1]) for name in data}


def _described(model: type[FileRoot], data: Any) -> FileRoot:
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise input_error(error, model, data) from None


def _mapping(data: Any) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise _refused("a block of keys is wanted", data)
    return data


def _listed(data: Any) -> list[Any]:
    if not isinstance(data, list):
        raise _refused("a list is wanted", data)
    return data


def _word(known: tuple[Any, ...], data: Any) -> str:
    if not isinstance(data, str) or data not in known:
        raise _refused(f"one of {', '.join(known)} is wanted", data)
    return data


def _truth(data: Any) -> bool:
    if not isinstance(data, bool):
        raise _refused("true or false is wanted", data)
    return data


def _text(data: Any, *marks: Any) -> str:
    if not isinstance(data, str):
        raise _refused("a text is wanted", data)
    pattern = _mark(Pattern, marks)
    if pattern is not None and pattern.expression.fullmatch(data) is None:
        raise _refused(pattern.words, data)
    return data


def _whole(data: Any, *marks: Any) -> int:
    bounds = _mark(Whole, marks) or Whole(0)
    most = math.inf if bounds.most is None else bounds.most
    if isinstance(data, bool) or not isinstance(data, int) or not bounds.least <= data <= most:
        wanted = f"from {bounds.least} " + ("on" if bounds.most is None else f"to {bounds.most}")
        raise _refused(f"a whole number {wanted} is wanted", data)
    return data


def _real(data: Any, *marks: Any) -> float:
    null = _mark(Null, marks)
    if data is None and null is not None:
        return null.value
    if isinstance(data, bool) or not isinstance(data, int | float):
        raise _refused("a number is wanted", data)
    try:
        number = float(data)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise _refused("a finite number is wanted", data)
    return number


def _array(data: Any, *marks: Any) -> Array:
    shape = _mark(Shape, marks)
    return np.array(_rows(data, (None,) if shape is None else shape.sizes), dtype=np.float64)


def _rows(data: Any, sizes: tuple[int | None, ...]) -> list[Any]:
    size, *inner = sizes
    rows = _listed(data)
    if size is not None and len(rows) != size:
        raise _refused(f"{size} {'rows' if inner else 'numbers'} are wanted", data)
    found: list[Any] = []
    for index, row in enumerate(rows):
        try:
            found.append(_rows(row, tuple(inner)) if inner else _real(row))
        except InputError as error:
            raise InputError(error.problem, key=f"[{index}]{error.key or ''}") from None
    return found


_ATOMS: dict[Any, Callable[..., Any]] = {bool: _truth, int: _whole, float: _real, str: _text, Any: lambda data: data}
"""By type: its reader."""
