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
    """log(V* / strict) <= 0, strict = 1 / (2 kappa^2); a violation is reported as that of the largest term of V."""

    name = "contact forces"
    kind: Kind = "inequality"
    figures: Mapping[str, str] = dict.fromkeys(TERMS, "")
    rows = ("contact forces",)

    def __init__(self, model: TaskModel) -> None:
        self._pads = [pad.name for pad in model.robot.description.pads]
        self._strict = model.limits.strict_cost

    def residual(self, state: State) -> Residual:
        V = np.array([state.forces.V])
        return Residual(np.log(V / self._strict), state.force_gradient[None] / V)

    def violations(self, state: State) -> list[Violation]:
        pad, term = divmod(int(state.forces.barrier.terms.argmax()), len(TERMS))
        excess = max(0.0, math.log(state.forces.V / self._strict))
        return [Violation(TERMS[term], excess, "", self._pads[pad])]
