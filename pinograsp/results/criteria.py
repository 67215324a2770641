"""Criteria that grasps are compared by: one list, over which order, Pareto front, tables and command line loop.

A criterion is one number of a grasp, in SI units, of which more or less is better. The number of a grasp whose
certificate lacks the figure is nan; such a grasp is worse than all that have one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import Array
from ..errors import InputError, UnknownNameError, close_names
from ..units import shown, shown_in
from .grasp import Grasp

Numbers = dict[str, float]
"""The numbers of one grasp by name: the figures of its certificate, and U."""


def numbers_of(grasp: Grasp) -> Numbers:
    """Return the numbers of a grasp that criteria read."""
    return {figure.name: figure.value for figure in grasp.certificate.figures} | {"U": grasp.cost.U}


@dataclass(frozen=True, kw_only=True)
class Criterion:
    """One number of a grasp, in `unit`, and which of two is better."""

    name: str
    """By which grasps are ranked: `result.ranked(name)`."""
    meaning: str
    """A few words for tables and help."""
    figures: tuple[str, ...]
    """Figures of the certificate, or U; the worst of those that a grasp has is its value."""
    better: Literal["least", "most"]
    """Which of two numbers is the better one."""
    unit: str
    """Of its numbers: SI, rad; empty for a pure number."""
    resolution: float = 0.0
    """Score and Pareto front take values as equal that are the same when rounded to its multiples; 0: exact."""
    scored: bool = False
    """Whether it counts in the score that orders the grasps of a tier."""
    heading: str = ""
    """Of its column in tables; it has none without."""
    format: str = "z.1f"
    """Of its numbers in tables."""
    narrow: bool = False
    """Whether it has a column in the terminal, too, where there is little room."""

    def values(self, grasps: Sequence[Numbers]) -> Array:
        """Return the values of grasps, shape (n,), nan where a grasp has none."""
        of_figures = [[numbers.get(name, math.nan) for numbers in grasps] for name in self.figures]
        worst = np.fmin if self.better == "most" else np.fmax  # of a value and nan, the value
        return np.asarray(worst.reduce(np.array(of_figures, dtype=np.float64), axis=0))

    def merits(self, grasps: Sequence[Numbers]) -> Array:
        """Return the values of grasps, shape (n,), turned so that more is better; -inf where a grasp has none."""
        values = self.values(grasps)
        return np.where(np.isnan(values), -np.inf, -values if self.better == "least" else values)

    def levels(self, grasps: Sequence[Numbers]) -> Array:
        """Return `merits` in whole multiples of the resolution."""
        merits = self.merits(grasps)
        return np.rint(merits / self.resolution) if self.resolution else merits

    def cell(self, numbers: Numbers) -> str:
        """Return the value of a grasp as tables show it; a dash where it has none."""
        return self.shown(numbers).removesuffix(self.shown_unit).rstrip()

    def shown(self, numbers: Numbers) -> str:
        """Return `cell` with its unit."""
        value = float(self.values([numbers])[0])
        return "-" if math.isnan(value) else shown(value, self.unit, self.format)

    @property
    def shown_unit(self) -> str:
        """The unit of `cell`."""
        return shown_in(self.unit)[1]


CRITERIA = (
    Criterion(
        name="U",
        meaning="cost index",
        figures=("U",),
        better="least",
        unit="",
        resolution=0.01,
        heading="U",
        format=".4g",
        narrow=True,
    ),
    Criterion(
        name="Q_force",
        meaning="acceleration that it withstands",
        figures=("Q_force",),
        better="most",
        unit="m/s^2",
        resolution=0.01,
        scored=True,
        heading="Q",
        format=".2f",
        narrow=True,
    ),
    Criterion(
        name="Q_torque",
        meaning="acceleration about the centre of mass that it withstands, at 50 mm",
        figures=("Q_torque",),
        better="most",
        unit="m/s^2",
        resolution=0.01,
        heading="Q turn",
        format=".2f",
    ),
    Criterion(
        name="clearance",
        meaning="least distance from walls, obstacles, itself, and of all but the pads from the object",
        figures=("enclosure clearance", "obstacle clearance", "self clearance", "object clearance"),
        better="most",
        unit="m",
        resolution=1e-4,
        scored=True,
        heading="clear",
        narrow=True,
    ),
    Criterion(
        name="reserve",
        meaning="least distance of an arm joint from its limits",
        figures=("joint reserve",),
        better="most",
        unit="rad",
        resolution=1e-3,
        scored=True,
        heading="reserve",
        narrow=True,
    ),
    Criterion(
        name="manipulability",
        meaning="how far the arm is from singular postures",
        figures=("manipulability",),
        better="most",
        unit="m^3",
        resolution=1e-4,
        scored=True,
        heading="manip.",
        format=".3f",
    ),
)
"""A further criterion is a further entry; the help of the command line names it, too, as a test sees to."""

BY_NAME = {criterion.name: criterion for criterion in CRITERIA}
ALIASES = {"Q": "Q_force"}


def criterion_of(name: str, grasps: Iterable[Grasp], further: tuple[str, ...] = (), key: str = "by") -> Criterion:
    """Return a criterion by its name, by its alias, or by the name of a figure of one of the grasps.

    Args:
        name: as above.
        grasps: whose figures count.
        further: names that the caller knows besides, for the remedy.
        key: argument that errors name.

    Raises:
        UnknownNameError: there is none of this name.
        InputError: it is no name.
    """
    if not isinstance(name, str):
        raise InputError(f"the name of a criterion is wanted, not {name!r}", key=key)
    known = BY_NAME.get(ALIASES.get(name, name))
    if known:
        return known
    figures = {figure.name: figure for grasp in grasps for figure in grasp.certificate.figures}
    if name not in figures:
        names = [*further, *BY_NAME, *figures]
        problem = f"no criterion and no figure is called {name!r}"
        raise UnknownNameError(problem, key=key, remedy=close_names(name, names))
    figure = figures[name]
    better: Literal["least", "most"] = "most" if figure.sense == "at least" else "least"
    return Criterion(
        name=name, meaning="figure", figures=(name,), better=better, unit=figure.unit, heading=name, format=".3g"
    )
