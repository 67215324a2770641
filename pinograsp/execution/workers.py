"""Workers: this process, processes of our own that stay warm, or an executor that the user gives."""

from __future__ import annotations

import math
import multiprocessing
import os
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Protocol, Self, TypeVar

from threadpoolctl import ThreadpoolController, threadpool_limits

from ..errors import WorkerLostError, whole_number
from ..interrupts import forget, heard, held
from .distribute import distribute, refuse
from .packed import Packed, run_chunk

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")


class Workers(Protocol):
    """Runs independent pieces of work; a context manager that ends what it started."""

    def begin(self) -> None:
        """Have processes of our own begin now: before this process has threads that a fork would lose."""

    def run(
        self,
        prepare: Callable[[], Callable[[Item], Outcome]],
        items: Sequence[Item],
        chunk: int = 8,
        lost: Callable[[Item, str], Outcome] = refuse,
    ) -> Generator[Outcome]:
        """Yield the outcome of every item, in any order.

        Args:
            prepare: builds the handler of items; picklable (a `functools.partial` of a function of the package). Where
                a process of ours has run the same before, its handler is still there.
            items: picklable pieces of work.
            chunk: items that a worker takes at a time.
            lost: makes an outcome of an item whose worker died, of the item when it was repeated alone, and of the
                reason.

        Raises:
            WorkerLostError: by default, for such an item; also if workers die whatever they are given.
            Exception: whatever `prepare` or the handler raises.

        Closing the generator, as an exception does, drops what has not begun. Where Ctrl-C ends it, what has begun is
        waited for, and its outcomes come before KeyboardInterrupt; a second Ctrl-C ends that, too.
        """

    def __enter__(self) -> Self: ...

    def __exit__(self, *error: object) -> None: ...


class ThisProcess:
    """No workers: items are handled here, one after the other. `lost` has no use, and nothing is pickled.

    As in processes of our own, BLAS has one thread meanwhile: the matrices are small, and on a busy machine several
    threads wait for each other five times as long as they compute. Nor may sums depend on the number of threads.
    """

    def begin(self) -> None:
        pass

    def run(
        self,
        prepare: Callable[[], Callable[[Item], Outcome]],
        items: Sequence[Item],
        chunk: int = 8,
        lost: Callable[[Item, str], Outcome] = refuse,
    ) -> Generator[Outcome]:
        with heard(), threadpool_limits(1):
            handle = prepare()
        threads = ThreadpoolController()
        for item in items:
            with heard(), threads.limit(limits=1):
                outcome = handle(item)
            yield outcome

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        pass


class _Distributing(ABC):
    """Workers that take chunks by an executor."""

    _width: float
    """Chunks that are with the executor at a time."""

    def run(
        self,
        prepare: Callable[[], Callable[[Item], Outcome]],
        items: Sequence[Item],
        chunk: int = 8,
        lost: Callable[[Item, str], Outcome] = refuse,
    ) -> Generator[Outcome]:
        return distribute(self._submit, self._width, prepare, items, chunk, lost)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._end()

    @abstractmethod
    def _submit(self, packed: Packed[Any], items: Sequence[Any], attempt: int) -> Future[bytes]: ...

    @abstractmethod
    def _end(self) -> None: ...


class GivenExecutor(_Distributing):
    """An executor of processes that the user gives and ends, such as `distributed.Client.get_executor()`.

    A worker needs pinograsp, and one BLAS thread (OMP_NUM_THREADS=1, as Dask's nannies set it). Executors of threads
    work too, each thread with a handler of its own, but gain nothing: Pinocchio and Coal hold the interpreter lock.
    """

    _width = math.inf

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def begin(self) -> None:
        pass

    def _submit(self, packed: Packed[Any], items: Sequence[Any], attempt: int) -> Future[bytes]:
        return self._executor.submit(run_chunk, packed, items, attempt)

    def _end(self) -> None:
        """Leave the executor to whoever gave it."""


class Processes(_Distributing):
    """Processes of our own, begun with the first run, warm until closed, begun anew when one of them dies.

    Where the system can fork they share what this process holds when they begin, compiled functions among it, and need
    no `if __name__ == "__main__"` in the user's script.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self._width = count + 1  # whichever process is free first need not wait for this one
        self._pool: ProcessPoolExecutor | None = None

    def begin(self) -> None:
        """Begin them.

        Raises:
            WorkerLostError: they end at once, and those that are begun in their place, too.
        """
        try:
            self._sent(os.getpid).result()
        except BrokenProcessPool:  # one of them died since the last run
            self._end()
            try:
                self._sent(os.getpid).result()
            except BrokenProcessPool:
                raise WorkerLostError("worker processes ended as soon as they had begun, twice") from None

    def _submit(self, packed: Packed[Any], items: Sequence[Any], attempt: int) -> Future[bytes]:
        try:
            return self._sent(run_chunk, packed, items, attempt)
        except BrokenProcessPool:
            self._end()
            return self._sent(run_chunk, packed, items, attempt)

    def _sent(self, call: Callable[..., Outcome], *given: object) -> Future[Outcome]:
        """Submit a call; the first one begins the processes, and the thread that feeds and ends them."""
        with held():  # processes that no thread feeds yet would never end, nor who waits for them
            if self._pool is None:
                method = "fork" if "fork" in multiprocessing.get_all_start_methods() else "spawn"
                self._pool = ProcessPoolExecutor(self._count, multiprocessing.get_context(method), _begin)
            return self._pool.submit(call, *given)

    def _end(self) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None


def own_workers(count: int | None = None) -> Workers:
    """Return this process for a count of 1, otherwise as many processes; None: one for each core.

    Raises:
        InputError: the count, which users give as `workers`, is no whole number, or below 1.
    """
    count = (os.cpu_count() or 1) if count is None else whole_number("workers", count, 1)
    return ThisProcess() if count == 1 else Processes(count)


def _begin() -> None:
    forget()  # Ctrl-C reaches the whole process group; only the parent acts on it
    threading.Thread(target=_die_with_parent, args=(os.getppid(),), daemon=True).start()
    threadpool_limits(1)  # the processes are the parallelism: BLAS threads would only compete with them


def _die_with_parent(parent: int) -> None:
    """End this process when its parent has ended, even by SIGKILL: siblings keep the queues open for ever."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)
