"""Findings of the check of a robot file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from ..arrays import Array
from ..frozen import Record

Level = Literal["ok", "doubtful", "wrong"]
LEVELS: tuple[Level, ...] = ("wrong", "doubtful", "ok")
"""What is worse comes first."""


@dataclass(frozen=True, eq=False, repr=False)
class Finding(Record):
    """One thing that was looked at."""

    level: Level
    """wrong: no grasp can come of it; doubtful: most likely not meant so."""
    what: str
    """The finding in words, with numbers and their units."""
    remedy: str = ""
    """Words on how to mend it; empty where nothing is to be done."""


def in_order(findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """Return findings, the worst first, those of one level with the same advice one after the other."""
    groups: dict[tuple[Level, str], list[Finding]] = {}
    for finding in sorted(findings, key=lambda finding: LEVELS.index(finding.level)):
        groups.setdefault((finding.level, finding.remedy), []).append(finding)
    return tuple(finding for group in groups.values() for finding in group)


@dataclass(frozen=True, eq=False, repr=False)
class LinkFigures(Record):
    """How the collision geometry of one link looks to the planner."""

    link: str
    """Name of the link."""
    triangles: int
    """Number of triangles of its meshes."""
    closed: bool
    """Whether every edge belongs to two triangles."""
    pieces: int
    """Convex pieces and primitives that stand for it."""
    excess: float
    """95 % of the pieces' outer boundary are nearer to the meshes than this, m; 0 for primitives."""
    most: float
    """The farthest of it, m."""


@dataclass(frozen=True, eq=False, repr=False)
class Face(Record):
    """A flat face of a link of the hand, as the largest rectangle in it; link frame."""

    link: str
    """Name of the link."""
    origin: Array
    """Middle, m, shape (3,)."""
    axes: Array
    """Unit vectors x and y along the sides, and the outward normal, as columns, shape (3, 3)."""
    sides: Array
    """Along x and y, m, shape (2,)."""
    pad: str
    """It as a pad of a robot file, less 1 mm at each edge: YAML."""
