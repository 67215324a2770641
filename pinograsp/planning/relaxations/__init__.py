"""Changes of a scene that may make a task work: one file for each kind, registered in `RELAXATIONS`.

A change has a size, which grows from nothing, and one or several ways (directions). `remedies` looks for the least size
at which the task works.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from .jaws import jaws
from .margins import margins
from .moves import object_moves, obstacle_moves
from .regions import regions
from .variant import Change, Failure
from .weights import weights

FORCES = frozenset({"friction", "force limit", "normal force", "force balance", "torque balance", "withstand"})
FOOTPRINTS = frozenset({"contact region", "surface edge", "pad rim"})
CLEARANCES = frozenset({"enclosure clearance", "obstacle clearance", "self clearance", "object clearance"})
FIT = frozenset({"contact gap", "pad tangency", "object clearance"})
RELAXATIONS: tuple[tuple[Callable[[Failure], Iterator[Change]], frozenset[str] | None], ...] = (
    (weights, FORCES | {"tasks.wrench", "objects.mass"}),
    (regions, FOOTPRINTS | {"tasks.allowed_contacts", "tasks.forbidden_contacts"}),
    (margins, CLEARANCES | {"pad clearance", "objects.pose"}),
    (obstacle_moves, frozenset({"obstacle clearance", "objects.pose"})),
    (object_moves, None),
    (jaws, FIT | {"pad clearance", "objects.shape"}),
)
"""Kinds of changes, each with the constraints that it loosens and the keys of refusals that it answers; None: all that
are not `ANYWHERE`.

Those come first that are known soonest not to help, wider jaws last: for each of them contacts are proposed anew.
"""
ANYWHERE = frozenset({"tasks.wrench", "objects.mass", "objects.shape", "tasks.desired_contacts"})
"""Keys of refusals that are the same wherever the object stands."""


def suitable(failure: Failure) -> list[Change]:
    """Return the changes that may help, in the order in which they are tried."""
    return [
        change
        for maker, loosens in RELAXATIONS
        if any(kind in loosens if loosens else kind not in ANYWHERE for kind in failure.kinds)
        for change in maker(failure)
    ]
