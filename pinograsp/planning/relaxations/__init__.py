"""Changes of a scene that may make a task work: one file for each kind, registered in `RELAXATIONS`.

A kind has variants (directions, margins), and each variant a size, which grows from nothing. `remedies` looks for the
least size at which the task works.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from .jaws import jaws
from .margins import margins
from .moves import object_moves, obstacle_moves
from .regions import regions
from .variant import Failure, Variant
from .weights import weights

RELAXATIONS: tuple[tuple[Callable[[Failure], Iterator[Variant]], frozenset[str]], ...] = (
    (weights, frozenset({"friction", "force limit", "normal force", "force balance", "torque balance", "withstand"})),
    (weights, frozenset({"tasks.wrench", "objects.mass"})),
    (regions, frozenset({"contact region", "surface edge", "pad rim", "tasks.allowed_contacts"})),
    (regions, frozenset({"tasks.forbidden_contacts"})),
    (jaws, frozenset({"objects.shape", "contact gap", "pad tangency", "pad clearance", "object clearance"})),
    (obstacle_moves, frozenset({"obstacle clearance", "objects.pose"})),
    (margins, frozenset({"enclosure clearance", "obstacle clearance", "self clearance", "object clearance"})),
    (margins, frozenset({"pad clearance", "objects.pose"})),
)
"""Kinds of changes, each with the constraints that it loosens, or the keys of refusals that it answers.

Moves of the object are tried for all of them."""


def suitable(failure: Failure) -> list[list[Variant]]:
    """Return the variants of every kind of change that may help, the most promising kind first."""
    makers = [maker for kind in failure.kinds for maker, loosens in RELAXATIONS if kind in loosens]
    return [list(maker(failure)) for maker in dict.fromkeys([*makers, object_moves])]
