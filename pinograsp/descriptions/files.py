"""YAML into pydantic models, with errors that name the file, the line and the key."""

from __future__ import annotations

from pathlib import Path

import yaml
from pydantic import ValidationError

from ..disk import content_of, digest
from ..errors import FileError, InputError
from ..interrupts import held
from .mesh_files import SCENE_FILE
from .model import Root
from .problems import KeyPath, dotted, input_error, refuse_internal
from .values import ABSENT
from .yaml_core import Yaml, require_few_aliases

LARGEST = 2**20
"""Bytes of a robot or scene file."""


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
        elif isinstance(node, yaml.ScalarNode) and "\0" in node.value:
            line, key = node.start_mark.line + 1, dotted(path) or None
            problem = "a text with the character U+0000, which no name of a file can have"
            raise InputError(problem, file=self._file, line=line, key=key, remedy="Take it out")


def read_file(file: Path, model: type[Root]) -> Root:
    """Read and validate one YAML file.

    Raises:
        FileError: the file is missing, cannot be read or is not YAML.
        InputError: it does not fit `model`.
    """
    data = content_of(file, LARGEST)
    try:
        loader = Yaml(data.decode())
        node = loader.get_single_node()
        if node is not None:
            require_few_aliases(node)
        lines = _Lines(node, file)
        content = None if node is None else loader.construct_document(node)
    except UnicodeDecodeError:
        raise FileError("is not a text file in UTF-8", file=file) from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise _not_yaml(error, file) from None
    if not isinstance(content, dict):
        raise FileError("is empty or not a mapping of keys", file=file, remedy="Start with `format: 1`")
    refuse_internal(content, file=file, lines=lines.of)
    try:
        whole = {"format": ABSENT, **content, "source": file, "digest": digest(data)}
        with held():  # pydantic would take an interrupt for an error in the file
            return model.model_validate(whole, context={SCENE_FILE: file})
    except ValidationError as error:
        raise input_error(error, model, content, file=file, lines=lines.of) from None


def _not_yaml(error: Exception, file: Path) -> FileError:
    mark = getattr(error, "problem_mark", None)
    parts = [getattr(error, name, None) for name in ("context", "problem", "reason")]
    problem = ", ".join(part for part in parts if part) or str(error)
    return FileError(f"is not valid YAML: {problem}", file=file, line=mark.line + 1 if mark else None)
