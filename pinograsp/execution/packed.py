"""Work that travels: a builder goes as bytes, and what it builds is kept in the process where it arrives."""

from __future__ import annotations

import pickle
import threading
import traceback
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from ..disk import digest

Built = TypeVar("Built")

KEPT = 8
"""Built things that a thread keeps: those used last."""


class _Kept(threading.local):
    """The one cache of the workers, by token; one for each thread, since Pinocchio's data serve one at a time."""

    def __init__(self) -> None:
        self.by_token: OrderedDict[str, Any] = OrderedDict()


_kept = _Kept()


@dataclass(frozen=True)
class Packed(Generic[Built]):
    """A builder as bytes, small to send, with a token that tells builders apart by their content.

    A builder may hold further packed builders, of parts that several builders share: these too are built once.
    """

    token: str
    payload: bytes

    @classmethod
    def of(cls, build: Callable[[], Built]) -> Packed[Built]:
        """Pack a builder: picklable, such as a `functools.partial` of a function of the package."""
        payload = pickle.dumps(build)
        return cls(digest(payload), payload)

    def built(self) -> Built:
        """Return the object of the builder: kept by this thread, or built now."""
        kept = _kept.by_token
        if self.token not in kept:
            kept[self.token] = pickle.loads(self.payload)()
        kept.move_to_end(self.token)
        while len(kept) > KEPT:
            kept.popitem(last=False)
        built: Built = kept[self.token]
        return built


def run_chunk(packed: Packed[Callable[[Any], Any]], items: Sequence[Any], attempt: int) -> bytes:
    """Handle items one after the other, in a worker.

    Args:
        packed: builds the handler.
        items: what it is given.
        attempt: number of the attempt; executors that know calls by their arguments take the second for another call.

    Returns:
        Pickled: the outcomes and the exception that ended them, or None. So an exception of the executor itself is
        never taken for one of the handler.
    """
    outcomes: list[Any] = []
    try:
        handle = packed.built()
        outcomes.extend(map(handle, items))
        return pickle.dumps((outcomes, None))
    except MemoryError:  # the worker's trouble, not the handler's: its items are repeated elsewhere
        raise
    except Exception as error:
        error.add_note(f"In a worker:\n{traceback.format_exc()}")
        return pickle.dumps((outcomes, error))
