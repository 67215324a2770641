"""Signals to commands, and to one of their workers, at random moments."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pinograsp
from faults_machine import (
    WrongError,
    members,
    require_clean,
)
from faults_outcomes import rows_of
from faults_series import Faults

LIVED = 0.2
"""Share of a command's time after the begin of its workers in which one of them is killed."""


def signals(faults: Faults) -> None:
    """Send every signal at random moments of every command."""
    for name, subject in faults.chosen.items():
        for number in faults.signals:
            with faults.row(signal.Signals(number).name, name) as outcomes:
                folder = faults.started(name)
                for _ in range(faults.moments):
                    if name != "build":
                        folder = faults.started(name)
                    moment = faults.random.uniform(0.0, subject.seconds)
                    with faults.judged(outcomes, f"{number} after {moment:.3f} s of {name}"):
                        done = faults.machine.run(folder, *subject.words, at=_sender(number, moment))
                        outcomes[subject.check(folder, done, number, subject.whole)] += 1
                        if done.code == 0:  # as fast as the machine is now
                            subject.seconds = done.seconds
                    if name == "build" and (folder / "rows.duckdb").exists():
                        _goes_on(faults, folder, outcomes)


def _goes_on(faults: Faults, folder: Path, outcomes: Counter[str]) -> None:
    """Refuse a database that does not open, and now and then build it to its end; then begin another one."""
    subject = faults.subjects["build"]
    with faults.judged(outcomes, "the build after it"):
        with pinograsp.Database.open(folder / "rows.duckdb") as database:
            database.rows()
        if faults.random.random() < 0.25:
            faults.machine.run(folder, *subject.words).require(0)
            if rows_of(folder / "rows.duckdb") != subject.whole:
                raise WrongError("other rows than without the fault")
            require_clean(folder)
            (folder / "rows.duckdb").unlink()


def workers(faults: Faults) -> None:
    """Kill one worker at random moments after they begin: nothing is lost."""
    for name in (name for name in faults.chosen if name != "report"):
        subject = faults.subjects[name]
        with faults.row("a worker is killed", name) as outcomes:
            for _ in range(faults.moments):
                folder, moment = faults.started(name), faults.random.uniform(0.0, LIVED) * subject.seconds
                with faults.judged(outcomes, f"a worker of {name} killed {moment:.3f} s after it began"):
                    killed: list[int] = []
                    done = faults.machine.run(folder, *subject.words, at=_killer(faults, moment, killed)).require(0)
                    if name == "build" and rows_of(folder / "rows.duckdb") != subject.whole:
                        raise WrongError("other rows than without the fault")
                    subject.check(folder, done, None, subject.whole)
                    outcomes["the same outcome" if killed else "no worker then"] += 1


def _killer(faults: Faults, moment: float, killed: list[int]) -> Callable[[subprocess.Popen[str]], None]:
    """Return what kills a worker some seconds after the first has begun."""

    def workers(process: subprocess.Popen[str]) -> list[int]:
        return [pid for pid in members(process.pid) if pid != process.pid]

    def kill(process: subprocess.Popen[str]) -> None:
        while process.poll() is None and not workers(process):
            time.sleep(0.002)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(moment)
        if alive := workers(process):
            killed.append(faults.random.choice(alive))
            with contextlib.suppress(ProcessLookupError):
                os.kill(killed[0], signal.SIGKILL)

    return kill


def _sender(number: int, moment: float) -> Callable[[subprocess.Popen[str]], None]:
    """Return what sends a signal after some seconds: SIGINT and SIGHUP to the whole group."""

    def send(process: subprocess.Popen[str]) -> None:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(moment)
        with contextlib.suppress(ProcessLookupError):
            to = os.killpg if number in (signal.SIGINT, signal.SIGHUP) else os.kill
            if process.poll() is None:
                to(process.pid, number)

    return send
