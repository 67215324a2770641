"""The series of faults: commands undisturbed, and the table of outcomes."""

from __future__ import annotations

import contextlib
import random
import shutil
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import duckdb

import pinograsp
from faults_machine import (
    BUILD,
    LONG,
    NAME,
    PLAN,
    REPORT,
    Machine,
    WrongError,
)
from faults_outcomes import Subject, check_build, check_plan, check_report, rows_of


class Faults:
    """What all parts use: the commands undisturbed, new folders, and the lines of the table."""

    def __init__(
        self, machine: Machine, folder: Path, moments: int, seed: int, commands: Sequence[str], numbers: Sequence[int]
    ) -> None:
        self.machine, self.folder, self.moments, self.signals = machine, folder, moments, numbers
        self.random = random.Random(seed)
        self._count = 0
        self.wrong = 0
        self.lines: list[str] = []
        self.subjects = {
            "plan": Subject(PLAN, check_plan),
            "build": Subject(BUILD, check_build),
            "report": Subject(REPORT, check_report),
        }
        self.chosen = {name: self.subjects[name] for name in commands}

    def fresh(self) -> Path:
        """Return a new folder."""
        self._count += 1
        folder = self.folder / str(self._count)
        folder.mkdir()
        return folder

    def prepare(self) -> None:
        """Run every command undisturbed, twice: the first time fills the caches."""
        for name, subject in self.subjects.items():
            seconds = []
            for _ in range(2):
                folder = self.started(name)
                done = self.machine.run(folder, *subject.words, most=LONG).require(0)
                seconds.append(done.seconds)
            subject.seconds = seconds[-1]
            if name == "plan":
                shutil.copy(folder / "out" / f"{NAME}.json", self.folder / "result.json")
                result = pinograsp.read_json(self.folder / "result.json")
                subject.whole = [grasp.to_json() for grasp in result.grasps]
            elif name == "build":
                subject.whole = rows_of(folder / "rows.duckdb")
            else:
                subject.whole = next((folder / "out").glob("*.html")).read_text()[-100:]  # names within it are random
            print(f"{name}: {subject.seconds:.1f} s", file=sys.stderr)

    def started(self, name: str) -> Path:
        """Return a new folder in which a command can run."""
        folder = self.fresh()
        if name == "report":
            shutil.copy(self.folder / "result.json", folder)
        return folder

    @contextlib.contextmanager
    def row(self, fault: str, command: str) -> Iterator[Counter[str]]:
        """Collect the outcomes of a line of the table."""
        outcomes: Counter[str] = Counter()
        yield outcomes
        said = ", ".join(f"{count} {outcome}" for outcome, count in sorted(outcomes.items()))
        self.lines.append(f"| {fault} | {command} | {outcomes.total()} | {said} | {outcomes['WRONG']} |")
        print(self.lines[-1], file=sys.stderr)
        self.wrong += outcomes["WRONG"]

    @contextlib.contextmanager
    def judged(self, outcomes: Counter[str], where: str) -> Iterator[None]:
        """Count what is wrong in the block."""
        try:
            yield
        except (WrongError, pinograsp.PinograspError, duckdb.Error, OSError) as error:
            outcomes["WRONG"] += 1
            print(f"WRONG, {where}: {type(error).__name__}: {error}", file=sys.stderr)
