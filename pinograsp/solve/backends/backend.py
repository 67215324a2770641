"""The interface of a solver: the program it is given, when it may stop, and why it did.

    minimise   cost(z)
    subject to lower <= z <= upper,  equalities(z) = 0,  inequalities(z) <= 0

Whoever gives the program records every point at which its functions are called and judges them; so a backend returns no
point, and nothing of what it tried is lost.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

from ...arrays import Array

Reason = Literal["converged", "budget spent", "roundoff", "failed"]
"""Why a solve stopped: by itself, at a limit, where rounding allows no progress, or by an error."""


class BudgetSpentError(Exception):
    """No further point is evaluated. The functions of a program may raise it; a backend stops then."""


@dataclass(frozen=True)
class Program:
    """A nonlinear program in scaled variables z, shape (v,)."""

    start: Array
    """Within the bounds."""
    lower: Array
    upper: Array
    cost: Callable[[Array], tuple[float, Array]]
    """Value, and gradient of shape (v,)."""
    equalities: Callable[[Array], tuple[Array, Array]]
    """Values, shape (equality_count,), and Jacobian, shape (equality_count, v)."""
    inequalities: Callable[[Array], tuple[Array, Array]]
    """Values, shape (inequality_count,), and Jacobian, shape (inequality_count, v)."""
    equality_count: int
    inequality_count: int


@dataclass(frozen=True)
class Limits:
    """When a solve may stop."""

    evaluations: int
    """Of the cost."""
    violation: float
    """Of a constraint that counts as kept."""
    cost_change: float
    """Change of the cost in a step."""
    relative_cost_change: float = 0.0
    """In parts of the cost; 0: no limit."""
    seconds: float = 0.0
    """0: no limit."""


@dataclass(frozen=True)
class Stop:
    """The end of a solve."""

    reason: Reason
    message: str = ""
    """Of an error."""


class Backend(Protocol):
    """A solver of programs."""

    @property
    def budget(self) -> int:
        """Evaluations of a solve, unless the user wants another number."""

    def solve(self, program: Program, limits: Limits) -> Stop:
        """Run from the program's start until a limit is reached or nothing gets better."""
