"""The keys of result files as tables, from the classes of results: keys and attributes have the same names."""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pinograsp.descriptions.docstrings import field_docstrings
from pinograsp.frozen import Record
from pinograsp.results.encoding import FORMAT_VERSION
from pinograsp.results.result import Result

_FILES = {"RobotDescription": "[robot file](robot.md)", "Scene": "[scene file](scene.md)"}
_WORDS = {str: "text", int: "whole number", float: "number", bool: "`true` or `false`", types.NoneType: "`null`"}


def result_keys() -> str:
    """Return a section with a table for the file and for every kind of block in it, as Markdown."""
    own = ["| `format_version` | whole number | " + f"{FORMAT_VERSION} |", "| `digest` | text | of everything else |"]
    parts = ["## The whole result file { #result }", _table(Result, own)]
    for record in _records(Result):
        description = " ".join((record.__doc__ or "").split("\n\n")[0].split())
        parts += [f"## {record.__name__} {{ #{record.__name__.lower()} }}", description, _table(record)]
    return "\n\n".join(parts)


def _records(record: type[Record]) -> list[type[Record]]:
    """Return the classes of the blocks inside a block, each after the one in which it is met first."""
    found: list[type[Record]] = []

    def visit(outer: type[Record]) -> None:
        for kind in _types(outer).values():
            for inner in _inside(kind):
                if inner not in found:
                    found.append(inner)
                    visit(inner)

    visit(record)
    return found


def _types(record: type[Record]) -> dict[str, Any]:
    hints = typing.get_type_hints(record)
    return {f.name: hints[f.name] for f in dataclasses.fields(record) if f.name not in record.not_in_json}


def _inside(kind: Any) -> Iterator[type[Record]]:
    if isinstance(kind, type) and issubclass(kind, Record):
        yield kind
    for part in typing.get_args(kind):
        yield from _inside(part)


def _table(record: type[Record], before: list[str] | None = None) -> str:
    meanings = field_docstrings(record)
    rows = [_row(name, _value(kind), meanings.get(name)) for name, kind in _types(record).items()]
    for name in record.also_in_json:
        getter = getattr(record, name).fget
        rows.append(_row(name, _value(typing.get_type_hints(getter)["return"]), getter.__doc__))
    table = ["| key | value | meaning |", "|---|---|---|", *(before or []), *rows]
    return '<div class="keys" markdown>\n\n' + "\n".join(table) + "\n\n</div>"


def _row(name: str, value: str, meaning: str | None) -> str:
    return f"| `{name}` | {value} | {' '.join((meaning or '').split()).replace('|', chr(92) + '|')} |"


def _value(kind: Any) -> str:
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin in (types.UnionType, typing.Union):
        return " or ".join(_value(part) for part in parts)
    if origin is typing.Literal:
        return " or ".join(f"`{part}`" for part in parts)
    if origin is np.ndarray:
        return "numbers"
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return f"by name: {_value(parts[1])}"
    if origin is tuple:
        return f"list: {_value(parts[0])}"
    if kind in (Path, Any):
        return "text" if kind is Path else "any"
    if isinstance(kind, type) and issubclass(kind, Record):
        return f"[{kind.__name__}](#{kind.__name__.lower()})"
    return _WORDS.get(kind) or _FILES[kind.__name__]
