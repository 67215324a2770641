"""Child processes of limited time and memory: each is killed as soon as it goes beyond, and the next one goes on."""

from __future__ import annotations

import ctypes
import os
import select
import signal
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

SECONDS = 20.0
"""Longest time of an input, of the processor: how busy the machine is does not count."""
STILL = 10.0 * SECONDS
"""Longest time of an input by the clock."""
MEMORY = 2**30
"""Most memory of an input, bytes, beyond what was there when all libraries were loaded."""
TICK = 0.1
"""Seconds after which memory and time of a child are looked at again."""
BATCH = 200
"""Inputs of one child: it is forked from a process that has loaded everything and opened nothing."""
_PR_SET_PDEATHSIG = 1  # linux/prctl.h
Work = Callable[[range, int], None]
"""Runs inputs, and writes to a pipe `<number> begun`, then `<number> <outcome>`, a line each."""


def resident(process: int) -> int:
    """Return the memory that a process has now but for files, bytes; 0 of one that has ended.

    Of files, such as libraries, a forked process has none mapped at first, however many its parent has.
    """
    try:
        pages = Path(f"/proc/{process}/statm").read_text().split()
        return (int(pages[1]) - int(pages[2])) * os.sysconf("SC_PAGESIZE")
    except (OSError, IndexError):
        return 0


def end_with_parent(parent: int) -> None:
    """Have this process killed as soon as its parent has ended, however that ends."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def worked(process: int) -> float:
    """Return how long a process has had the processor, seconds; 0 of one that has ended."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")  # utime and stime, see proc(5)
    except (OSError, IndexError):
        return 0.0


def supervised(work: Work, numbers: range, log: Path) -> Iterator[tuple[int, str]]:
    """Yield what comes of inputs, by number; one that ends its child is a failure, and others go on.

    Args:
        work: what a child does.
        numbers: of the inputs.
        log: file where a child says what is wrong with itself.

    Raises:
        RuntimeError: a child ended before it began with an input.
    """
    while numbers:
        read, write = os.pipe()
        parent = os.getpid()
        base = resident(parent)
        if (process := os.fork()) == 0:
            os.close(read)
            _end(parent, work, numbers[:BATCH], write, log)
        os.close(write)
        last, begun, over = numbers.start - 1, None, None
        try:
            for line in _lines(read, process, base + MEMORY):
                if line in {"time", "memory"}:
                    over = line
                    break
                number, outcome = line.split(" ", 1)
                begun = int(number) if outcome == "begun" else None
                if outcome != "begun":
                    last = int(number)
                    yield last, outcome
        except BaseException:
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
            raise
        status = os.waitpid(process, 0)[1]
        if begun is not None:
            ended = signal.Signals(os.WTERMSIG(status)).name if os.WIFSIGNALED(status) else f"exit {status >> 8}"
            last = begun
            yield begun, over or ended
        elif last < numbers.start:
            raise RuntimeError(log.read_text() if log.exists() else f"a child ended: {status}")
        numbers = range(last + 1, numbers.stop)


def _end(parent: int, work: Work, numbers: range, pipe: int, log: Path) -> None:
    code = 1
    try:
        end_with_parent(parent)
        work(numbers, pipe)
        code = 0
    except BaseException:
        log.write_text(traceback.format_exc())
    finally:
        os._exit(code)


def _lines(pipe: int, process: int, most: int) -> Iterator[str]:
    """Yield the lines of a child; it is killed if it says nothing for too long or grows, and the last line says so."""
    left, heard, before = "", time.monotonic(), 0.0
    with os.fdopen(pipe, "rb", buffering=0) as stream:
        while True:
            if select.select([pipe], [], [], TICK)[0]:
                if not (text := stream.read(2**16)):
                    return
                heard, before = time.monotonic(), worked(process)
                *lines, left = (left + text.decode()).split("\n")
                yield from lines
            over = None
            if resident(process) > most:
                over = "memory"
            elif worked(process) - before > SECONDS or time.monotonic() - heard > STILL:
                over = "time"
            if over is not None:
                os.kill(process, signal.SIGKILL)
                yield over
                return
