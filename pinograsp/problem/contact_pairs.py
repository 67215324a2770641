"""Pairs of opposite points of an object, and what is known of hands that hold them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from ..arrays import Array
from ..frozen import Record
from ..mechanics import Contacts
from .desired import DesiredPoints, Hold, Proposal
from .pair_holds import Holds
from .task_model import TaskModel


@dataclass(frozen=True, eq=False, repr=False)
class ContactPair(Record):
    """Two opposite points of an object that two pads can touch."""

    points: Array
    """On the object's surface, in its frame, m, shape (2, 3); a task's `desired_contacts` may be these."""
    normals: Array
    """Outward normals there, unit vectors, object's frame, shape (2, 3)."""
    width: float
    """How far apart the pads are that hold it, m."""


class ContactPairs(tuple[ContactPair, ...]):
    """Pairs of an object, as a tuple; what is to be known of where there is none, in words.

    Args:
        pairs: in their order.
        remarks: which parts of the surface have no pair, and why.
        warnings: what a plan would warn of.
    """

    remarks: tuple[str, ...]
    """Which parts of the surface have no pair, and which limit that is."""
    warnings: tuple[str, ...]
    """Oddities of the task, and what was guessed and mended in mesh files, as a plan warns of it."""

    def __new__(
        cls, pairs: Iterable[ContactPair], remarks: tuple[str, ...] = (), warnings: tuple[str, ...] = ()
    ) -> Self:
        """Make it as a tuple is."""
        made = super().__new__(cls, pairs)
        made.remarks, made.warnings = remarks, warnings
        return made


class Held(NamedTuple):
    """A hand that holds a pair, object's frame."""

    hold: Hold
    contacts: Contacts


class Candidate(NamedTuple):
    """A pair that fits the hand."""

    pair: ContactPair
    holds: Holds
    roomy: bool
    """Whether it is far from edges, and may be in the middle of a pad."""
    held: tuple[Hold, ...] = ()
    """Hands that hold it, object's frame; none if it was not tried."""


def proposal(candidate: Candidate, model: TaskModel) -> Proposal:
    """Return what is proposed to a start, where the object of a task stands."""
    T = model.T_world_object
    placed = [
        hold._replace(T_wrist=T @ hold.T_wrist, axis=hold.axis @ T[:3, :3].T + [T[:3, 3], np.zeros(3)])
        for hold in candidate.held
    ]
    return Proposal(desired_points(candidate.pair, model), tuple(placed))


def desired_points(pair: ContactPair, model: TaskModel) -> DesiredPoints:
    """Return the points of a pair, and that pads are to look at them, where the object of a task stands."""
    R, origin = model.T_world_object[:3, :3], model.T_world_object[:3, 3]
    return DesiredPoints(pair.points @ R.T + origin, pair.normals @ R.T)
