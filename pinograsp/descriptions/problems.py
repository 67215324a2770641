"""Errors of validation in words: which key, what is wrong with it, what to do."""

from __future__ import annotations

import re
from collections.abc import Container, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from ..errors import InputError, UnknownNameError, close_names

KeyPath = tuple[str | int, ...]
INTERNAL = ("source", "digest")
"""Fields that are no keys of a file."""


def refuse_internal(
    content: Container[str], *, file: Path | None = None, lines: Mapping[KeyPath, int] | None = None
) -> None:
    """Refuse what only the reader of a file sets.

    Args:
        content: of a file, or given in Python.
        file: that the content was read from.
        lines: of the file, by key path.

    Raises:
        InputError: it is given.
    """
    for name in INTERNAL:
        if name in content:
            line = None if lines is None else lines[(name,)]
            raise InputError("unknown key", file=file, line=line, key=name, remedy="Remove it")


def dotted(path: KeyPath) -> str:
    """Write a key path as `tasks.sphere.desired_contacts[0]`, invisible characters as Python escapes them."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def input_error(
    error: ValidationError,
    model: type[BaseModel],
    content: object,
    *,
    file: Path | None = None,
    lines: Mapping[KeyPath, int] | None = None,
) -> InputError:
    """Return the first unknown key (a misspelt key is also a missing one), else the first problem, as an error.

    Args:
        error: of the validation.
        model: what was to be made.
        content: what it was to be made from.
        file: that the content was read from.
        lines: of the file, by key path.
    """
    problems = error.errors()
    first = min(problems, key=lambda problem: problem["type"] != "extra_forbidden")
    path: KeyPath = first["loc"]
    context = first.get("ctx", {})
    remedy: str | None = None
    added: KeyPath = ()
    kind: type[InputError] = InputError
    match first["type"]:
        case "missing" if isinstance(path[-1], str):
            path, added = path[:-1], path[-1:]
            problem, remedy = "this key is missing", "Add it"
        case "missing":  # of a list, each value that is
            wanted = 1 + max(int(each["loc"][-1]) for each in problems if each["loc"][:-1] == path[:-1])
            problem = f"{wanted} values are wanted ({len(first['input'])} given)"
        case "union_tag_not_found":
            added = (context["discriminator"].strip("'"),)
            problem, remedy = "this key is missing", "Add it"
        case "union_tag_invalid":
            path, kind = (*path, context["discriminator"].strip("'")), UnknownNameError
            problem = f"{context['tag']!r} is not known"
            remedy = close_names(context["tag"], context["expected_tags"].replace("'", "").split(", "))
        case "extra_forbidden":
            problem, remedy = "unknown key", close_names(str(path[-1]), _keys_in(model, path[:-1]))
        case "wrong" | "unknown_name":
            path, problem, remedy = (*path, *context["path"]), context["problem"], context["remedy"]
            kind = UnknownNameError if first["type"] == "unknown_name" else InputError
        case _:
            problem = _in_words(first, in_file=file is not None)
            if isinstance(first["input"], np.ndarray) and context.get("class_name") == "Pose":
                remedy = "Make one of a homogeneous matrix with Pose.of"
    known = _nearest(path, content)
    line = None if lines is None else _line(known, lines)
    return kind(problem, file=file, line=line, key=dotted((*known, *added)) or None, remedy=remedy)


def _nearest(path: KeyPath, content: object) -> KeyPath:
    """Return the part of `path` that stands in the content: without the tags by which blocks are told apart."""
    known: KeyPath = ()
    for part in path:
        if isinstance(content, BaseModel):
            content = content.__dict__
        elif isinstance(content, np.ndarray):
            content = content.tolist()
        if isinstance(content, Mapping):
            for key, value in content.items():
                if str(key) == str(part):
                    known, content = (*known, str(key)), value
                    break
        elif isinstance(part, int) and isinstance(content, list | tuple) and part < len(content):
            known, content = (*known, part), content[part]
    return known


def _line(path: KeyPath, lines: Mapping[KeyPath, int]) -> int:
    """Return the line of a key, or of the block that it is in if it came there otherwise (YAML's `<<`)."""
    while path not in lines:
        path = path[:-1]
    return lines[path]


def _in_words(problem: ErrorDetails, *, in_file: bool) -> str:
    """Say what is wanted: in a file in the words of YAML, otherwise in those of Python."""
    given, context = problem["input"], problem.get("ctx", {})
    match problem["type"]:
        case "value_error":
            return str(context["error"])
        case "too_long":
            return f"no more than {context['max_length']} values are wanted ({context['actual_length']} given)"
        case "too_short":
            return f"at least {context['min_length']} values are wanted ({context['actual_length']} given)"
        case "tuple_type":
            wanted = "a list in [brackets]" if in_file else "a list"
        case "dict_type" | "model_type" | "model_attributes_type" if in_file:
            wanted = "a block of keys"
        case "dict_type":
            wanted = "a dict"
        case "model_type" | "model_attributes_type":
            name = context.get("class_name")  # none where there are several
            part = "a part made with its class" if name is None else f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"
            wanted = f"{part}, or a dict of its keys,"
        case "string_type":
            wanted = "a text"
        case "float_type" | "float_parsing":
            wanted = "a number"
        case "finite_number":
            wanted = "a finite number"
        case "string_too_short":
            wanted = f"a text of at least {context['min_length']} character"
        case _:
            message = problem["msg"].replace("Input should be ", "must be ", 1)
            return f"{message[:1].lower()}{message[1:]} (given: {_shown(given)})"
    return f"{wanted} is wanted (given: {_shown(given)})"


def _shown(given: object) -> str:
    """Return what was given in one line."""
    return "nothing" if given is None else re.sub(r"\n\s*", " ", repr(given))


def _keys_in(model: type[BaseModel], path: KeyPath) -> list[str]:
    """Return the keys that the block at `path` may have; none of a block that cannot be there."""
    schema = model.model_json_schema()  # not kept: shapes can be registered

    def meant(block: dict[str, Any]) -> dict[str, Any]:
        """Return the block behind references and the possibility to leave it out."""
        while "$ref" in block or "anyOf" in block:
            if "$ref" in block:
                block = schema["$defs"][block["$ref"].rsplit("/", 1)[-1]]
            else:
                block = next(kind for kind in block["anyOf"] if kind.get("type") != "null")
        return block

    block = meant(schema)
    for part in path:
        if "discriminator" in block:
            if part not in block["discriminator"]["mapping"]:  # what cannot be there, as a compound in a compound
                return []
            block = {"$ref": block["discriminator"]["mapping"][part]}
        elif isinstance(part, int):
            block = block["items"]
        else:
            block = block.get("properties", {}).get(part) or block["additionalProperties"]
        block = meant(block)
    return sorted(set(block["properties"]) - set(INTERNAL))
