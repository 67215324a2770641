"""Files: read with errors in words, written whole or not at all, and told apart by their content."""

from __future__ import annotations

import errno
import fcntl
import hashlib
import json
import mmap
import os
import shutil
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, NoReturn

from .errors import FileError, UnwritableError, require_kind
from .interrupts import held

LARGEST = 2**30
"""Bytes of a file that is read whole."""
PIECE = 2**20
"""Bytes that are read at once."""
FRESH = 60.0
"""Seconds that the folder of an unfinished file is left alone: it is made first and locked then."""
DEEPEST = 64
"""Levels of JSON data."""


def as_path(name: str, file: Path | str) -> Path:
    """Return a path that was given as the argument of a name.

    Raises:
        InputError: it is none.
    """
    require_kind(name, file, Path, str)
    return Path(file)


def content_of(file: Path, most: int = LARGEST) -> bytes:
    """Return the content of a file.

    Args:
        file: to read.
        most: bytes that it may have; nothing larger is meant, and a device has no end.

    Raises:
        FileError: it cannot be read, or is larger.
    """
    try:
        if file.is_fifo():  # which has nobody who writes
            raise OSError(errno.ESPIPE, "it is a pipe")
        with file.open("rb") as opened:
            content = b"".join(_pieces(opened, most))
    except OSError as error:
        raise FileError(f"cannot be read: {reason_of(error)}", file=file, remedy="Check the path") from None
    except ValueError as error:  # a name that no file can have
        raise FileError(f"cannot be read: {error}", file=file, remedy="Check the path") from None
    if len(content) > most:
        problem = f"has more than {most:_} bytes".replace("_", " ")
        raise FileError(problem, file=file, remedy="Check the path: no such file is that large")
    return content


def _pieces(opened: IO[bytes], most: int) -> Iterator[bytes]:
    """Yield what is in a file, and of one with more than `most` bytes little more: to read n takes memory for n."""
    there = 0
    while there <= most and (piece := opened.read(PIECE)):
        there += len(piece)
        yield piece


def json_of(file: Path) -> Any:
    """Return the content of a JSON file.

    Raises:
        FileError: it cannot be read, or is no JSON, which has no NaN and no Infinity.
    """
    try:
        data = json.loads(content_of(file), parse_constant=_refuse)
        _require_shallow(data)
        return data
    except (ValueError, RecursionError) as error:
        raise FileError(f"is not valid JSON: {error}", file=file, remedy="Write it anew") from None


def _require_shallow(data: Any) -> None:
    """Refuse data that is nested so deeply that who goes through it by recursion would not come to its end."""
    level = [data]
    for _ in range(DEEPEST):
        level = [part for outer in level if isinstance(outer, dict | list) for part in _parts(outer)]
        if not level:
            return
    raise ValueError(f"more than {DEEPEST} levels are nested")


def _parts(outer: dict[str, Any] | list[Any]) -> Iterable[Any]:
    return outer.values() if isinstance(outer, dict) else outer


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number of JSON")


@contextmanager
def written_whole(file: Path) -> Iterator[Path]:
    """Give a path to write to; a reader finds the old file, or the new one once the block has ended without an error.

    The folder is made. What a killed process left of the same file is removed.

    Raises:
        UnwritableError: the file cannot be written.
    """
    prefix = f".{file.name}."
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with held(), tempfile.TemporaryDirectory(prefix=prefix, dir=file.parent) as folder, _locked(Path(folder)):
            for other in file.parent.iterdir():
                if other.name.startswith(prefix) and other != Path(folder):
                    _remove_left(other, file.name)
            unfinished = Path(folder) / file.name
            yield unfinished
            unfinished.replace(file)
    except OSError as error:
        raise UnwritableError(f"cannot be written: {reason_of(error)}", file=file, remedy="Check the folder") from None


def make_way(file: Path) -> None:
    """Remove a folder that is in the place of a file of a cache, which is made anew like any other damage.

    Raises:
        UnwritableError: it cannot be removed.
    """
    if is_folder(file) and not file.is_symlink():
        try:
            shutil.rmtree(file)
        except OSError as error:
            problem = f"is a folder that cannot be removed: {reason_of(error)}"
            raise UnwritableError(problem, file=file, remedy="Remove it") from None


@contextmanager
def _locked(folder: Path) -> Iterator[bool]:
    """Lock a folder until the block, or the process, ends; gives whether that could be done."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            taken = True
        except OSError:  # another process has it, or the file system knows no locks
            taken = False
        yield taken
    finally:
        os.close(handle)


def _remove_left(folder: Path, name: str) -> None:
    """Remove the folder of an unfinished file of a name, if the process that wrote there is gone."""
    with suppress(OSError):
        if not is_folder(folder) or folder.is_symlink() or time.time() - folder.stat().st_mtime < FRESH:
            return
        if {inside.name for inside in folder.iterdir()} <= {name}:
            with _locked(folder) as taken:
                if taken:
                    shutil.rmtree(folder)


def write_whole(file: Path, content: str | bytes) -> None:
    """Write a file, text as UTF-8, whole or not at all.

    Raises:
        UnwritableError: the file cannot be written.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    with written_whole(file) as unfinished:
        unfinished.write_bytes(data)


def json_text(content: Mapping[str, Any]) -> str:
    """Return JSON data as the text that files and standard output have."""
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def digest(content: bytes) -> str:
    """Return the SHA-256 of some bytes, in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def digest_of(file: Path) -> str:
    """Return the SHA-256 of a file's content, in hexadecimal.

    Raises:
        FileError: it cannot be read.
    """
    return digest(content_of(file))


def require_writable(folder: Path, problem: str, *, key: str | None = None, remedy: str | None = None) -> None:
    """Make a folder and write to it, before something is done whose outcome is to be written there.

    Raises:
        UnwritableError: it cannot be done; with the problem, the reason and the remedy.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as tried:
            tried.write(bytes(mmap.PAGESIZE))
    except OSError as error:
        raise UnwritableError(f"{problem}: {reason_of(error)}", file=folder, key=key, remedy=remedy) from None


def reason_of(error: OSError) -> str:
    """Return what the system says of a failure, in lower case."""
    return (error.strerror or str(error)).lower()


def is_folder(path: Path) -> bool:
    """Return whether there is a folder; as `is_file`."""
    try:
        return path.is_dir()
    except OSError:
        return False


def is_file(path: Path) -> bool:
    """Return whether there is a file: none that this user may not look for, none of a name that the system refuses."""
    try:
        return path.is_file()
    except OSError:
        return False


def is_there(path: Path) -> bool:
    """Return whether there is a file, a folder or another thing; as `is_file`."""
    try:
        return path.exists()
    except OSError:
        return False
