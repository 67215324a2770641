"""Contact forces: V* (8) is below the value that proves every friction and force limit."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..constraint import Constraint, Kind, Residual, Violation
from ..state import State
from ..task_model import TaskModel

TERMS = ("friction", "normal force", "force limit")
"""Figures of the terms of V."""


class ContactForces(Constraint):
    """log(V* / strict) <= 0, strict = 1 / (2 kappa^2).

    A violation is reported as that of the largest term of V, in N: by how much its sigma is above -kappa if V is this
    term alone.
    """

    name = "contact forces"
    kind: Kind = "inequality"
    figures: Mapping[str, str] = dict.fromkeys(TERMS, "N")
    rows = ("contact forces",)

    def __init__(self, model: TaskModel) -> None:
        self._pads = [pad.name for pad in model.robot.description.pads]
        self._strict, self._kappa = model.limits.strict_cost, model.limits.kappa

    def residual(self, state: State) -> Residual:
        V = np.array([state.forces.V])
        return Residual(np.log(V / self._strict), state.force_gradient[None] / V)

    def violations(self, state: State) -> list[Violation]:
        pad, term = divmod(int(state.forces.barrier.terms.argmax()), len(TERMS))
        excess = max(0.0, math.log(state.forces.V / self._strict))
        # The parabola beyond -kappa, kappa^2 V = 1 / 2 + r + 3 / 2 r^2, solved for r = (sigma + kappa) / kappa.
        above = self._kappa * (math.sqrt(max(1.0, 6.0 * self._kappa**2 * state.forces.V - 2.0)) - 1.0) / 3.0
        return [Violation(TERMS[term], above, "N", self._pads[pad], size=excess)]
