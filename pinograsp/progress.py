"""Progress of a piece of work, reported by everything that takes longer than a second."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Progress:
    """The state of a piece of work that goes on."""

    stage: str
    """The work: meshes, compiling, convex pieces, start database, sorting, starts, resistance, certificates, ..."""
    done: int
    """Pieces of it that are done."""
    total: int | None = None
    """All pieces of it; None: not known."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """Further numbers by name: `verified` starts and their `best U`, `rows per second` of a database."""

    def __str__(self) -> str:
        """Return a line, `starts: 120 of 1,304, verified 118, best U 2.179`."""
        count = f"{self.done:,}" + (" so far" if self.total is None else f" of {self.total:,}")
        return ", ".join([f"{self.stage}: {count}", *(f"{name} {value:,.4g}" for name, value in self.numbers.items())])


Report = Callable[[Progress], None]
"""Takes the progress of a piece of work, in the process that began it. What it raises ends the work."""


def no_report(progress: Progress) -> None:
    """Take no notice of progress."""
