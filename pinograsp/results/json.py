"""Results as JSON files.

The layout (`encoding`) has a format version; `read_json` refuses others.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any, NoReturn

from ..disk import as_path, json_text, reason_of, write_whole
from ..errors import FileError
from .decoding import decode
from .encoding import FORMAT_VERSION, encode
from .result import Result


def write_json(result: Result, file: Path | str) -> None:
    """Write a result with the robot, the scene and the task that it belongs to.

    The file is there whole or not at all; one that is there is replaced, and its folder is made.

    Args:
        result: from `plan` or `read_json`.
        file: where to write.

    Raises:
        InputError: the file cannot be written.
    """
    write_whole(as_path("file", file), json_text(encode(result)))


def read_json(file: Path | str) -> Result:
    """Read a result that `write_json` wrote.

    A result whose file was changed since is read, too, and says so (`Result.altered`); `verify` finds what was changed.

    Raises:
        FileError: the file is missing, is no JSON, or is of another format.
    """
    data = _load(as_path("file", file))
    try:
        result = decode(data)
        # What follows from other numbers and is not kept, as whether a figure holds, counts too.
        return dataclasses.replace(result, altered=encode(result) != data)
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError) as error:
        raise FileError(f"is damaged: {type(error).__name__} {error}", file=file) from None


def _load(file: Path) -> dict[str, Any]:
    try:
        data = json.loads(file.read_text(encoding="utf-8"), parse_constant=_refuse)
    except OSError as error:
        raise FileError(f"cannot be read: {reason_of(error)}", file=file) from None
    except (ValueError, RecursionError) as error:
        raise FileError(f"is not valid JSON: {error}", file=file) from None
    version = data.get("format_version") if isinstance(data, dict) else None
    if version != FORMAT_VERSION:
        raise FileError(
            f"format version {version} cannot be read; this pinograsp reads {FORMAT_VERSION}",
            file=file,
            key="format_version",
            remedy="Plan again",
        )
    return dict(data)


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number of JSON")
