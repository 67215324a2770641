"""Outcome of an assessment."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..frozen import FrozenMapping, Record
from .errors import Draw, Errors
from .verdict import CAUSES, Verdict

CONFIDENCE = 1.959963984540054
"""Standard deviations of a normal distribution that hold 95 % of it."""


@dataclass(frozen=True, eq=False, repr=False)
class Sample(Record):
    """One set of errors, and the judgement of the grasp with them."""

    number: int
    """From 1, in the order in which they are drawn."""
    errors: Draw
    """The errors; world frame."""
    verdict: Verdict
    """Whether the grasp holds, and why not."""


@dataclass(frozen=True, eq=False, repr=False)
class Margin(Record):
    """How large one kind of error may be, alone."""

    kind: str
    """Of error: position, orientation, joint, center of mass, friction or weight."""
    size: float
    """In `unit`; the least coefficient of friction, otherwise the largest size."""
    unit: str
    """m, rad, or empty for friction and weight, which have none."""
    where: str
    """Direction or joint in which it ends; empty if there is none."""
    cause: str
    """Why the grasp fails beyond; empty if it was not seen to."""
    capped: bool
    """Whether it holds at the largest size that is looked at (friction: without any)."""


@dataclass(frozen=True, eq=False, repr=False)
class Assessment(Record):
    """How much a grasp puts up with."""

    also_in_json = ("done", "holding", "share", "interval", "causes", "off_region", "worst")

    errors: Errors
    """Sizes of the errors that were drawn, friction included."""
    asked: int
    """Number of samples asked for."""
    seed: int
    """Of the random numbers."""
    samples: tuple[Sample, ...]
    """Those that were judged, in order."""
    margins: tuple[Margin, ...]
    """How large each kind of error may be, alone; none if the grasp fails without errors."""
    without_errors: Verdict
    """Of the grasp as it was planned."""
    interrupted: bool = False
    """Whether Ctrl-C ended it."""

    @property
    def done(self) -> int:
        """Number of samples judged."""
        return len(self.samples)

    @property
    def holding(self) -> int:
        """Number of samples that hold."""
        return sum(sample.verdict.holds for sample in self.samples)

    @property
    def share(self) -> float:
        """Share of the samples that holds; not a number if there are none."""
        return self.holding / self.done if self.samples else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of the share (Wilson's score interval); (0, 1) if there are no samples."""
        return wilson(self.holding, self.done)

    @property
    def causes(self) -> dict[str, int]:
        """Number of failures by cause, causes without any left out."""
        found = [sample.verdict.cause for sample in self.samples]
        return {cause: found.count(cause) for cause in CAUSES if cause in found}

    @property
    def off_region(self) -> int:
        """Samples in which a footprint leaves the part of the surface where contact is allowed; they may hold."""
        return sum(sample.verdict.off_region for sample in self.samples)

    @property
    def worst(self) -> Sample | None:
        """The sample with the least margin of balance, the first of several; None if there are no samples."""
        return min(self.samples, key=lambda sample: sample.verdict.margin, default=None)

    def margin(self, kind: str) -> Margin:
        """Return the margin of a kind of error.

        Raises:
            UnknownNameError: (a `KeyError`) there is none of this kind; close ones are named.
        """
        margin: Margin = FrozenMapping({margin.kind: margin for margin in self.margins})[kind]
        return margin


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """Return Wilson's score interval of a share, 95 %; (0, 1) without trials."""
    if not trials:
        return 0.0, 1.0
    share, z2 = successes / trials, CONFIDENCE**2
    middle = (share + z2 / (2 * trials)) / (1.0 + z2 / trials)
    half = CONFIDENCE / (1.0 + z2 / trials) * math.sqrt(share * (1.0 - share) / trials + z2 / (4 * trials**2))
    return max(0.0, middle - half) if successes else 0.0, min(1.0, middle + half) if successes < trials else 1.0
