"""Smaller margins."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from .variant import Change, Failure, Variant, place

MARGIN_OF = {
    "enclosure clearance": "enclosure",
    "obstacle clearance": "enclosure",
    "objects.pose": "enclosure",
    "self clearance": "robot",
    "object clearance": "object",
    "pad clearance": "object",
}
"""The margin that a constraint keeps, or that a refusal with a key of the scene is about."""


def margins(failure: Failure) -> Iterator[Change]:
    """Yield smaller margins, each of those that are violated."""
    given = failure.task.margin
    for key in dict.fromkeys(MARGIN_OF[kind] for kind in failure.kinds if kind in MARGIN_OF):
        had = float(getattr(given, key))
        if had > 0.0:
            yield _margin(failure, key, had)


def _margin(failure: Failure, key: str, had: float) -> Change:
    def left(size: float) -> float:
        return max(0.0, round(had - size, 9))

    def changes(size: float) -> Mapping[str, Any]:
        margin = failure.task.margin.model_dump(mode="json")
        return {place("tasks", failure.task_name, "margin"): {**margin, key: left(size)}}

    def text(size: float) -> str:
        return f"a margin.{key} of {1e3 * left(size):.1f} mm instead of {1e3 * had:.1f} mm"

    def tried(size: float) -> str:
        return f"a margin.{key} of down to {1e3 * left(size):.1f} mm"

    sizes = (0.25 * had, 0.5 * had, had)
    return Change("margin", "m", 1e-4, sizes, (Variant(changes, lambda size: had - left(size), text),), tried, True)
