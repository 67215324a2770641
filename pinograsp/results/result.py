"""The result of a run."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

from ..errors import InputError
from ..frozen import Record
from ..json_types import Keys, Names, Null, Whole
from ..solver_words import Outcome
from .different import Different, different
from .explanation import Explanation
from .grasp import Grasp
from .provenance import Provenance
from .ranking import FRONT, SCORE, ordered_by, pareto_front
from .setup import Setup

WITHSTAND = "withstand"
"""Kind of what blocks a start whose grasp withstands less than the task asks for."""
Stage = Literal[
    "prepare", "database", "starts", "resistance", "total", "solver_mean", "solver_median", "verification_mean"
]
"""What a time is of."""
ALTERED = "its file was changed since it was written"
"""Said wherever a result is shown that somebody changed (`Result.altered`)."""


@dataclass(frozen=True, eq=False, repr=False)
class Blocked(Record):
    """The starts whose most violated constraint was of one kind."""

    starts: Annotated[int, Whole(1)]
    """Number of them."""
    nearest_miss: Annotated[float, Null(math.inf)]
    """Least violation among them, in `unit`."""
    unit: str
    """SI, angles in radians; empty for a pure number."""
    where: str
    """Bodies, pad or figure of the nearest miss."""


@dataclass(frozen=True, eq=False, repr=False)
class Result(Record):
    """Verified grasps of a run, the best first, and how every start ended."""

    not_in_json = ("altered",)

    setup: Setup = field(repr=False)
    """Robot, scene and task; each of the grasps gets this object too."""
    grasps: tuple[Grasp, ...]
    """In the default order, that of `ranked()`: the best first."""
    starts: int
    """Starts asked for."""
    counts: Annotated[Mapping[str, int], Names(Outcome)]
    """Starts per outcome of the solver: converged, feasible, infeasible, budget spent, failed."""
    verified: int
    """Starts that ended in a grasp which the independent check verified."""
    refuted: int
    """Starts whose grasp the solver called feasible and the independent check refuted."""
    blocked: Mapping[str, Blocked]
    """The starts that no verified grasp came of, by the kind of constraint that kept them from it."""
    interrupted: bool = False
    """Whether Ctrl-C ended the search."""
    times: Annotated[Mapping[str, Annotated[float, Null(math.nan)]], Names(Stage)] = field(
        default_factory=dict, compare=False
    )
    """Time of each stage, s; `solver_mean` is the mean of one start on one core. It does not count in comparisons."""
    provenance: Annotated[Mapping[str, Any], Keys(Provenance)] = field(default_factory=dict, repr=False)
    """Package versions, hashes of the input files, seed and options."""
    warnings: tuple[str, ...] = ()
    """Sentences about what is odd about the task, and about why there were fewer starts than asked for."""
    explanation: Explanation | None = field(default=None, repr=False)
    """Why there is no grasp: causes body by body and the nearest miss; None if there are some, or no start was solved.
    `explain` finds remedies, too."""
    altered: bool = False
    """Whether it was read from a file that somebody changed: the content is not that of the file's digest."""

    def __post_init__(self) -> None:
        """Freeze the fields, and tell every grasp where it belongs."""
        super().__post_init__()
        grasps = tuple(g if g.setup is self.setup else replace(g, setup=self.setup) for g in self.grasps)
        object.__setattr__(self, "grasps", grasps)
        if self.explanation is not None:
            object.__setattr__(self, "explanation", self.explanation.placed(self.setup))

    @property
    def robot(self) -> str:
        """Name of the robot."""
        return self.setup.robot.name

    @property
    def scene(self) -> str:
        """Name of the scene."""
        return self.setup.scene.name

    @property
    def task(self) -> str:
        """Name of the task."""
        return self.setup.task

    @property
    def best(self) -> Grasp | None:
        """The first grasp of the default order, or None."""
        return self.grasps[0] if self.grasps else None

    @property
    def done(self) -> int:
        """Number of starts that were solved."""
        return sum(self.counts.values())

    def __len__(self) -> int:
        """Return the number of grasps: a result without any is false."""
        return len(self.grasps)

    def __iter__(self) -> Iterator[Grasp]:
        """Iterate over the grasps, the best first."""
        return iter(self.grasps)

    def number_of(self, grasp: Grasp) -> int:
        """Return the number of one of the grasps, its place in `grasps`, from 1: tables and files name it by that.

        Raises:
            InputError: it is none of them.
        """
        for same in (operator.is_, operator.eq):  # the same object is found first, and fast
            for number, own in enumerate(self.grasps, 1):
                if same(own, grasp):
                    return number
        raise InputError("is no grasp of this result", key="grasp", remedy="Take one of `Result.grasps`")

    def ranked(self, by: str = SCORE, front: Sequence[str] | None = None) -> tuple[Grasp, ...]:
        """Return the grasps, the best first.

        Args:
            by: "score", the default order: U where it differs by more than 1 % + 1 mm^2, and a score of Q_force,
                clearance, reserve and manipulability where it does not. Or one criterion alone, equal values in the
                default order: "U", "Q_force" (or "Q"), "Q_torque", "clearance", "reserve", "manipulability", or the
                name of any figure of the certificates. Grasps without that figure come last.
            front: criteria of `pareto`; then only its grasps.

        Raises:
            InputError: there is no such criterion or figure.
        """
        ranked = ordered_by(self.grasps, by)
        if front is None:
            return ranked
        kept = {id(grasp) for grasp in self.pareto(front)}
        return tuple(grasp for grasp in ranked if id(grasp) in kept)

    def pareto(self, criteria: Sequence[str] = FRONT) -> tuple[Grasp, ...]:
        """Return the grasps that no other beats: none is no worse in every criterion and better in one.

        Args:
            criteria: names as for `ranked`, but for "score".

        Returns:
            In the default order. Values that are the same when rounded to the criterion's resolution are equal.

        Raises:
            InputError: there is no such criterion or figure.
        """
        return pareto_front(self.grasps, criteria)

    def different(self, most: int = 10, by: str = SCORE, front: Sequence[str] | None = None) -> tuple[Different, ...]:
        """Return the best grasps that differ in hand pose or arm posture, with how many stand behind each.

        Two grasps differ if their wrists are more than 20 mm or 15 degrees apart, or an arm joint more than 30 degrees.

        Args:
            most: number of grasps at most.
            by: the order in which they are chosen, as for `ranked`.
            front: as for `ranked`.

        Raises:
            InputError: there is no such criterion or figure.
        """
        return different(self.ranked(by, front), most)

    def __repr__(self) -> str:
        starts = f"{self.verified} of {self.done} starts verified"
        altered = f"; {ALTERED}" if self.altered else ""
        return f"<Result: {len(self.grasps)} distinct grasps, {starts}; {self.setup}{altered}>"

    def _repr_html_(self) -> str:
        from .html import result_html  # as `Grasp` does

        return result_html(self)
