"""What asks a process to end: Ctrl-C (SIGINT), SIGTERM, and the hang-up of its terminal (SIGHUP).

Python raises KeyboardInterrupt wherever it happens to be: between a grasp and the list that it belongs to, or where a
library drops it. So a command watches these signals. Where nothing is lost, as while it waits, they are `heard` and
raise KeyboardInterrupt; bookkeeping is `held`, and what comes meanwhile is raised after it. What was dropped is raised
again. Before and after a command there is nothing to keep: see `asked`.

Where no command watches, in a script of the user, `heard` changes nothing, and `held` keeps Ctrl-C alone.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from types import FrameType
from typing import Any

from .asked import asking

AGAIN = 0.02
"""Seconds after which it is looked again whether what was raised is on its way."""
DROPPING = ("<frozen importlib._bootstrap>", f"llvmlite{os.sep}binding{os.sep}executionengine.py")
"""Ends of the names of files whose frames drop it: Python's import, of which compiled modules go on without what they
import, and what LLVM calls while it compiles."""

_watch: Watch | None = None


class Watch:
    """What is known of the signals that came to this process."""

    def __init__(self, act: Callable[[int, FrameType | None], object]) -> None:
        self._act = act
        """Called where a signal is heard."""
        self._process = os.getpid()
        self.heard = True
        """Whether what comes now is acted on at once."""
        self.waiting = 0
        """The signal that came and was not acted on; 0: none."""
        self.flying = False
        """Whether a KeyboardInterrupt that was raised has not been caught yet."""
        self.first = 0
        """The signal that came first; 0: none."""

    @property
    def exit_code(self) -> int:
        """Of a command that was asked to end, as shells have it: 130 after Ctrl-C, 143 after SIGTERM."""
        return 128 + (self.first or signal.SIGINT)

    def came(self, number: int, frame: FrameType | None) -> None:
        """Take note of a signal, and act on it if it is heard here."""
        if os.getpid() != self._process:  # a worker that has just been forked
            if number == signal.SIGTERM:
                os._exit(128 + number)
            return
        self.first = self.first or number
        self.waiting = number
        self.tell(frame)

    def look(self, number: int, frame: FrameType | None) -> None:
        """Look whether what was raised is on its way, or was dropped and is to be raised again."""
        if self.flying and _unwinding():
            signal.setitimer(signal.ITIMER_REAL, AGAIN)
            return
        if self.flying:
            self.flying, self.waiting = False, self.waiting or self.first
        self.tell(frame)

    def tell(self, frame: FrameType | None) -> None:
        """Act on what came, if it is heard here."""
        if self.waiting and self.heard and not self.flying:
            number, self.waiting = self.waiting, 0
            self._act(number, frame)

    def raise_(self, number: int, frame: FrameType | None) -> None:
        """Raise KeyboardInterrupt, but never where it would be dropped: then a little later."""
        signal.setitimer(signal.ITIMER_REAL, AGAIN)
        while frame is not None:
            if frame.f_code.co_filename.endswith(DROPPING):
                self.waiting = number
                return
            frame = frame.f_back
        self.flying = True
        raise KeyboardInterrupt


@contextmanager
def watched() -> Iterator[Watch]:
    """Watch the signals while a command runs, in the main thread: KeyboardInterrupt is raised where one is heard."""
    watch = Watch(lambda number, frame: watch.raise_(number, frame))
    hook = sys.unraisablehook

    def dropped(given: Any) -> None:
        """Say nothing of an interrupt that a destructor drops: it is raised again."""
        if given.exc_type is not KeyboardInterrupt:
            hook(given)

    sys.unraisablehook = dropped
    try:
        with _handling({**dict.fromkeys(asking(), watch.came), signal.SIGALRM: watch.look}), _in_charge(watch):
            try:
                yield watch
                if watch.waiting:
                    raise KeyboardInterrupt
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0.0)
    finally:
        sys.unraisablehook = hook


def asked_to_end() -> bool:
    """Whether a signal has asked the command to end."""
    return _watch is not None and _watch.first > 0


def exit_code() -> int:
    """Return the exit code of a command that was asked to end and goes on; see `Watch`."""
    return 128 + signal.SIGINT if _watch is None else _watch.exit_code


def taken() -> None:
    """Say that a KeyboardInterrupt was caught and the work goes on: it was not dropped."""
    if _watch is not None:
        _watch.flying = False


def heard() -> AbstractContextManager[None]:
    """Return a context: what comes in its block is raised there, and first of all what was held before."""
    return _Set(heard=True)


def held() -> AbstractContextManager[None]:
    """Return a context: what comes in its block is raised at its end, or where a part of it is heard."""
    return _Set(heard=False) if _watch is not None else _kept()


def undisguised() -> AbstractContextManager[None]:
    """Return a context: an interrupt that C code has made another error of is raised as what it is.

    Where a signal comes while Numba's dispatcher, in C, calls a function to find the types of its arguments, it goes on
    with the exception set, and Python makes a SystemError of that, of which its callers may make further ones. Pydantic
    makes an error of what comes out of a function that writes a value. Python's own locks complain that they are not
    locked.
    """
    return _Undisguised()


def forget() -> None:
    """Have a worker that was forked leave the signals to its parent; SIGTERM ends it."""
    global _watch
    _watch = None
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


class _Set(AbstractContextManager[None]):
    """Sets whether signals are heard. No generator: one that an interrupt has left would undo it at any time."""

    def __init__(self, heard: bool) -> None:
        self._heard = heard
        self._watch = _watch if threading.current_thread() is threading.main_thread() else None
        self._before = self._watch is not None and self._watch.heard

    def __enter__(self) -> None:
        self._to(self._heard)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, *trace: object) -> None:
        self._to(self._before, tell=kind is None)
        if self._heard:
            _raise_undisguised(error)

    def _to(self, heard: bool, tell: bool = True) -> None:
        if self._watch is not None:
            self._watch.heard = heard
            if tell:
                self._watch.tell(sys._getframe())


class _Undisguised(AbstractContextManager[None]):
    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, *trace: object) -> None:
        _raise_undisguised(error)


def _raise_undisguised(error: BaseException | None) -> None:
    """Raise the interrupt behind an error, if there is one."""
    behind = error.__context__ if type(error) is RuntimeError else error
    while isinstance(behind, Exception):
        behind = behind.__cause__
    if behind is not error and isinstance(behind, KeyboardInterrupt):
        raise behind from None


@contextmanager
def _kept() -> Iterator[None]:
    """Keep Ctrl-C of a script from a block; then its own handler is called."""
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    watch = Watch(handler)
    watch.heard = False
    try:
        with _handling({signal.SIGINT: watch.came}):
            yield
    finally:
        watch.heard = True
        watch.tell(sys._getframe())


@contextmanager
def _handling(handlers: dict[int, Callable[[int, FrameType | None], object]]) -> Iterator[None]:
    before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _in_charge(watch: Watch) -> Iterator[None]:
    global _watch
    before, _watch = _watch, watch
    try:
        yield
    finally:
        _watch = before


def _unwinding() -> bool:
    """Return whether a KeyboardInterrupt is on its way through the frames."""
    error = sys.exc_info()[1]
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            return True
        error = error.__context__
    return False
