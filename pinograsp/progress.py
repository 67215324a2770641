"""Progress of a piece of work, reported by everything that takes longer than a second."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
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


PATIENCE = 2.0
"""Seconds of a piece of work from which on something is said of it."""
ONCE = {
    "meshes": "the meshes of the scene are prepared",
    "convex pieces": "convex pieces of the robot's meshes are made",
    "compiling": "code is compiled",
    "start database": "a start database for this robot, room and margins is built",
}
"""Work that is done once on a machine, in words."""
LONG = frozenset({"start database"})
"""Work that takes a minute or so."""


class OnceTold:
    """What is said to who asked for no progress: a line on standard error for what is made once, and takes long.

    Else a first plan would be silent for minutes, and nobody could know that the next one is not.
    """

    def __init__(self) -> None:
        self._began: dict[str, float] = {}
        self._told: set[str] = set()

    def __call__(self, progress: Progress) -> None:
        """Say what is made, if that was not said yet and takes long."""
        stage, now = progress.stage, time.monotonic()
        waited = now - self._began.setdefault(stage, now)
        if stage in ONCE and stage not in self._told and (stage in LONG or waited >= PATIENCE):
            self._told.add(stage)
            line = f"pinograsp: {ONCE[stage]}, once on this machine; progress=print says how far it is"
            with suppress(OSError, ValueError, AttributeError):  # it is full, closed, or there is none
                print(line, file=sys.stderr, flush=True)
