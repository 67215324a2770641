"""The figures that prove a grasp, and the distances of a posture pair by pair."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from .. import notebook
from ..frozen import Record, unknown
from ..json_types import Null
from ..units import shown

NAMED = 3
"""Figures that a representation names."""


@dataclass(frozen=True, eq=False, repr=False)
class Figure(Record):
    """One recomputed quantity against its limit; one that nothing limits has the limit -inf, "at least"."""

    also_in_json = ("holds",)

    name: str
    """Of the quantity, such as "joint reserve"."""
    value: Annotated[float, Null(math.nan)]
    """In `unit`; nan or infinite where it could not be computed."""
    limit: Annotated[float, Null(math.nan)]
    """In `unit`; infinite if nothing limits the value."""
    unit: str
    """SI, angles in radians; empty for a pure number."""
    sense: Literal["at least", "at most"]
    """On which side of the limit the value must be."""
    where: str = ""
    """Pair of bodies, pad or joint that is nearest to the limit."""

    @classmethod
    def of_json(cls, values: Mapping[str, Any]) -> Self:
        """Return the figure of values by field, where JSON had null for what was not finite.

        A limit then judges nothing; a length that has to be large is an overlap whose depth is not known.
        """
        most, value, limit = values["sense"] == "at most", values["value"], values["limit"]
        if math.isnan(value) and values["unit"] == "m" and not most:
            value = -math.inf
        if math.isnan(limit):
            limit = math.inf if most else -math.inf
        return cls(**{**values, "value": value, "limit": limit})

    @property
    def holds(self) -> bool:
        """Whether the value keeps its limit; a value that is not finite never does."""
        if not math.isfinite(self.value):
            return False
        return self.value >= self.limit if self.sense == "at least" else self.value <= self.limit

    @property
    def shown_value(self) -> str:
        """The value in the unit in which tables show it, such as "31.2 mm"; "overlap" where no exact depth is known."""
        return shown(self.value, self.unit)

    @property
    def shown_limit(self) -> str:
        """The limit in the unit in which tables show it, such as "≥ 5 mm"; empty if nothing limits the value."""
        if not math.isfinite(self.limit):
            return ""
        return f"{'≥' if self.sense == 'at least' else '≤'} {shown(self.limit, self.unit)}"


@dataclass(frozen=True, eq=False, repr=False)
class Certificate(Record, Mapping[str, Figure]):
    """Every figure of the independent check of one grasp; a mapping of figures by name, in the order of `figures`.

    Raises:
        UnknownNameError: (a `KeyError`, when a figure is looked up) there is none of this name; close ones are named.
    """

    also_in_json = ("verified",)

    figures: tuple[Figure, ...]
    """All that was recomputed; all of them hold if the grasp is verified."""

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
        for figure in self.figures:
            if figure.name == name:
                return figure
        raise unknown(name, self)

    def __contains__(self, name: object) -> bool:
        return any(figure.name == name for figure in self.figures)

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(dict.fromkeys(figure.name for figure in self.figures))

    def __len__(self) -> int:
        return len({figure.name for figure in self.figures})

    def __repr__(self) -> str:
        refuted = self.refuted_by
        if not refuted:
            return f"<Certificate: verified, {len(self)} figures>"
        return f"<Certificate: refuted by {summary(refuted)}>"

    def _repr_html_(self) -> str:
        refuted = self.refuted_by
        verdict = f"not verified: refuted by {summary(refuted)}" if refuted else "verified"
        rows = [
            notebook.row(
                (figure.name, figure.shown_value, figure.shown_limit, "" if figure.holds else "fails", figure.where),
                bold=not figure.holds,
            )
            for figure in self.figures
        ]
        return notebook.table(f"Certificate: {verdict}", rows, ("figure", "value", "limit", "", "where"))


@dataclass(frozen=True, eq=False, repr=False)
class PairClearance(Record):
    """The distance of a link to something else."""

    name: str
    """Kind of the clearance, as in a certificate."""
    link: str
    """Name of the link."""
    other: str
    """Name of the wall, obstacle, object or link."""
    distance: float
    """m, at most 0.05; negative if they overlap, -inf where they do and no exact depth is known."""


def summary(figures: tuple[Figure, ...]) -> str:
    """Return figures that are not kept in one line of plain text, the first `NAMED` of them by name."""
    said = [f"{f.name} {f.shown_value} ({f.shown_limit})" for f in figures[:NAMED]]
    return ", ".join(said) + (f" and {len(figures) - NAMED} more" if len(figures) > NAMED else "")
