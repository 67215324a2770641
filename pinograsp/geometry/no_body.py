"""Triangles that enclose no body: why."""

from __future__ import annotations

from ..arrays import Array


class NoBodyError(Exception):
    """The triangles enclose no body.

    Args:
        problem: what is wrong.
        remedy: what to do.
    """

    def __init__(self, problem: str, remedy: str) -> None:
        super().__init__(problem)
        self.problem, self.remedy = problem, remedy


def in_brackets(place: Array) -> str:
    """Return coordinates as text, to a tenth of a millimetre."""
    return "(" + ", ".join(f"{value:.4f}" for value in place + 0.0) + ")"
