"""Progress of builds and plans in the terminal."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

from ..database.build import BuildProgress
from ..planning.outcomes import Progress

PREPARING = "preparing (longer the first time on a machine, and with a new robot)"


class ProgressBar:
    """A bar for each kind of work, shown once that work begins; a context manager."""

    def __init__(self, console: Console) -> None:
        self._bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[note]}"),
            TimeRemainingColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        names = ("start database", "sorting", "starts")
        self._rows = {name: self._bar.add_task(name, total=1, note="", visible=False) for name in names}
        self._preparing = self._bar.add_task(PREPARING, total=None, note="")

    def __enter__(self) -> ProgressBar:
        """Start the bar."""
        self._bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        """Stop and remove the bar."""
        self._bar.stop()

    def __call__(self, progress: Progress | BuildProgress) -> None:
        """Show how far the work is."""
        if isinstance(progress, BuildProgress):
            name = "sorting" if progress.sorting else "start database"
            total, note = max(progress.size, progress.rows), f"at {progress.rate:,.0f}/s" if progress.rate else ""
            self._show(name, progress.rows, total, note)
        else:
            best = f"{progress.best_U:.4g}" if progress.verified else "-"
            self._show("starts", progress.done, progress.total, f"verified {progress.verified}, best U {best}")

    def _show(self, name: str, done: int, total: int, note: str) -> None:
        self._bar.update(self._preparing, visible=False)
        self._bar.update(self._rows[name], completed=done, total=total, note=f"{done:,}/{total:,} {note}", visible=True)
