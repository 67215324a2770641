"""What a process does that is asked to end before there is anything to keep; loaded first of all, and in no time."""

import os
import signal
from types import FrameType

ASKING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Ctrl-C, what a system sends before it kills, and the hang-up of a terminal."""


def asking() -> list[int]:
    """Return the signals that count: no hang-up that is to be ignored, as `nohup` says."""
    return [n for n in ASKING if n != signal.SIGHUP or signal.getsignal(n) != signal.SIG_IGN]


def end_when_asked() -> None:
    """Have the signals end the process at once, with one line, wherever no command watches."""
    for number in asking():
        signal.signal(number, _end)


def _end(number: int, frame: FrameType | None) -> None:
    try:
        os.write(2, b"error: interrupted\n")
    finally:  # whatever became of standard error
        os._exit(128 + number)
