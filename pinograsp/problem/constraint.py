"""A constraint: all that the problem, the solvers and the messages want to know about it.

Each constraint is one file of `problem.constraints` and is made from a `TaskModel`. As the solver sees it, an equality
is zero and an inequality at most zero. Scaling: one millimetre is 0.1 in every constraint, and the cost is U / 1000;
this decides how many starts succeed.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np

from ..arrays import Array
from .state import State

PER_METRE = 100.0
"""Constraint value per metre of violation."""
PER_RADIAN = 10.0
"""Constraint value per radian of violation; a degree weighs about as much as a millimetre."""

Kind = Literal["equality", "inequality"]
Descents = Literal["every", "targets", "clearances"]
"""Descents of the projection that a residual takes part in: every one, those that want the desired contacts, those that
weigh clearances in."""


class Residual(NamedTuple):
    """Values and their Jacobian."""

    values: Array
    """Shape (m,)."""
    jacobian: Array
    """In x, shape (m, v)."""

    def above(self, least: float) -> Residual:
        """Return the values less `least`."""
        return Residual(self.values - least, self.jacobian)

    def scaled(self, scale: float) -> Residual:
        """Return the residual times `scale`."""
        return Residual(scale * self.values, scale * self.jacobian)

    def negative(self) -> Residual:
        """Return the residual with the rows that are not negative set to zero."""
        kept = self.values >= 0.0
        return Residual(np.where(kept, 0.0, self.values), np.where(kept[:, None], 0.0, self.jacobian))


@dataclass(frozen=True)
class Violation:
    """How much a constraint is violated at a point, as the user sees it."""

    name: str
    """Of the figure of the certificate that stands for the constraint."""
    value: float
    """0 if the constraint is kept."""
    unit: str
    where: str
    """Pad, joint or pair of bodies that is worst; may be empty."""
    size: float
    """Its weight, as so many millimetres: compares violations of different units."""


class Constraint(Protocol):
    """A constraint of one task."""

    name: str
    kind: Kind
    figures: Mapping[str, str]
    """Figures of the certificate under which violations are reported, with the unit of the violation."""
    rows: tuple[str, ...]
    """Names of the rows of `residual`."""

    def residual(self, state: State) -> Residual:
        """Return the scaled values (rows,), = 0 for an equality and <= 0 for an inequality, and Jacobian (rows, v)."""
        ...

    def violations(self, state: State) -> list[Violation]:
        """Return the violation of each figure that says something at this state, unsmoothed."""
        ...

    def independent(self, state: State) -> Array:
        """Return combinations of the rows that are independent near a point of contact, shape (r, rows).

        Only equalities are asked.
        """
        return np.eye(len(self.rows))


class Projected(ABC):
    """A constraint or cost that the projection of starts makes small as well."""

    descents: Descents

    @abstractmethod
    def projection(self, state: State, weight: float) -> Residual:
        """Return the residual whose squared norm is to be small, scaled for that, times `weight`."""


class Inside(Constraint, Projected):
    """An inequality that keeps something inside: values of `inside` are at least `least`."""

    kind: Kind = "inequality"
    descents: Descents = "every"
    scale: float
    """Constraint value per unit of `inside`."""
    least: float

    @abstractmethod
    def inside(self, state: State) -> Residual:
        """Return how far inside each row is, negative outside, shape (rows,)."""

    def residual(self, state: State) -> Residual:
        return self.inside(state).above(self.least).scaled(-self.scale)

    def largest_violation(self, state: State, unit: str, scale: float, where: Sequence[str]) -> Violation:
        """Return by how much the row that is least far inside misses `least`.

        Args:
            state: where.
            unit: of the violation, which weighs as much as millimetres.
            scale: from the unit of `inside` to this one.
            where: what each row is about.
        """
        above = self.inside(state).values - self.least
        worst = int(above.argmin())
        missing = max(0.0, -scale * float(above[worst]))
        return Violation(self.name, missing, unit, where[worst], size=missing)

    def projection(self, state: State, weight: float) -> Residual:
        return self.inside(state).above(self.least).negative().scaled(weight * self.scale)
