"""Progress on standard error: a bar in a terminal, a line now and then elsewhere."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import typer

from ..progress import Progress, Report, no_report
from .unread import Unread, unread

INTERVAL = 2.0
"""Seconds between lines."""
REFRESHED = 0.1
"""Seconds between two looks of a bar."""


def reporter(*, quiet: bool, terminal: bool) -> contextlib.AbstractContextManager[Report]:
    """Return what shows progress while its block goes on.

    Args:
        quiet: nothing is shown.
        terminal: whether standard error is one.
    """
    if quiet:
        return contextlib.nullcontext(no_report)
    return _bar() if terminal else contextlib.nullcontext(Lines())


class Lines:
    """Writes a line when two seconds have passed since the last one, and then also where a stage begins."""

    def __init__(self) -> None:
        self._written, self._stage = time.monotonic(), ""

    def __call__(self, progress: Progress) -> None:
        """Write how far the work is, if it is time for that."""
        now = time.monotonic()
        began = self._stage != "" and progress.stage != self._stage
        if now - self._written >= INTERVAL or began:
            with unread(sys.stderr):
                typer.echo(str(progress), err=True)
            self._written, self._stage = now, progress.stage


@contextmanager
def _bar() -> Iterator[Report]:
    """Show a bar of the stage that the work is in, gone when the block ends.

    No thread refreshes it: processes that are forked meanwhile would inherit its locks.
    """
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    errors: Any = Unread(sys.stderr)
    columns = (TextColumn("{task.description}"), BarColumn(bar_width=None), TimeRemainingColumn())
    with Bar(
        *columns,
        console=Console(file=errors, force_terminal=True),
        transient=True,
        auto_refresh=False,
        expand=True,
    ) as bar:
        row, stage, shown = bar.add_task("preparing", total=None), "", -REFRESHED
        bar.refresh()

        def show(progress: Progress) -> None:
            nonlocal stage, shown
            now = time.monotonic()
            if progress.stage != stage:
                bar.reset(row, total=progress.total)
            elif now - shown < REFRESHED:
                return
            stage, shown = progress.stage, now
            bar.update(row, description=str(progress), completed=progress.done, total=progress.total)
            bar.refresh()

        yield show
