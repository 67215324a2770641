"""Ctrl-C, which is never lost: what comes where it would be dropped is raised when that is done.

Compiled modules drop a KeyboardInterrupt of the modules that they import, and go on without them or as if nothing was.
So do Python's functions that LLVM calls while it compiles.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

AGAIN = 0.02
"""Seconds after which it is looked again whether that is done."""
DROPPING = ("<frozen importlib._bootstrap>", str(Path("llvmlite", "binding", "executionengine.py")))
"""Ends of the names of files whose frames drop it: Python's import, and what LLVM calls."""


@contextmanager
def late_interrupts() -> Iterator[None]:
    """Have Ctrl-C raise KeyboardInterrupt in the block, but never where it would be dropped: then right after."""
    handlers = {number: signal.signal(number, _interrupt) for number in (signal.SIGINT, signal.SIGALRM)}
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number, handler in handlers.items():
            signal.signal(number, handler)


@contextmanager
def held_interrupts() -> Iterator[None]:
    """Have a Ctrl-C that comes in the block raise KeyboardInterrupt at its end: files are written first."""
    came: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
    if came:
        raise KeyboardInterrupt


def _interrupt(number: int, frame: FrameType | None) -> None:
    while frame is not None:
        if frame.f_code.co_filename.endswith(DROPPING):
            signal.setitimer(signal.ITIMER_REAL, AGAIN)
            return
        frame = frame.f_back
    signal.setitimer(signal.ITIMER_REAL, 0.0)  # of several that came meanwhile one is raised
    raise KeyboardInterrupt
