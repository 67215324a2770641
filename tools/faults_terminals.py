"""Terminals that are closed, of ASCII, or full."""

from __future__ import annotations

import os
import subprocess
import time
from typing import Any

from faults_machine import (
    NAME,
    PLAN,
    require_clean,
)
from faults_outcomes import require_same
from faults_series import Faults


def terminals(faults: Faults) -> None:
    """Take the terminal away: the files are written whatever becomes of it."""
    ascii_only = {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "LC_ALL": "C", "LANG": "C"}
    kinds: dict[str, tuple[dict[str, Any], dict[str, str], tuple[int, ...]]] = {
        "nobody reads the output": ({"stdout": _unread()}, {}, (0,)),
        "nobody reads the errors": ({"stderr": _unread()}, {}, (0,)),
        "nobody reads either": ({"stdout": _unread(), "stderr": _unread()}, {}, (0,)),
        "the output is closed": ({"preexec_fn": lambda: os.close(1)}, {}, (0,)),
        "all streams are closed": ({"preexec_fn": lambda: os.closerange(0, 3)}, {}, (0,)),
        "the output is full": ({"stdout": os.open("/dev/full", os.O_WRONLY)}, {}, (2,)),
        "the errors are full": ({"stderr": os.open("/dev/full", os.O_WRONLY)}, {}, (0,)),
        "an ASCII terminal": ({}, ascii_only, (0,)),
        "a terminal that hangs up": (_terminal(), {}, (0, 129)),
    }
    for kind, (streams, environment, codes) in kinds.items():
        with faults.row(kind, "plan") as outcomes, faults.judged(outcomes, kind):
            folder = faults.fresh()
            hang_up = streams.pop("hang_up", None)
            done = faults.machine.run(
                folder, *PLAN, environment=environment, at=hang_up or (lambda process: None), **streams
            ).require(*codes)
            if done.code != 129:
                require_same(folder / "out" / f"{NAME}.json", faults.subjects["plan"].whole)
            require_clean(folder)
            outcomes["files written"] += 1


def _unread() -> int:
    """Return the end of a pipe that nobody reads."""
    reading, writing = os.pipe()
    os.close(reading)
    return writing


def _terminal() -> dict[str, Any]:
    """Return the arguments of a process in a terminal, which hangs up when it has begun."""
    parent, child = os.openpty()

    def hang_up(process: subprocess.Popen[str]) -> None:
        os.close(child)
        time.sleep(1.0)
        os.close(parent)

    return {"stdin": child, "stdout": child, "stderr": child, "hang_up": hang_up}
