"""Force cost: k psi(V*), how well the best contact forces keep friction and force limits (10).

psi(V) = V up to the value that proves every friction and force limit (strict_cost), and grows like log V
beyond it, so that the enormous V of a hopeless geometry does not drown everything else; no grasp that keeps
the inequality on V* sees the difference.
"""

from __future__ import annotations

import math

from ...arrays import Array
from ..cost import Cost
from ..state import State
from ..task_model import TaskModel


class ForceCost(Cost):
    """k psi(V*), dimensionless."""

    name = "force cost"

    def __init__(self, model: TaskModel) -> None:
        self._weight, self._strict = model.task.force_weight, model.limits.strict_cost

    def value(self, state: State) -> tuple[float, Array]:
        psi, slope = saturated(state.forces.V, self._strict)
        return self._weight * psi, self._weight * slope * state.force_gradient


def saturated(V: float, strict: float) -> tuple[float, float]:
    """Return psi(V) and its slope."""
    return (V, 1.0) if strict >= V else (strict * (1.0 + math.log(V / strict)), strict / V)
