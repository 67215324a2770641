"""How a start is solved: a solver, its budget and its tolerances."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, get_args

from ..errors import UnknownNameError, close_names, real_number, whole_number
from ..solver_words import Projection
from .backends import backend_of


@dataclass(frozen=True)
class SolverOptions:
    """How each start is solved.

    Raises:
        InputError: a number is out of range, or there is no such backend or projection.
    """

    algorithm: str = "LD_SLSQP"
    """Name of a backend."""
    max_evaluations: int | None = None
    """Budget of evaluations a solve; None: 200 for LD_SLSQP, 3000 for LN_COBYLA."""
    tries: int = 3
    """Solves of a start at most: where the first one fails, another projection leads elsewhere."""
    tolerance: float = 1e-4
    """Scaled violation that counts as feasible, no unit: 1e-4 is a micrometre."""
    cost_tolerance: float = 1e-6
    """Change of the scaled cost at which a solve stops, 0.001 mm^2 in U; also ten times this part of the cost."""
    projection: Projection = "contacts and clearance"
    """Conditions that a start is projected on before the solve."""

    def __post_init__(self) -> None:
        """Refuse numbers that make no sense, and names that nothing has."""
        backend_of(self.algorithm)
        if self.max_evaluations is not None:
            whole_number("max_evaluations", self.max_evaluations, 1, 2**31 - 1)  # NLopt counts no further
        whole_number("tries", self.tries, 1)
        for name in ("tolerance", "cost_tolerance"):
            real_number(name, getattr(self, name), 0.0)
        if self.projection not in (known := get_args(Projection)):
            remedy = close_names(self.projection, known)
            raise UnknownNameError(f"no projection {self.projection!r}", key="projection", remedy=remedy)

    @property
    def budget(self) -> int:
        """Evaluations a start."""
        return self.max_evaluations or backend_of(self.algorithm).budget

    def to_json(self) -> dict[str, Any]:
        """Return the options as JSON data, the budget resolved."""
        return {**asdict(self), "max_evaluations": self.budget}
