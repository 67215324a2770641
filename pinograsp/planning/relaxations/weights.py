"""Smaller loads."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from .variant import Change, Failure, Variant, place

LIGHTER = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
"""By how many parts of what is left the load is reduced: 1.0 leaves the half."""
DIGITS = 3
"""Of the load that is left."""


def weights(failure: Failure) -> Iterator[Change]:
    """Yield a smaller load: the mass of the object, or the task's wrench."""
    task, wrench = failure.task, failure.scene.wrench_of(failure.task)
    had = float(np.linalg.norm(wrench.force))
    if had == 0.0:
        return

    def left(size: float) -> float:
        number = had / (1.0 + size)
        unit = 10.0 ** (math.floor(math.log10(number)) - DIGITS + 1)
        return math.floor(number / unit) * unit

    def changes(size: float) -> Mapping[str, Any]:
        share = left(size) / had
        if task.wrench is None:
            mass = failure.scene.objects[task.object].mass or 0.0
            return {place("objects", task.object, "mass"): share * mass}
        parts = {"force": [share * f for f in wrench.force], "torque": [share * t for t in wrench.torque]}
        return {place("tasks", failure.task_name, "wrench"): parts}

    def text(size: float) -> str:
        return f"a load of {left(size):.3g} N instead of {had:.3g} N"

    def tried(size: float) -> str:
        return f"a load of down to {left(size):.3g} N"

    yield Change("weight", "N", 1e-3, LIGHTER, (Variant(changes, left, text),), tried, True)
