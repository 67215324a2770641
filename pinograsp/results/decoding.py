"""A result from JSON data, as `encoding` lays it out: by types, then by what its parts say of each other.

Data that no result is written as is refused, and of that only another `digest` is let pass: whoever changed a number
that stands for itself alone is told of by it (`Result.altered`).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from ..errors import InputError
from ..json_types import Sha256
from .agreement import first_disagreement
from .encoding import encode_as
from .result import Result
from .typed import part, read, shown

OWN = {"format_version", "digest"}
"""Keys of the file, not of the result."""


def decode(data: dict[str, Any]) -> Result:
    """Return the result in JSON data.

    Raises:
        InputError: something is missing or unknown, of another kind, or does not fit the rest; the key is its path.
    """
    result = decode_by_types(data)
    _require_same({**data, "digest": ""}, {**encode_as(result, data), "digest": ""}, "")
    if (found := first_disagreement(result)) is not None:
        key, problem = found
        raise InputError(problem, key=key)
    return result


def decode_by_types(data: dict[str, Any]) -> Result:
    """Return the result in JSON data, whatever its parts say of each other.

    Raises:
        InputError: something is missing or unknown, or of another kind; the key is its path.
    """
    part({"digest": data.get("digest")}, "digest", Sha256)
    content = {key: value for key, value in data.items() if key not in OWN}
    result: Result = read(Result, {"explanation": None, **content})  # of results with grasps it is left out
    altered = encode_as(result, data)["digest"] != data["digest"]
    return dataclasses.replace(result, altered=altered)


def _require_same(given: Any, wanted: Any, key: str) -> None:
    """Refuse data that is not written as it is read, such as a property that does not follow from the fields.

    Raises:
        InputError: it is not; the key is the path of the first difference.
    """
    if isinstance(given, Mapping) and isinstance(wanted, Mapping) and given.keys() == wanted.keys():
        for name in wanted:
            _require_same(given[name], wanted[name], f"{key}.{name}" if key else name)
    elif isinstance(given, list) and isinstance(wanted, list) and len(given) == len(wanted):
        for index, (one, other) in enumerate(zip(given, wanted, strict=True)):
            _require_same(one, other, f"{key}[{index}]")
    elif given != wanted or isinstance(given, bool) != isinstance(wanted, bool):
        raise InputError(f"{shown(wanted)} follows from the rest (given: {shown(given)})", key=key)
