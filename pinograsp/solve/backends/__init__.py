"""Solvers behind one interface: a backend is one file, and one line here."""

from ...errors import UnknownNameError, close_names
from .backend import Backend, BudgetSpentError, Limits, Program, Reason, Stop
from .nlopt import NLopt

__all__ = ["BACKENDS", "Backend", "BudgetSpentError", "Limits", "Program", "Reason", "Stop", "backend_of"]

BACKENDS: dict[str, Backend] = {
    "LD_SLSQP": NLopt("LD_SLSQP", budget=200),
    "LN_COBYLA": NLopt("LN_COBYLA", budget=3000),
}
"""Backends by the name that `SolverOptions.algorithm` gives. Further ones may be added before options name them."""


def backend_of(name: str) -> Backend:
    """Return the backend of a name.

    Raises:
        UnknownNameError: there is none of this name.
    """
    if not isinstance(name, str) or name not in BACKENDS:
        raise UnknownNameError(f"no solver {name!r}", key="algorithm", remedy=close_names(name, BACKENDS))
    return BACKENDS[name]
