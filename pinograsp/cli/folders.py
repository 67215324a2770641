"""The folder that a command writes into, the names of its files, and how they are written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ..disk import is_there, json_text, reason_of, require_writable, write_whole
from ..errors import FileError
from ..interrupts import held
from ..words import escaped

_SEPARATORS = "/\\\0"
"""What names of files cannot have."""


def make_folder(folder: Path) -> None:
    """Make the folder of `--out` and write to it: before the work, not after it.

    Raises:
        UnwritableError: it cannot be done.
    """
    require_writable(folder, "no file can be written there", key="--out")


def file_name(*parts: str | int, suffix: str) -> str:
    """Return the name of a file, `<part>_<part>.<suffix>`: no part of it leads to another folder."""
    return "_".join(escaped(str(part), _SEPARATORS) for part in parts) + f".{suffix}"


def saved(lines: Iterable[str]) -> list[str]:
    """Have files written as soon as what they hold is known, a Ctrl-C after them, and return what to say of them.

    A command does so first of all: then a terminal that is gone loses nothing.

    Args:
        lines: what is to be said of each, which writes it: from `save` or `remove`.
    """
    with held():
        return list(lines)


def save(file: Path, write: Callable[[], object]) -> str:
    """Have a file written, and return what to say: that it is there now, or took the place of another one."""
    done = "replaced" if is_there(file) else "written"
    write()
    return f"{done}: {file}"


def remove(file: Path) -> Iterator[str]:
    """Remove a file of an earlier command that is no longer true, if it is there, and yield what to say.

    Raises:
        FileError: it cannot be removed.
    """
    try:
        if is_there(file):
            file.unlink()
            yield f"removed: {file}, of an earlier plan"
    except OSError as error:
        raise FileError(f"cannot be removed: {reason_of(error)}", file=file, remedy="Remove it") from None


def save_json(file: Path, content: Mapping[str, Any]) -> str:
    """Write JSON data, and return what to say of the file."""
    return save(file, lambda: write_whole(file, json_text(content)))
