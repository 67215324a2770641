"""Results that are kept as long as what they were computed from.

For pure functions of objects that never change: what depends on a robot alone is computed once for all scenes and
tasks, and goes when the robot goes.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import update_wrapper
from typing import TypeVar, TypeVarTuple

Subject = TypeVar("Subject")
Rest = TypeVarTuple("Rest")
Value = TypeVar("Value")


def remembered(
    function: Callable[[Subject, *Rest], Value],
) -> Callable[[Subject, *Rest], Value]:
    """Keep the values of a function for each object that is its first argument, by identity, while that object lives.

    Further arguments must be hashable and positional.
    """
    kept: dict[int, dict[tuple[object, ...], Value]] = {}

    def wrapper(subject: Subject, /, *rest: *Rest) -> Value:
        number = id(subject)
        if number not in kept:
            kept[number] = {}
            weakref.finalize(subject, kept.pop, number, None)
        values = kept[number]
        if rest not in values:
            values[rest] = function(subject, *rest)
        return values[rest]

    update_wrapper(wrapper, function)
    return wrapper
