"""Outcome of a hold test."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..frozen import Record


@dataclass(frozen=True, eq=False, repr=False)
class PadForce(Record):
    """Normal force of a pad on the object at rest, N."""

    pad: str
    """Name of the pad."""
    planned: float
    """Of the contact force of the grasp, N."""
    measured: float
    """In the simulation, N."""


@dataclass(frozen=True, eq=False, repr=False)
class FirstSlip(Record):
    """The least acceleration of the base, over its directions, at which the object leaves its place in the hand."""

    acceleration: float
    """m/s^2; `HoldOptions.strongest` if it never did."""
    direction: str
    """Of the acceleration of the base: +x, -x, +y, -y, +z or -z of the world."""
    slipped: bool
    """Whether it did."""
    touching: tuple[str, ...]
    """Links that touched the object other than with a pad before it slipped, in any direction."""


@dataclass(frozen=True, eq=False, repr=False)
class HoldOutcome(Record):
    """One grasp in the simulation."""

    grasp: int
    """Number of the grasp, from 1, in what was given."""
    start: int | None
    """Its `Grasp.start`."""
    held: bool
    """Whether the object was in place at the end of every phase."""
    failed: tuple[str, ...]
    """Phases at whose end it was not: settle, gravity, shake +x, ..., spin -z; nothing follows a failure of the first
    two, and every shake or spin that fails is followed by a fresh start."""
    distance: float
    """Largest displacement of the object at the end of a phase after it had settled, against the hand, m."""
    angle: float
    """Largest rotation, alike, rad."""
    sag: float
    """Displacement of the object from its planned pose when it had settled, m."""
    standoff: float
    """How far the convex pieces that stand for a mesh, or a cone, are off the surface where pads touch it, m; 0 for
    other shapes. What is measured with more than some tenths of a millimetre is another object's."""
    pads: tuple[PadForce, ...]
    """Pads at rest; all measured forces are 0 if the object was lost before."""
    touching: tuple[str, ...]
    """Links that touched the object other than with a pad while it was held."""
    first_slip: FirstSlip | None
    """None if it was not asked for, or if the grasp does not hold at rest."""
    predicted: float | None
    """The resistance `Q_force` of the certificate, m/s^2; None if it has none."""
    controls: Mapping[str, bool]
    """Whether the negative controls `no squeeze` and `no friction` held, which they must not; empty if not run."""
    seconds: float = field(compare=False)
    """Computing time, s; it does not count in comparisons."""

    @property
    def force_error(self) -> float:
        """Largest deviation of a pad's force at rest from the planned one, as a part of the planned one."""
        return max(abs(pad.measured / pad.planned - 1.0) for pad in self.pads)
