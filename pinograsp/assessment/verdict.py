"""Whether a grasp holds with one set of errors, and why not."""

from __future__ import annotations

from dataclasses import dataclass

from ..frozen import Record

LOST = "no contact"
OFF_PAD = "contact off the pad"
TOUCHES = "another link touches the object"
PENETRATES = "a pad's link enters the object"
COLLIDES = "the robot touches walls, obstacles or itself"
SLIPS = "the object slips"
CAUSES = (LOST, OFF_PAD, PENETRATES, TOUCHES, COLLIDES, SLIPS)
"""Why a grasp may fail, in the order in which the causes are looked for: the first one counts."""


@dataclass(frozen=True, eq=False, repr=False)
class Verdict(Record):
    """Judgement of a grasp with one set of errors."""

    also_in_json = ("holds",)

    cause: str | None
    """One of `CAUSES`; None if it holds."""
    where: str
    """Pad or pair of bodies that the cause is about."""
    margin: float
    """Least reserve of the inequalities of the balance, N; negative if the object slips, -inf without contact."""
    off_region: bool
    """Whether a footprint leaves the part of the surface where contact is allowed."""

    @property
    def holds(self) -> bool:
        """Whether the grasp holds."""
        return self.cause is None

    @property
    def reason(self) -> str:
        """The cause and what it is about, empty if the grasp holds."""
        return ": ".join(part for part in (self.cause, self.where) if part)
