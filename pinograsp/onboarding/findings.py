"""Findings of the check of a robot file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..frozen import Record

Level = Literal["ok", "doubtful", "wrong"]


@dataclass(frozen=True, eq=False, repr=False)
class Finding(Record):
    """One thing that was looked at."""

    level: Level
    """wrong: no grasp can come of it; doubtful: most likely not meant so."""
    what: str
    """The finding in words, with numbers and their units."""
    remedy: str = ""
    """Words on how to mend it; empty where nothing is to be done."""


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
