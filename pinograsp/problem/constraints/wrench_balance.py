"""Wrench balance: contact forces that balance the external wrench exist.

For two hard fingers the part that no force balances is the torque about the line that joins them: it is then, relative
to the wrench, the distance of the centre of mass from the plane through that line along the force, in parts of the
object's radius.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ...mechanics import residual_gradient
from ..constraint import PER_METRE, Constraint, Kind, Residual, Violation
from ..state import State
from ..task_model import TaskModel

UNBALANCED = 5e-4
"""Unbalanced part of the wrench that is let pass."""


class WrenchBalance(Constraint):
    """The part of the wrench that no contact force balances is at most `UNBALANCED`."""

    name = "wrench balance"
    kind: Kind = "inequality"
    figures: Mapping[str, str] = {"force balance": "N", "torque balance": "N mm"}
    rows = ("wrench balance",)

    def __init__(self, model: TaskModel) -> None:
        self._models, self._rho = model.contact_models, model.load.rho
        self._wrench = float(np.linalg.norm(model.load.scaled)) or 1.0

    def unbalanced(self, state: State) -> Residual:
        """Return |w + G f| / |w| with torques divided by rho, shape (1,); zero if there is no wrench."""
        gradient = residual_gradient(state.statics, state.grasp_derivatives, self._models)
        return Residual(
            np.array([np.linalg.norm(state.statics.residual) / self._wrench]), gradient[None] / self._wrench
        )

    def residual(self, state: State) -> Residual:
        unbalanced = self.unbalanced(state)
        # Rounded at zero, where the norm has a kink.
        norm, rounding, scale = float(unbalanced.values[0]), 0.25 * UNBALANCED, PER_METRE * self._rho
        smooth = math.hypot(norm, rounding)
        return Residual(np.array([scale * (smooth - UNBALANCED)]), scale * norm / smooth * unbalanced.jacobian)

    def violations(self, state: State) -> list[Violation]:
        rest = state.statics.residual
        excess = max(0.0, float(np.linalg.norm(rest)) - UNBALANCED * self._wrench)
        size = 1e3 * self._rho * excess / self._wrench
        if np.linalg.norm(rest[:3]) > np.linalg.norm(rest[3:]):
            return [Violation("force balance", excess, "N", "", size)]
        return [Violation("torque balance", 1e3 * self._rho * excess, "N mm", "", size)]


def wrench_balance(model: TaskModel) -> WrenchBalance | None:
    """Return the constraint, unless the task switches it off."""
    return WrenchBalance(model) if model.task.balance_wrench else None
