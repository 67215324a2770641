"""Functions of numbers and arrays, compiled by Numba: where a point x of a problem spends its time.

The matrices of a grasp are so small that NumPy takes far longer to look at its arguments than to compute. Such
functions are loops instead, or NumPy where that is as clear, and are compiled at their first call (once on a machine:
Numba keeps what it compiled beside the source or in the user's cache folder). With NUMBA_DISABLE_JIT=1 in the
environment all of them run as they are written, for a debugger.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, TypeVar, cast

import numba
from numba.core import caching, event

from .disk import make_way, write_whole
from .errors import UnwritableError
from .progress import Progress, Report
from .seal import sealed, unsealed

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile a function; division by zero gives infinity or NaN, as in NumPy."""
    return _compiled(function, error_model="numpy")


def compiled_for_threads(function: Function) -> Function:
    """Compile a function during which other threads of Python run, as `compiled`."""
    return _compiled(function, error_model="numpy", nogil=True)


def _compiled(function: Function, **options: Any) -> Function:
    try:
        made = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # no folder can be written: compiled in every process
        return cast(Function, numba.njit(**options)(function))
    if (cache := getattr(made, "_cache", None)) is not None:  # none with NUMBA_DISABLE_JIT
        cache._cache_file.__class__ = _Sealed
    return cast(Function, made)


class _Sealed(caching.IndexDataCacheFile):  # type: ignore[misc]  # Numba has no types
    """The files of a function that Numba keeps, each with a seal: what is damaged is compiled anew.

    Numba takes files as they are: a damaged index is an error in every call, damaged machine code ends the process.
    """

    def _load_index(self) -> dict[Any, str]:
        if not _is_sealed(Path(self._index_path)):
            return {}
        try:
            found: dict[Any, str] = super()._load_index()
        except (AttributeError, ImportError):  # it names a type that another version had somewhere else
            return {}
        return found

    def _load_data(self, name: str) -> Any:
        if not _is_sealed(Path(self._data_path(name))):
            raise OSError  # for which Numba takes one that is missing
        return super()._load_data(name)

    def save(self, key: Any, data: Any) -> None:
        """Keep what was compiled, or where that cannot be, as on a full disk, compile it in every process."""
        with contextlib.suppress(UnwritableError):
            super().save(key, data)

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[IO[bytes]]:
        content = io.BytesIO()
        yield content
        make_way(Path(filepath))
        write_whole(Path(filepath), sealed(content.getvalue()))


def _is_sealed(file: Path) -> bool:
    try:
        return unsealed(file.read_bytes()) is not None
    except OSError:
        return False


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
