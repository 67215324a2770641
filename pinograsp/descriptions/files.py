"""YAML into pydantic models, with errors that name the file, the line and the key."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeVar

import numpy as np
import yaml
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, FiniteFloat, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from ..disk import digest
from ..errors import InputError, close_names


def _number(value: object) -> object:
    """Refuse booleans as numbers (YAML reads `yes` and `on` as true)."""
    if isinstance(value, bool):
        raise ValueError(f"a number is wanted, not {value}")
    return value


Number = Annotated[FiniteFloat, BeforeValidator(_number)]
Vector3 = tuple[Number, Number, Number]
Positive = Annotated[Number, Field(gt=0.0)]
Name = Annotated[str, Field(min_length=1)]
Interval = tuple[Number, Number]
Format1 = Annotated[Literal[1], BeforeValidator(_number)]
KeyPath = tuple[str | int, ...]


def wrong(problem: str, *path: str | int, remedy: str | None = None) -> PydanticCustomError:
    """Return what a validator raises: the problem is with the key at `path` below the part that it validates."""
    return PydanticCustomError("wrong", "{problem}", {"problem": problem, "path": path, "remedy": remedy})


def ordered(interval: Interval, *path: str | int) -> Interval:
    """Return the interval, or raise what a validator raises if its lower end is not below the upper one."""
    if interval[0] >= interval[1]:
        raise wrong(f"the lower end {interval[0]:g} is not below the upper end {interval[1]:g}", *path)
    return interval


def unit(vector: Vector3) -> Vector3:
    """Return the vector, or raise what a validator raises if its length is not 1."""
    length = float(np.linalg.norm(vector))
    if abs(length - 1.0) > 1e-6:
        raise wrong(f"must have length 1, not {length:.4g}")
    return vector


UnitVector3 = Annotated[Vector3, AfterValidator(unit)]
OrderedInterval = Annotated[Interval, AfterValidator(ordered)]


class Frozen(BaseModel):
    """A part of a file: immutable; a key that it does not know is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def __eq__(self, other: object) -> bool:
        """Whether another one of the same class says the same; what was computed from the fields does not count."""
        if type(other) is not type(self):
            return NotImplemented
        return all(getattr(self, name) == getattr(other, name) for name in type(self).model_fields)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with some fields changed; what was computed from the old ones is not copied."""
        copied = super().model_copy(update=update, deep=deep)
        for name in set(copied.__dict__) - set(type(copied).model_fields):
            del copied.__dict__[name]
        return copied


class FileRoot(Frozen):
    """The whole of a file; `source` is where it was read from and `digest` the SHA-256 of its bytes."""

    format: int
    source: Path
    digest: str

    def changed(self, **update: Any) -> Self:
        """Return a copy with some fields changed, whose digest is that of its new content."""
        copied = self.model_copy(update=update)
        content = copied.model_dump_json(exclude={"source", "digest"})
        return copied.model_copy(update={"digest": digest(content.encode())})


Root = TypeVar("Root", bound=FileRoot)


class _Lines:
    """Line numbers of a YAML document by key path."""

    def __init__(self, node: yaml.Node | None, file: Path) -> None:
        self.of: dict[KeyPath, int] = {}
        self._file = file
        if node is not None:
            self._visit(node, ())

    def _visit(self, node: yaml.Node, path: KeyPath) -> None:
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

    def nearest(self, path: KeyPath) -> KeyPath:
        """Return the part of `path` that stands in the document."""
        known: KeyPath = ()
        for part in path:
            for written in (part, str(part)):
                if (*known, written) in self.of:
                    known = (*known, written)
                    break
        return known


def dotted(path: KeyPath) -> str:
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
        lines = _Lines(node, file)
    except UnicodeDecodeError:
        raise InputError("is not a text file in UTF-8", file=file) from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise _not_yaml(error, file) from None
    if not isinstance(content, dict):
        raise InputError("is empty or not a mapping of keys", file=file, remedy="Start with `format: 1`")
    for reserved in ("source", "digest"):
        if reserved in content:
            raise InputError("unknown key", file=file, line=lines.of[(reserved,)], key=reserved, remedy="Remove it")
    try:
        return model.model_validate(content | {"source": file, "digest": digest(data)})
    except ValidationError as error:
        raise _worst_problem(error, lines, file, model) from None


def _not_yaml(error: Exception, file: Path) -> InputError:
    mark = getattr(error, "problem_mark", None)
    parts = [getattr(error, name, None) for name in ("context", "problem", "reason")]
    problem = ", ".join(part for part in parts if part) or str(error)
    return InputError(f"is not valid YAML: {problem}", file=file, line=mark.line + 1 if mark else None)


def _worst_problem(error: ValidationError, lines: _Lines, file: Path, model: type[BaseModel]) -> InputError:
    """Return the first unknown key (a misspelt key is also a missing one), else the first problem."""
    problems = error.errors()
    first = min(problems, key=lambda problem: problem["type"] != "extra_forbidden")
    path: KeyPath = first["loc"]
    context = first.get("ctx", {})
    remedy: str | None = None
    added: KeyPath = ()
    match first["type"]:
        case "missing" if isinstance(path[-1], str):
            path, added = path[:-1], path[-1:]
            problem, remedy = "this key is missing", "Add it"
        case "union_tag_not_found":
            added = (context["discriminator"].strip("'"),)
            problem, remedy = "this key is missing", "Add it"
        case "union_tag_invalid":
            path = (*path, context["discriminator"].strip("'"))
            problem = f"{context['tag']!r} is not known"
            remedy = close_names(context["tag"], context["expected_tags"].replace("'", "").split(", "))
        case "extra_forbidden":
            problem, remedy = "unknown key", close_names(str(path[-1]), _keys_in(model, path[:-1]))
        case "wrong":
            path, problem, remedy = (*path, *context["path"]), context["problem"], context["remedy"]
        case _:
            problem = _in_words(first)
    known = lines.nearest(path)
    return InputError(problem, file=file, line=lines.of[known], key=dotted((*known, *added)) or None, remedy=remedy)


def _in_words(problem: ErrorDetails) -> str:
    """Say what is wanted without the words of Python."""
    given, context = problem["input"], problem.get("ctx", {})
    match problem["type"]:
        case "value_error":
            return str(context["error"])
        case "missing":
            return f"more values are wanted ({len(given)} given)"
        case "too_long":
            return f"{context['max_length']} values are wanted ({context['actual_length']} given)"
        case "too_short":
            return f"at least {context['min_length']} values are wanted ({context['actual_length']} given)"
        case "tuple_type":
            wanted = "a list in [brackets]"
        case "dict_type" | "model_type" | "model_attributes_type":
            wanted = "a block of keys"
        case "string_type":
            wanted = "a text"
        case "float_type" | "float_parsing":
            wanted = "a number"
        case "finite_number":
            wanted = "a finite number"
        case _:
            message = problem["msg"]
            return f"{message[:1].lower()}{message[1:]} (given: {given!r})"
    return f"{wanted} is wanted (given: {'nothing' if given is None else repr(given)})"


def _keys_in(model: type[BaseModel], path: KeyPath) -> list[str]:
    """Return the keys that the block at `path` may have."""
    schema = model.model_json_schema()
    block: dict[str, Any] = schema
    for part in path:
        if "discriminator" in block:
            block = {"$ref": block["discriminator"]["mapping"][part]}
        elif isinstance(part, int):
            block = block["items"]
        else:
            block = block.get("properties", {}).get(part) or block["additionalProperties"]
        if "anyOf" in block:  # a block that may be left out
            block = next(kind for kind in block["anyOf"] if kind.get("type") != "null")
        if "$ref" in block:
            block = schema["$defs"][block["$ref"].rsplit("/", 1)[-1]]
    return sorted(set(block["properties"]) - {"source", "digest"})
