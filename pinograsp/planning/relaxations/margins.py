"""Smaller margins."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from .variant import Failure, Variant, place


def margins(failure: Failure) -> Iterator[Variant]:
    """Yield smaller margins: those that are violated."""
    of = {"enclosure clearance": "enclosure", "obstacle clearance": "enclosure", "objects.pose": "enclosure"}
    of |= {"self clearance": "robot", "object clearance": "object", "pad clearance": "object"}
    given = failure.task.margin
    for key in dict.fromkeys(of[kind] for kind in failure.kinds if kind in of):
        had = float(getattr(given, key))
        if had > 0.0:
            yield _margin(failure, key, had)


def _margin(failure: Failure, key: str, had: float) -> Variant:
    def left(size: float) -> float:
        return max(0.0, round(had - size, 9))

    def changes(size: float) -> Mapping[str, Any]:
        margin = failure.task.margin.model_dump(mode="json")
        return {place("tasks", failure.task_name, "margin"): {**margin, key: left(size)}}

    def text(size: float) -> str:
        return f"a margin.{key} of {1e3 * left(size):.1f} mm instead of {1e3 * had:.1f} mm"

    return Variant("margin", "m", 1e-4, changes, lambda size: had - left(size), text, (0.25 * had, 0.5 * had, had))
