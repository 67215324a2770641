"""Calls of functions that let other threads run, on all cores."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Value = TypeVar("Value")


def on_all_cores(calls: Sequence[Callable[[], Value]]) -> list[Value]:
    """Return what calls return, in their order.

    The threads end with this call. Within a worker, of which there are as many as cores, and in a thread that somebody
    else began there are none.

    Args:
        calls: of functions that are `compiled_for_threads`, in any order and at once.
    """
    alone = multiprocessing.parent_process() is not None or threading.current_thread() is not threading.main_thread()
    threads = 1 if alone else min(len(calls), _cores())
    if threads <= 1:
        return [call() for call in calls]
    pool = ThreadPoolExecutor(threads)
    try:
        return list(pool.map(lambda call: call(), calls))
    finally:
        pool.shutdown(cancel_futures=True)


def _cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
