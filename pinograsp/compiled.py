"""Functions of numbers and arrays, compiled by Numba: where a point x of a problem spends its time.

The matrices of a grasp are so small that NumPy takes far longer to look at its arguments than to compute. Such
functions are loops instead, or NumPy where that is as clear, and are compiled at their first call (once on a machine:
Numba keeps what it compiled beside the source or in the user's cache folder). With NUMBA_DISABLE_JIT=1 in the
environment all of them run as they are written, for a debugger.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar, cast

import numba
from numba.core import event

from .progress import Progress, Report

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile a function; division by zero gives infinity or NaN, as in NumPy."""
    try:
        return cast(Function, numba.njit(cache=True, error_model="numpy")(function))
    except RuntimeError:  # no folder can be written: compiled in every process
        return cast(Function, numba.njit(error_model="numpy")(function))


@contextmanager
def compiling(report: Report) -> Iterator[None]:
    """Report functions as they are compiled within the block; those that a folder holds already are none of them."""
    with event.install_listener("numba:compile", _Compiled(report)):
        yield


class _Compiled(event.Listener):  # type: ignore[misc]  # Numba has no types
    """Counts the functions that are compiled."""

    def __init__(self, report: Report) -> None:
        self._report, self._done = report, 0

    def on_start(self, event: Any) -> None:
        self._report(Progress("compiling", self._done))

    def on_end(self, event: Any) -> None:
        self._done += 1
        self._report(Progress("compiling", self._done))
