"""Compiled functions of many points that use all cores."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from ..arrays import Array, Indices

AT_ONCE = 4096
"""Points that a thread takes at a time, for any number of threads: what is found for a point may depend on that before
it, in its last digit."""


def in_threads(function: Callable[..., None], tree: Any, points: Array, *found: Array | Indices) -> None:
    """Have a function write what it finds for points.

    The threads end with this call. Within a worker, of which there are as many as cores, and in a thread that somebody
    else began there are none.

    Args:
        function: of the tree, of some points, and of the same rows of what is written; `compiled_for_threads`.
        tree: given to each call.
        points: shape (n, 3).
        found: written by row, shape (n, ...).
    """
    rows = [slice(start, start + AT_ONCE) for start in range(0, len(points), AT_ONCE)]

    def call(some: slice) -> None:
        function(tree, points[some], *(part[some] for part in found))

    alone = multiprocessing.parent_process() is not None or threading.current_thread() is not threading.main_thread()
    threads = 1 if alone else min(len(rows), _cores())
    if threads <= 1:
        for some in rows:
            call(some)
        return
    pool = ThreadPoolExecutor(threads)
    try:
        for _ in pool.map(call, rows):
            pass
    finally:
        pool.shutdown(cancel_futures=True)


def _cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
