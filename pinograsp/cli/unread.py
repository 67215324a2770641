"""Standard output and error that nobody reads any more: the work goes on without them."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

GONE = (errno.EPIPE, errno.EIO)
"""What the system says of a pipe without a reader, and of a terminal that was closed."""


@contextmanager
def unread(stream: Any) -> Iterator[None]:
    """Go on without a reader if there is none any more: of `pinograsp plan ... | head` the files are written, too.

    Standard error goes on without whatever it is that cannot be written.
    """
    try:
        yield
    except OSError as problem:
        if stream is not sys.stderr and problem.errno not in GONE:
            raise
        with contextlib.suppress(OSError), Path(os.devnull).open("w") as nowhere:
            os.dup2(nowhere.fileno(), stream.fileno())


class Unread:
    """A stream to which anything can be written, read or not; for libraries that write themselves."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write a text."""
        with unread(self._stream):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Pass on what was written."""
        with unread(self._stream):
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        """Return what else the stream has, such as its encoding."""
        return getattr(self._stream, name)
