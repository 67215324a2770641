"""Results as JSON files.

The layout (`encoding`) has a format version; `read_json` refuses others.
"""

from __future__ import annotations

from pathlib import Path

from ..disk import as_path, json_of, json_text, write_whole
from ..errors import DamagedError, FileError, InputError, require_kind
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
        FileError: the file cannot be written.
        InputError: it is no result.
    """
    require_kind("result", result, Result)
    write_whole(as_path("file", file), json_text(encode(result)))


def read_json(file: Path | str) -> Result:
    """Read a result that `write_json` wrote.

    What no result is written as is refused: another key, kind, shape or word, and parts that do not fit each other. A
    file with another number that nothing else in it contradicts is read, and says so (`Result.altered`); `verify` finds
    what was changed.

    Raises:
        FileError: the file is missing, is no JSON, or is of another format.
        DamagedError: (a `FileError`) it is damaged; the message names the key.
    """
    file = as_path("file", file)
    data = json_of(file)
    version = data.get("format_version") if isinstance(data, dict) else None
    if version != FORMAT_VERSION:
        raise FileError(
            f"format version {version!r} cannot be read; this pinograsp reads {FORMAT_VERSION}",
            file=file,
            key="format_version",
            remedy="Plan again",
        )
    remedy = "Take another copy of the file, or plan again"
    try:
        return decode(data)
    except InputError as error:
        raise DamagedError(f"is damaged: {error.problem}", file=file, key=error.key, remedy=remedy) from None
