"""A part of the cost. Each is one file of `problem.costs` and is made from a `TaskModel`."""

from __future__ import annotations

from typing import Protocol

from ..arrays import Array
from .state import State


class Cost(Protocol):
    """A part of U; a cost that is also `Projected` is wanted small by the projection of starts."""

    name: str

    def value(self, state: State) -> tuple[float, Array]:
        """Return the value in the unit of U and its gradient in x, shape (v,)."""
        ...
