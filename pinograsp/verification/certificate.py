"""The figures that prove a grasp."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Figure:
    """One recomputed quantity against its limit, in `unit`; one that nothing limits has the limit -inf, "at least"."""

    name: str
    value: float
    limit: float
    unit: str
    sense: Literal["at least", "at most"]
    where: str = ""
    """The pair of bodies, the pad or the joint whose value it is: the one that is nearest to the limit."""

    @property
    def holds(self) -> bool:
        """Whether the value keeps its limit; a value that is not finite never does."""
        if not math.isfinite(self.value):
            return False
        return self.value >= self.limit if self.sense == "at least" else self.value <= self.limit


@dataclass(frozen=True)
class Certificate:
    """Every figure of the independent check of one grasp."""

    figures: tuple[Figure, ...]

    @property
    def verified(self) -> bool:
        """Whether every figure keeps its limit."""
        return all(figure.holds for figure in self.figures)

    @property
    def refuted_by(self) -> tuple[Figure, ...]:
        """The figures that do not keep their limit."""
        return tuple(figure for figure in self.figures if not figure.holds)

    def __getitem__(self, name: str) -> Figure:
        """Return a figure by name."""
        return next(figure for figure in self.figures if figure.name == name)

    def to_json(self) -> dict[str, Any]:
        """Return the certificate as JSON data; numbers that are not finite, which JSON lacks, are None."""
        return {
            "verified": self.verified,
            "figures": [
                {
                    "name": f.name,
                    "value": f.value if math.isfinite(f.value) else None,
                    "limit": f.limit if math.isfinite(f.limit) else None,
                    "sense": f.sense,
                    "unit": f.unit,
                    "where": f.where,
                    "holds": f.holds,
                }
                for f in self.figures
            ],
        }
