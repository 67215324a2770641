"""One builder a database at a time."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from ..disk import reason_of
from ..errors import FileError, UnwritableError
from ..interrupts import heard


@contextmanager
def building(file: Path, *, wait: bool) -> Iterator[None]:
    """Hold the right to build a database; the system takes it back when the process ends, however it ends.

    Raises:
        FileError: another process holds it, and `wait` is false.
        UnwritableError: nothing can be written there.
    """
    with _lock(file) as handle:
        try:
            with heard():
                fcntl.flock(handle, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FileError("is being built by another process", file=file, remedy="Wait until it is done") from None
        yield  # the lock file stays: to delete it would let two processes lock two files of one name


def _lock(file: Path) -> IO[str]:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        return file.with_name(f".{file.name}.lock").open("w")
    except OSError as error:
        raise UnwritableError(f"cannot be written: {reason_of(error)}", file=file, remedy="Check the folder") from None
