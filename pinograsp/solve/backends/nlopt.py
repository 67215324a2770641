"""NLopt's algorithms as backends.

NLopt raises RoundoffLimited and loses the point, ends with a success code on NaN, and may report success with violated
constraints; so its result is not looked at, only why it stopped. The library is imported when something is solved: to
know the names of the backends it is not needed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import Array
from .backend import BudgetSpentError, Limits, Program, Reason, Stop

VARIABLE_CHANGE = 1e-10
"""Relative change of the variables at which a solve stops."""
INNER_COST_CHANGE = 1e-6
"""Relative change of the cost at which a solve inside another stops."""
INNER_SHARE = 4
"""A solve inside another gets the budget divided by this."""
_REASONS: dict[str, Reason] = {
    "SUCCESS": "converged",
    "FTOL_REACHED": "converged",
    "XTOL_REACHED": "converged",
    "STOPVAL_REACHED": "converged",
    "MAXEVAL_REACHED": "budget spent",
    "MAXTIME_REACHED": "budget spent",
    "ROUNDOFF_LIMITED": "roundoff",
}
"""By NLopt's names of its results."""


@dataclass(frozen=True)
class NLopt:
    """One of NLopt's algorithms."""

    algorithm: str
    """NLopt's name of it, such as LD_SLSQP; the D says that it uses gradients."""
    budget: int
    inner: NLopt | None = None
    """Solves the subproblems of an augmented Lagrangian."""
    parameters: tuple[tuple[str, float], ...] = ()
    """NLopt's own parameters of the algorithm."""

    def solve(self, program: Program, limits: Limits) -> Stop:
        optimizer = self._optimizer(program)
        if self.inner:
            inner = self.inner._optimizer(program)
            inner.set_ftol_rel(INNER_COST_CHANGE)
            inner.set_maxeval(limits.evaluations // INNER_SHARE)
            optimizer.set_local_optimizer(inner)
        optimizer.set_lower_bounds(program.lower)
        optimizer.set_upper_bounds(program.upper)
        optimizer.set_maxeval(limits.evaluations)
        optimizer.set_maxtime(limits.seconds)
        optimizer.set_ftol_abs(limits.cost_change)
        optimizer.set_ftol_rel(limits.relative_cost_change)
        optimizer.set_xtol_rel(VARIABLE_CHANGE)
        optimizer.set_min_objective(_cost(program))
        equal, unequal = (np.full(n, limits.violation) for n in (program.equality_count, program.inequality_count))
        if program.equality_count:
            optimizer.add_equality_mconstraint(_constraints(program.equalities), equal)
        optimizer.add_inequality_mconstraint(_constraints(program.inequalities), unequal)
        return _run(optimizer, program.start)

    def _optimizer(self, program: Program) -> Any:
        import nlopt

        optimizer = nlopt.opt(getattr(nlopt, self.algorithm), len(program.start))
        for name, value in self.parameters:
            optimizer.set_param(name, value)
        return optimizer


def _run(optimizer: Any, start: Array) -> Stop:
    import nlopt

    reasons = {getattr(nlopt, name): reason for name, reason in _REASONS.items()}
    try:
        optimizer.optimize(start)
    except BudgetSpentError:
        return Stop("budget spent")
    except nlopt.RoundoffLimited:
        return Stop("roundoff", "roundoff limits progress")
    except (nlopt.exception, RuntimeError, ValueError, np.linalg.LinAlgError) as error:
        return Stop("failed", str(error) or type(error).__name__)
    return Stop(reasons.get(optimizer.last_optimize_result(), "failed"))


def _cost(program: Program) -> Callable[[Array, Array], float]:
    def cost(z: Array, gradient: Array) -> float:
        value, slope = program.cost(z)
        if gradient.size:
            gradient[:] = slope
        return value

    return cost


def _constraints(of: Callable[[Array], tuple[Array, Array]]) -> Callable[[Array, Array, Array], None]:
    def constraints(result: Array, z: Array, gradient: Array) -> None:
        values, jacobian = of(z)
        result[:] = values
        if gradient.size:
            gradient[:] = jacobian

    return constraints
