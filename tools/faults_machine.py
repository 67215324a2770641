"""Commands that run in folders of their own, what became of them, and what they left behind."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

BEGIN = """
import os, sys
os.close(int(sys.argv.pop(1)))  # the first import begins
from pinograsp.__main__ import main
main()
"""
STARTS = 40
ROWS = 20_000
NAME = "glovebox_sphere_gen3_2f85"
PLAN = ("plan", "glovebox", "--task", "sphere", "--starts", STARTS)
BUILD = ("database", "build", "rows.duckdb", "--scene", "glovebox", "--size", ROWS)
REPORT = ("rank", "result.json", "--out", "out")
SIGNALS = {number.name: number for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)}
SAID = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}
"""Exit codes of commands that were asked to end."""
NOBODY = 54321
"""A user of whom the system knows nothing."""
TIMEOUT = 300.0
"""Seconds after which a command is taken to hang."""
LONG = 1500.0
"""The same of one that builds the database of a plan."""
HANGS = 1000
"""Its exit code then."""


class WrongError(Exception):
    """An outcome that should not be."""


@dataclass
class Done:
    """What became of a command."""

    code: int
    output: str
    errors: str
    seconds: float
    left: list[int] = field(default_factory=list)
    """Processes of its group that were still there a few seconds after it."""

    def require(self, *codes: int) -> Done:
        """Refuse another exit code, a traceback, and processes that are left."""
        said = self.output + self.errors
        if self.code not in codes or "Traceback" in said or "Exception ignored" in said or self.left:
            left = f", left {self.left}" if self.left else ""
            raise WrongError(f"exit code {self.code}{left}: {said.strip()[-1500:]}")
        return self


@dataclass
class Machine:
    """Runs commands in a folder of their own, all with one cache."""

    cache: Path
    processes: int

    def run(
        self,
        folder: Path,
        *words: object,
        at: Callable[[subprocess.Popen[str]], object] = lambda process: None,
        environment: Mapping[str, str | None] | None = None,
        most: float = TIMEOUT,
        **streams: Any,
    ) -> Done:
        """Run a command.

        Args:
            folder: where it runs.
            words: of the command.
            at: called when its first import begins.
            environment: variables that are set besides, or with None taken away.
            most: seconds after which it is taken to hang.
            streams: further arguments of `Popen`.
        """
        variables = {"PINOGRASP_CACHE": str(self.cache), **(environment or {})}
        kept = {key: value for key, value in (os.environ | variables).items() if value is not None}
        workers = ("--workers", self.processes) if words[0] in ("plan", "database") else ()
        reading, writing = os.pipe()
        with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
            began = time.monotonic()
            process = subprocess.Popen(
                [sys.executable, "-c", BEGIN, str(writing), *map(str, (*words, *workers))],
                **{"cwd": folder, "env": kept, "stdout": output, "stderr": errors, "start_new_session": True} | streams,
                pass_fds=(writing,),
                text=True,
            )
            os.close(writing)
            os.read(reading, 1)  # ends where the child closes it
            os.close(reading)
            try:
                at(process)
                code = process.wait(most)
            except subprocess.TimeoutExpired:
                code = HANGS
            except BaseException:
                kill(process)
                raise
            seconds = time.monotonic() - began
            left = gone(process.pid)
            if code == HANGS:
                kill(process)
            texts = []
            for stream in (output, errors):
                stream.seek(0)
                texts.append(stream.read())
        return Done(code, *texts, seconds, left)


def kill(process: subprocess.Popen[str]) -> None:
    """Kill a process and its group."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def members(group: int) -> list[int]:
    """Return the living processes of a group."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            state, _, own = (entry / "stat").read_text().rpartition(")")[2].split()[:3]
            if int(own) == group and state != "Z":
                found.append(int(entry.name))
    return found


def gone(group: int) -> list[int]:
    """Return what is left of a group after some seconds."""
    end = time.monotonic() + 10.0
    while (left := members(group)) and time.monotonic() < end:
        time.sleep(0.05)
    return left


def require_clean(*folders: Path) -> None:
    """Refuse temporary files: of a file or database that was written whole, or not at all."""
    for folder in folders:
        found = [p.name for p in folder.rglob(".*") if not p.name.endswith((".lock", ".unfinished"))]
        found += [p.name for p in folder.rglob("*") if p.name.endswith((".partial", ".sorting"))]
        if found:
            raise WrongError(f"left in {folder}: {', '.join(found)}")
