"""Why a search found no grasp, and what would help: causes, the nearest miss, remedies."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

from ..descriptions import Scene
from ..errors import InputError
from ..frozen import Record
from ..json_types import Null, Whole
from .grasp import Grasp
from .setup import Setup


@dataclass(frozen=True, eq=False, repr=False)
class Cause(Record):
    """The starts without a grasp that one kind of constraint kept from it at one body."""

    kind: str
    """Of the constraint that was violated most, as in `Result.blocked`."""
    starts: Annotated[int, Whole(1)]
    """Number of them."""
    share: float
    """Share of the starts that were solved, from 0 to 1."""
    nearest_miss: Annotated[float, Null(math.inf)]
    """Least violation among them, in `unit`."""
    unit: str
    """SI, angles in radians; empty for a pure number."""
    where: str
    """Bodies, pad or figure of the nearest miss: of a clearance the link and what it is too near to."""
    body: str
    """Body that the link is too near to: wall, obstacle, object or link; empty for what is no clearance."""


@dataclass(frozen=True, eq=False, repr=False)
class Remedy(Record):
    """A change of the scene, or a number of starts, that makes the task work, tried by planning again.

    It is no larger than it has to be, as far as the time allowed to find out.
    """

    kind: str
    """Kind of the change: "move object", "move obstacle", "margin", "weight", "jaw", "region"; "starts": of none, the
    task works with other starts, and `amount` says how many are enough."""
    text: str
    """In words, with figures and units."""
    amount: float
    """By how much, or for the weight to how much, in `unit`; rounded so that it is enough."""
    unit: str
    """SI; empty for a number of starts."""
    changes: Mapping[str, Any]
    """New values by their place in the scene, a JSON array of keys, such as '["tasks", "can", "margin"]'. Those of a
    "jaw" make the object narrower by as much as the jaw would have to open wider, or wider by as much as it would have
    to close further: a hand is not the scene's to change.
    """
    verified: int
    """Starts of the changed scene that ended in a verified grasp, with another seed."""
    tried: int
    """Starts of the changed scene that were solved then."""

    def apply(self, scene: Scene) -> Scene:
        """Return a scene with the change.

        Args:
            scene: the one that was explained.

        Raises:
            InputError: it has no such object, obstacle or task.
        """
        data = scene.to_dict()
        for path, value in self.changes.items():
            *above, last = json.loads(path)
            place = data
            for key in above:
                if key not in place:
                    raise InputError("this key is missing", key=".".join((*above, last)), file=scene.source)
                place = place[key]
            place[last] = value
        return Scene.from_dict(data)


@dataclass(frozen=True, eq=False, repr=False)
class Tried(Record):
    """A change of the scene that was tried, and of which no size makes the task work for certain."""

    kind: str
    """Kind of the change, as of a `Remedy`."""
    text: str
    """The change in words, with figures and units: how far it was tried."""
    furthest: float
    """Size up to which it was tried, in `unit`; of a load, how many parts of what is left are taken away."""
    unit: str
    """SI."""
    whole: bool
    """Whether it was tried as far as it was to be; False: the time was over."""
    unsure: bool
    """Whether a start of a short plan was verified, but too few of the plan that would have made it sure."""

    @property
    def ending(self) -> str:
        """The outcome in words."""
        found = "too few starts verified" if self.unsure else "no grasp"
        if self.whole:
            return found
        known = self.furthest > 0.0 or self.unsure
        return f"{found} when the time was over" if known else "the time was over before it was known"


@dataclass(frozen=True, eq=False, repr=False)
class Explanation(Record):
    """Why a task found no grasp, and the least changes that make it work."""

    refusal: str = ""
    """Why the task was refused before any start was solved; empty if it was not."""
    causes: tuple[Cause, ...] = ()
    """Of the starts without a grasp, the most frequent first."""
    nearest_miss: Grasp | None = None
    """The posture that came nearest to a grasp, not verified: its certificate says what is lacking. `visualization`
    draws it like a grasp, what offends in red."""
    remedies: tuple[Remedy, ...] = ()
    """Changes that were found to help, in the order in which they were; `explain` finds them."""
    tried: tuple[Tried, ...] = ()
    """Changes that were tried, and found not to help; `explain` tries them."""
    warnings: tuple[str, ...] = ()
    """Sentences about what is odd about the task."""
    done: int = 0
    """Starts that were solved."""
    verified: int = 0
    """Those of them that ended in a verified grasp: the task works if there are some."""
    interrupted: bool = False
    """Whether Ctrl-C or the deadline ended the search for remedies."""
    seconds: Annotated[float, Null(math.nan)] = field(default=0.0, compare=False)
    """It took, s."""

    def placed(self, setup: Setup) -> Explanation:
        """Return the explanation with a nearest miss that knows robot, scene and task."""
        missed = self.nearest_miss
        return self if missed is None else replace(self, nearest_miss=replace(missed, setup=setup))

    def __repr__(self) -> str:
        if self.refusal:
            return f"<Explanation: refused, {self.refusal}; {len(self.remedies)} remedies>"
        causes = ", ".join(f"{cause.kind} {100.0 * cause.share:.0f} %" for cause in self.causes[:3])
        return f"<Explanation: {self.verified} of {self.done} starts verified; {causes}; {len(self.remedies)} remedies>"
