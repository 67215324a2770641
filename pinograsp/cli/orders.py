"""Orders of grasps that the user asks for."""

from __future__ import annotations

import math

import pinograsp

ORDERS = "score, U, Q_force, Q_torque, clearance, reserve, manipulability"
"""For the help, which does not wait for the library that knows them."""


def require_order(name: str) -> None:
    """Refuse what grasps cannot be ordered by, before there are any.

    Raises:
        UnknownNameError: there is no such criterion.
    """
    from ..results.criteria import criterion_of
    from ..results.ranking import SCORE

    if name != SCORE:
        criterion_of(name, (), further=(SCORE,))


def is_measured(by: str, result: pinograsp.Result) -> bool:
    """Return whether any grasp has what they are to be ordered by."""
    from ..results.criteria import criterion_of, numbers_of
    from ..results.ranking import SCORE

    if by == SCORE:
        return True
    values = criterion_of(by, result.grasps).values([numbers_of(grasp) for grasp in result.grasps])
    return not all(map(math.isnan, values))
