"""The terminal of a command: its finding goes to standard output, progress and warnings go to standard error."""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
import textwrap
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

from ..disk import json_text, reason_of
from ..errors import CacheWarning, FileError
from .reporters import reporter
from .unread import unread

if TYPE_CHECKING:
    from ..progress import Report
    from ..tables import Table


class Terminal:
    """The terminal of one command.

    Args:
        as_json: the finding is one JSON document, and nothing else is on standard output.
        quiet: nothing is written but errors, files and the JSON document if that is asked for.
    """

    def __init__(self, as_json: bool, quiet: bool) -> None:
        self._as_json, self._quiet = as_json, quiet
        _warn_by(self)

    @property
    def width(self) -> int:
        """Characters in a line; 80 where that is not known."""
        return shutil.get_terminal_size().columns

    def find(self, document: Callable[[], Mapping[str, Any]], lines: Callable[[], None]) -> None:
        """Give the finding: as JSON the document, otherwise what `lines` says."""
        if self._as_json:
            _write(json_text(document()).removesuffix("\n"))
        elif not self._quiet:
            lines()

    def say(self, line: str) -> None:
        """Write a line, in one piece however long it is: part of a finding, or what became of a file."""
        if not self._quiet:
            _write(line, error=self._as_json)

    def paragraph(self, text: str) -> None:
        """Write a line; on a terminal in as many as it needs, the further ones indented, and never broken in a word."""
        if _is_terminal(sys.stdout):
            text = textwrap.fill(
                text, self.width, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
            )
        self.say(text)

    def table(self, table: Table) -> None:
        """Write a table as wide as the terminal, or as wide as its numbers need."""
        if not self._quiet:
            _write(table.drawn(self.width, color=_is_terminal(sys.stdout) and "NO_COLOR" not in os.environ))

    def warn(self, line: str) -> None:
        """Write a warning."""
        if not self._quiet:
            _write(f"{typer.style('warning:', fg='yellow')} {line}", error=True)

    def progress(self) -> contextlib.AbstractContextManager[Report]:
        """Return what shows progress while its block goes on."""
        return reporter(quiet=self._quiet, terminal=_is_terminal(sys.stderr))


def fail(line: str) -> None:
    """Write the line of an error."""
    _write(f"{typer.style('error:', fg='red', bold=True)} {line}", error=True)


@contextmanager
def spelled_streams() -> Iterator[None]:
    """Have everything written in the block, whatever encoding and reader standard output and error have."""
    import codecs

    from .spelling import spelled

    codecs.register_error(spelled.__name__, spelled)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=spelled.__name__)
    for number in range(3):  # a file that is opened must not become standard output, where that was closed
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    with warnings.catch_warnings():
        yield


def _write(text: str, error: bool = False) -> None:
    stream = sys.stderr if error else sys.stdout
    try:
        with unread(stream):
            typer.echo(text, file=stream)
    except OSError as problem:
        raise FileError(f"cannot be written: {reason_of(problem)}", key="standard output") from None


def _warn_by(terminal: Terminal) -> None:
    """Have a terminal show the warnings of the library, in place of Python's lines about its source."""
    python = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *place: Any, **rest: Any) -> None:
        if issubclass(category, CacheWarning):
            terminal.warn(str(message))
        else:
            python(message, category, *place, **rest)

    warnings.simplefilter("always", CacheWarning)
    showing: Any = show
    warnings.showwarning = showing


def _is_terminal(stream: Any) -> bool:
    return stream is not None and bool(stream.isatty())
