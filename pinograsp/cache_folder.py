"""The user's cache folder, and the temporary one of a process that cannot write there."""

from __future__ import annotations

import contextlib
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import TypeVar

from .errors import CacheWarning, UnwritableError

Value = TypeVar("Value")

REMEDY = "Set PINOGRASP_CACHE to a folder that can be written"


def cache_folder() -> Path:
    """Return the cache folder: PINOGRASP_CACHE, or pinograsp below XDG_CACHE_HOME or ~/.cache.

    Raises:
        UnwritableError: none of them is known: the user has no home folder.
    """
    if own := os.environ.get("PINOGRASP_CACHE"):
        return Path(own)
    if base := os.environ.get("XDG_CACHE_HOME"):
        return Path(base) / "pinograsp"
    try:
        return Path.home() / ".cache" / "pinograsp"
    except RuntimeError:
        raise UnwritableError("there is no home folder for the cache", remedy=REMEDY) from None


def cache_folders() -> Iterator[Path]:
    """Yield the folders where something may be kept already: the user's, and the temporary one if there is one."""
    with contextlib.suppress(UnwritableError):
        yield cache_folder()
    if _temporary.cache_info().currsize:
        yield Path(_temporary().name)


def in_cache(write: Callable[[Path], Value]) -> Value:
    """Have something written into the cache folder, or if that cannot be, with a warning, into a temporary one.

    Args:
        write: is given the folder; raises UnwritableError.

    Raises:
        UnwritableError: it can be written in neither; the message names the cache folder.
    """
    folder = None
    try:
        folder = cache_folder()
        return write(folder)
    except UnwritableError as error:
        problem = error.problem if folder is None else f"the cache folder {error.problem}"
        wrong = UnwritableError(problem, file=folder, remedy=REMEDY)
    try:
        kept = write(Path(_temporary().name))
    except (OSError, UnwritableError):
        raise wrong from None
    _warn(str(wrong))
    return kept


@cache
def _temporary() -> tempfile.TemporaryDirectory[str]:
    """Return the temporary folder of this process, which is removed with it; forked workers have the same."""
    return tempfile.TemporaryDirectory(prefix="pinograsp-cache-")


@cache
def _warn(wrong: str) -> None:
    """Warn of a folder, once in a process."""
    warnings.warn(f"{wrong}; until then a temporary one is used", CacheWarning, stacklevel=2)
