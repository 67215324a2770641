"""Chunks of items given to an executor, outcomes taken as they are done, and dead workers made up for.

Whatever the executor raises (a process was killed, memory ran out, a library crashed) concerns a chunk, not an item:
the chunk is set aside. When all others are done, its items are repeated one at a time, with nothing else running. So an
item that ends its worker ends nothing else, and is known by name when it does so again.
"""

from __future__ import annotations

import pickle
import reprlib
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError, Future
from contextlib import closing
from queue import SimpleQueue
from typing import Any, NoReturn, Protocol, TypeVar

from ..errors import WorkerLostError
from ..interrupts import heard, taken
from .packed import Packed

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")

HOPELESS = 8
"""Lost items without a single outcome after which the others are not tried."""


class Submit(Protocol):
    """Sends a chunk to an executor: packed handler, items, number of the attempt; the future holds pickled outcomes."""

    def __call__(self, packed: Packed[Any], items: Sequence[Any], attempt: int, /) -> Future[bytes]: ...


def refuse(item: object, reason: str) -> NoReturn:
    """Raise for a lost item."""
    raise WorkerLostError(f"the worker of {reprlib.repr(item)} ended twice: {reason}")


def distribute(
    submit: Submit,
    width: float,
    prepare: Callable[[], Callable[[Item], Outcome]],
    items: Sequence[Item],
    chunk: int,
    lost: Callable[[Item, str], Outcome],
) -> Generator[Outcome]:
    """Yield the outcome of every item, in any order; see `Workers.run`.

    Args:
        submit: sends a chunk to the executor.
        width: chunks that are with the executor at a time.
        prepare: builds the handler of items.
        items: pieces of work.
        chunk: items that a worker takes at a time.
        lost: outcome of an item whose worker ended twice, and the reason.
    """
    packed = Packed.of(prepare)
    chunks = [items[i : i + chunk] for i in range(0, len(items), chunk)]
    set_aside: list[Item] = []
    done = gone = 0
    with closing(_landed(submit, width, packed, chunks, attempt=1)) as landed:
        for some, future in landed:
            if _error(future):
                set_aside.extend(some)
                continue
            for outcome in _outcomes(future):
                done += 1
                yield outcome
    with closing(_landed(submit, 1, packed, [[item] for item in set_aside], attempt=2)) as landed:
        for (item,), future in landed:
            if error := _error(future):
                gone += 1
                reason = f"{type(error).__name__}: {error}"
                if not done and gone == HOPELESS:
                    raise WorkerLostError(f"{gone} workers ended in a row, without a single outcome: {reason}")
                yield lost(item, reason)
                continue
            done += 1
            yield from _outcomes(future)


def _landed(
    submit: Submit, width: float, packed: Packed[Any], chunks: Sequence[Sequence[Item]], attempt: int
) -> Generator[tuple[Sequence[Item], Future[bytes]]]:
    """Yield chunks with their future as these are done; closed, cancel what has not begun.

    Ctrl-C cancels it as well, and is raised after what is done by workers that do not know of it.
    """
    waiting = iter(chunks)
    flying: dict[Future[bytes], Sequence[Item]] = {}
    landed: SimpleQueue[Future[bytes]] = SimpleQueue()
    interrupt: KeyboardInterrupt | None = None

    def fill() -> None:
        while len(flying) < width and (some := next(waiting, None)) is not None:
            future = _sent(submit, packed, some, attempt)
            flying[future] = some
            future.add_done_callback(landed.put)

    try:
        fill()
        while flying:
            try:
                with heard():
                    future = landed.get()
            except KeyboardInterrupt as again:
                if interrupt:
                    raise
                taken()
                interrupt = again
                for begun in tuple(flying):
                    if begun.cancel() or begun.done():
                        landed.put(begun)  # once more: what was taken as the interrupt came is lost
                continue
            some = flying.pop(future, None)
            if some is None:
                continue
            if interrupt is None:
                fill()  # before the outcomes are looked at: workers must not wait for whoever consumes them
            elif _error(future):
                continue
            yield some, future
        if interrupt:
            raise interrupt
    finally:
        for future in flying:
            future.cancel()


def _sent(submit: Submit, packed: Packed[Any], items: Sequence[Any], attempt: int) -> Future[bytes]:
    """Submit a chunk; an executor that refuses it counts like one that loses it."""
    try:
        return submit(packed, items, attempt)
    except Exception as error:
        refused: Future[bytes] = Future()
        refused.set_exception(error)
        return refused


def _error(future: Future[bytes]) -> BaseException | None:
    """Return the exception of the executor: what the handler raised is among the outcomes."""
    return CancelledError("the call was cancelled") if future.cancelled() else future.exception()


def _outcomes(future: Future[bytes]) -> Iterator[Any]:
    outcomes, error = pickle.loads(future.result())
    yield from outcomes
    if error is not None:
        raise error
