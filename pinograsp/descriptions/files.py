"""YAML into pydantic models, with errors that name the file, the line and the key."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated, Any, TypeVar

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, FiniteFloat, ValidationError

from ..errors import InputError, close_names


def _number(value: object) -> object:
    """Refuse booleans as numbers (YAML reads `yes` and `on` as true)."""
    if isinstance(value, bool):
        raise ValueError(f"a number is wanted, not {value}")
    return value


Number = Annotated[FiniteFloat, BeforeValidator(_number)]
Vector3 = tuple[Number, Number, Number]
Interval = tuple[Number, Number]


class Frozen(BaseModel):
    """A part of a file: immutable; a key that it does not know is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class FileRoot(Frozen):
    """The whole of a file; `source` is where it was read from and `digest` the SHA-256 of its bytes."""

    format: int
    source: Path
    digest: str


Root = TypeVar("Root", bound=FileRoot)


class _Lines:
    """Line numbers of a YAML document by key path."""

    def __init__(self, node: yaml.Node, file: Path) -> None:
        self.of: dict[tuple[str | int, ...], int] = {}
        self._file = file
        self._visit(node, ())

    def _visit(self, node: yaml.Node, path: tuple[str | int, ...]) -> None:
        self.of.setdefault(path, node.start_mark.line + 1)
        if isinstance(node, yaml.MappingNode):
            seen: set[str] = set()
            for key, value in node.value:
                name = str(key.value)
                line = key.start_mark.line + 1
                if name in seen:
                    raise InputError(
                        "key given twice",
                        file=self._file,
                        line=line,
                        key=dotted((*path, name)),
                        remedy="Remove one of the two",
                    )
                seen.add(name)
                self.of[(*path, name)] = line
                self._visit(value, (*path, name))
        elif isinstance(node, yaml.SequenceNode):
            for index, item in enumerate(node.value):
                self._visit(item, (*path, index))

    def nearest(self, path: tuple[str | int, ...]) -> tuple[tuple[str | int, ...], int | None]:
        """Return the part of `path` that stands in the document, and its line."""
        known: tuple[str | int, ...] = ()
        for part in path:
            if (*known, part) in self.of:
                known = (*known, part)
        return known, self.of.get(known)


def dotted(path: tuple[str | int, ...]) -> str:
    """Write a key path as `tasks.sphere.desired_contacts[0]`."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text


def read_file(file: Path, model: type[Root]) -> Root:
    """Read and validate one YAML file.

    Raises:
        InputError: the file is missing, is not YAML, or does not fit `model`.
    """
    try:
        data = file.read_bytes()
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be read: {reason.lower()}", file=file, remedy="Check the path") from None
    try:
        text = data.decode()
        node = yaml.compose(text, Loader=yaml.SafeLoader)
        content = yaml.safe_load(text)
    except UnicodeDecodeError:
        raise InputError("is not a text file in UTF-8", file=file) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or "not understood"
        line = mark.line + 1 if mark else None
        raise InputError(f"is not valid YAML: {problem}", file=file, line=line) from None
    if node is None or not isinstance(content, dict):
        raise InputError("is empty or not a mapping of keys", file=file, remedy="Start with `format: 1`")
    lines = _Lines(node, file)
    for reserved in ("source", "digest"):
        if reserved in content:
            raise InputError("unknown key", file=file, line=lines.of[(reserved,)], key=reserved)
    try:
        return model.model_validate(content | {"source": file, "digest": hashlib.sha256(data).hexdigest()})
    except ValidationError as error:
        raise _first_problem(error, lines, file, model) from None


def _first_problem(error: ValidationError, lines: _Lines, file: Path, model: type[BaseModel]) -> InputError:
    problems = error.errors()
    first = problems[0]
    path = first["loc"]
    if first["type"] == "missing":
        known, line = lines.nearest(path[:-1])
        key = dotted((*known, path[-1]))
        return InputError("this key is missing", file=file, line=line, key=key, remedy="Add it")
    known, line = lines.nearest(path)
    remedy = None
    if first["type"] == "extra_forbidden":
        problem = "unknown key"
        remedy = close_names(str(path[-1]), _keys_beside(model, path[:-1]))
    else:
        message = first["msg"].removeprefix("Value error, ")
        problem = message[:1].lower() + message[1:]
        value = first.get("input")
        if isinstance(value, (str, int, float)) and first["type"] != "value_error":
            problem += f" (given: {value!r})"
    if len(problems) > 1:
        problem += f" (and {len(problems) - 1} more)"
    return InputError(problem, file=file, line=line, key=dotted(known) or None, remedy=remedy)


def _keys_beside(model: Any, path: tuple[str | int, ...]) -> list[str]:
    """Return the keys that the JSON Schema of `model` allows anywhere, nearest first match not needed."""
    schema = model.model_json_schema()
    blocks = [schema, *schema.get("$defs", {}).values()]
    last = next((str(part) for part in reversed(path) if isinstance(part, str)), None)
    names: set[str] = set()
    for block in blocks:
        for name, content in block.get("properties", {}).items():
            if last is None and block is schema:
                names.add(name)
            elif last is not None and name == last:
                for reference in _references(content):
                    names |= set(schema["$defs"][reference].get("properties", {}))
    if not names:
        names = {name for block in blocks for name in block.get("properties", {})}
    return sorted(names - {"source", "digest"})


def _references(content: Any) -> list[str]:
    if isinstance(content, dict):
        found = [content["$ref"].rsplit("/", 1)[-1]] if "$ref" in content else []
        return found + [name for value in content.values() for name in _references(value)]
    if isinstance(content, list):
        return [name for value in content for name in _references(value)]
    return []
