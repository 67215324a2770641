"""The result of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from .different import Different, different
from .grasp import Grasp
from .ranking import FRONT, SCORE, ordered_by, pareto_front
from .setup import Setup

WITHSTAND = "withstand"
"""Kind of what blocks a start whose grasp withstands less than the task asks for."""


@dataclass(frozen=True)
class Blocked:
    """The starts whose most violated constraint was of one kind."""

    starts: int
    nearest_miss: float
    """Least violation among them, in `unit`."""
    unit: str
    where: str
    """Bodies, pad or figure of the nearest miss."""


@dataclass(frozen=True)
class Result:
    """Outcome of a run: verified grasps, the best first, and what became of every start."""

    setup: Setup = field(repr=False)
    """Robot, scene and task; each of the grasps gets this object too."""
    grasps: tuple[Grasp, ...]
    """In the default order (`results/ranking.py`)."""
    starts: int
    """Starts asked for."""
    counts: dict[str, int]
    """Starts per outcome of the solver: converged, feasible, infeasible, budget spent, failed."""
    verified: int
    """Starts that ended in a grasp which the independent check verified."""
    refuted: int
    """Starts whose grasp the solver called feasible and the independent check refuted."""
    blocked: dict[str, Blocked]
    """Reasons why the other starts are not verified, by kind of constraint."""
    interrupted: bool = False
    times: dict[str, float] = field(default_factory=dict)
    """Time of each stage, s; `solver_mean` is the mean of one start on one core."""
    provenance: dict[str, Any] = field(default_factory=dict)
    """Package versions, hashes of the input files, seed and options."""
    warnings: tuple[str, ...] = ()
    """Oddities of the task, in words."""
    altered: bool = False
    """Whether it was read from a file that somebody changed: the content is not that of the file's digest."""

    def __post_init__(self) -> None:
        """Tell every grasp where it belongs."""
        grasps = tuple(g if g.setup is self.setup else replace(g, setup=self.setup) for g in self.grasps)
        object.__setattr__(self, "grasps", grasps)

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

    def ranked(self, by: str = SCORE) -> tuple[Grasp, ...]:
        """Return the grasps, the best first.

        Args:
            by: "score", the default order: U where it differs by more than 1 % + 1 mm^2, and a score of Q_force,
                clearance, reserve and manipulability where it does not. Or one criterion alone, equal values in the
                default order: "U", "Q_force" (or "Q"), "Q_torque", "clearance", "reserve", "manipulability", or the
                name of any figure of the certificates. Grasps without that figure come last.

        Raises:
            InputError: there is no such criterion or figure.
        """
        return ordered_by(self.grasps, by)

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

    def different(self, most: int = 10, by: str = SCORE) -> tuple[Different, ...]:
        """Return the best grasps that differ in hand pose or arm posture, with how many stand behind each.

        Two grasps differ if their wrists are more than 20 mm or 15 degrees apart, or an arm joint more than 30 degrees.

        Args:
            most: number of grasps at most.
            by: the order in which they are chosen, as for `ranked`.

        Raises:
            InputError: there is no such criterion or figure.
        """
        return different(self.ranked(by), most)
