"""One builder a database at a time."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import InputError


@contextmanager
def building(file: Path, *, wait: bool) -> Iterator[None]:
    """Hold the right to build a database; the system takes it back when the process ends, however it ends.

    Raises:
        InputError: another process holds it, and `wait` is false.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    lock = file.with_name(f".{file.name}.lock")
    with lock.open("w") as handle:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError("is being built by another process", file=file, remedy="Wait until it is done") from None
        yield  # the lock file stays: to delete it would let two processes lock two files of one name
