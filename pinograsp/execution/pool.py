"""Independent pieces of work over worker processes.

Pinocchio and Coal hold the interpreter lock, so processes it is; each builds what it needs once (`prepare`) and
then handles items. Results come as they are done; what an item gives does not depend on the number of workers.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")

_handle: Callable[[Any], Any]  # set once in every worker process


def work(
    prepare: Callable[[], Callable[[Item], Outcome]], items: Sequence[Item], workers: int, chunk: int = 8
) -> Generator[Outcome]:
    """Yield the outcome of every item, in any order.

    Args:
        prepare: builds the handler of items; must be picklable (a `functools.partial` of a module's function).
        items: picklable pieces of work.
        workers: number of processes; with 1 everything happens in this process.
        chunk: items that a worker takes at a time.

    Closing the generator, as an exception such as KeyboardInterrupt does, drops what has not begun.
    """
    if workers <= 1:
        yield from map(prepare(), items)
        return
    chunks = [items[i : i + chunk] for i in range(0, len(items), chunk)]
    # Forked workers need no `if __name__ == "__main__"` in the user's script.
    method = "fork" if "fork" in multiprocessing.get_all_start_methods() else "spawn"
    executor = ProcessPoolExecutor(
        min(workers, len(chunks)) or 1,
        mp_context=multiprocessing.get_context(method),
        initializer=_begin,
        initargs=(prepare,),
    )
    try:
        # No list of the futures is kept: it would hold every outcome until the end.
        for future in as_completed([executor.submit(_run_chunk, some) for some in chunks]):
            yield from future.result()
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


def _begin(prepare: Callable[[], Callable[[Any], Any]]) -> None:
    # Ctrl-C reaches the whole process group; only the parent acts on it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_die_with_parent, args=(os.getppid(),), daemon=True).start()
    threadpool_limits(1)  # the processes are the parallelism: BLAS threads would only compete with them
    global _handle
    try:
        _handle = prepare()
    except Exception as error:
        _handle = _Raise(error)  # reaches the parent as the outcome of the first item, not as a broken pool


class _Raise:
    """Handles every item by raising an error."""

    def __init__(self, error: Exception) -> None:
        self._error = error

    def __call__(self, item: object) -> None:
        raise self._error


def _die_with_parent(parent: int) -> None:
    """End this process when its parent has ended, even by SIGKILL: siblings keep the queues open for ever."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def _run_chunk(chunk: Sequence[Any]) -> list[Any]:
    return [_handle(item) for item in chunk]
