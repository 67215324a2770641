"""Machines that misbehave: whether commands keep what they found, say what is wrong, and leave nothing behind.

    python tools/faults.py [--moments 50] [--seed 0] [--parts signals workers folders terminals shared]
        [--commands plan build report] [--signals SIGINT ...] [--processes 2] [--cache FOLDER]

Signals come at random moments of `plan`, `database build` and `rank` (of a page), from the first import on; SIGINT to
the whole group, as a terminal sends it. Then workers are killed, folders are read-only, full, missing, or a file;
terminals are closed, of ASCII, or full; and many plans begin at once on an empty cache. Prints a Markdown table of the
outcomes; exit code 1 if one is wrong, and what was wrong on standard error. Full and read-only folders need the right
to mount a tmpfs, and are left out without it.
"""

from __future__ import annotations

import argparse
import shutil
import signal
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from faults_folders import folders
from faults_machine import SIGNALS, Machine
from faults_series import Faults
from faults_shared import shared
from faults_signals import signals, workers
from faults_terminals import terminals

PARTS = {"signals": signals, "workers": workers, "folders": folders, "terminals": terminals, "shared": shared}
COMMANDS = ("plan", "build", "report")


def main(arguments: Sequence[str] | None = None) -> int:
    """Try all parts, print the table, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--moments", type=int, default=50, help="of a signal and a command")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=COMMANDS, help="of signals and workers")
    parser.add_argument("--processes", type=int, default=2, help="workers of a command")
    parser.add_argument("--signals", nargs="+", choices=SIGNALS, default=list(SIGNALS))
    parser.add_argument("--cache", type=Path, metavar="FOLDER", help="a filled cache, of which a copy is used")
    given = parser.parse_args(arguments)
    # In the background of a shell Ctrl-C is ignored, and commands would inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        folder = Path(name)
        folder.chmod(0o755)
        cache = folder / "cache"
        if given.cache is None:
            cache.mkdir()
        else:
            shutil.copytree(given.cache, cache)
        numbers = [SIGNALS[name] for name in given.signals]
        faults = Faults(Machine(cache, given.processes), folder, given.moments, given.seed, given.commands, numbers)
        faults.prepare()
        for part in given.parts:
            PARTS[part](faults)
    print("| fault | command | times | outcomes | wrong |")
    print("|---|---|---|---|---|")
    print("\n".join(faults.lines))
    return 1 if faults.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
