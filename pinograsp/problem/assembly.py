"""The terms put together as cost, equalities and inequalities, scaled for a solver.

    cost          COST_SCALE (Phi [mm^2] + k psi(V*))
    equalities    contact gap, tangency                              = 0
    inequalities  V*, unbalanced wrench, region, clearance of links <= 0

Scaling: one millimetre is 0.1 in every constraint, and the cost is U / 1000; this decides how many starts
succeed. psi(V) = V up to the value that proves every friction and force limit (strict_cost), and grows like log V
beyond it, so that the enormous V of a hopeless geometry does not drown everything else; no grasp that keeps
the inequality on V* sees the difference.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .state import State, TaskModel
from .terms import (
    Clearance,
    Residual,
    contact_gap,
    contact_region,
    desired_contacts,
    facing,
    force_cost,
    tangency,
    unbalanced_wrench,
)

COST_SCALE = 1e-3
PER_METRE = 100.0
"""Constraint value per metre of violation."""
FACING = 4.0
"""Weight of the pads' directions in the projection, per radian."""
PUSH = 0.3
"""Weight of violated clearances against contacts in the projection."""
INSIDE = 2e-6
"""How far inside its region a contact must be, m: the solver's tolerance must not let it out."""
UNBALANCED = 5e-4
"""Unbalanced part of the wrench that is let pass."""


@dataclass(frozen=True)
class Evaluation:
    """Scaled values and Jacobians at one x: what a solver sees."""

    x: Array
    cost: float
    cost_gradient: Array
    equalities: Residual
    inequalities: Residual

    @property
    def violation(self) -> float:
        """Largest violation of any constraint, scaled."""
        worst = float(np.abs(self.equalities.values).max(initial=0.0))
        return max(worst, float(self.inequalities.values.max(initial=0.0)))


class GraspProblem:
    """The problem of one task for one assignment of pads to desired points."""

    def __init__(self, model: TaskModel, assignment: tuple[int, ...]) -> None:
        self.model = model
        self.assignment = assignment
        self.clearance = Clearance(model)
        self._data = model.robot.model.createData()
        pads = model.robot.description.pads
        limits = [interval for pad in pads for interval in (pad.patch.u, pad.patch.v)]
        self.lower = np.concatenate([model.robot.lower, [low for low, _ in limits]])
        self.upper = np.concatenate([model.robot.upper, [high for _, high in limits]])
        self.equality_count = 3 * len(pads)
        regions = 0 if model.region is None else len(pads)
        self.inequality_count = 2 + regions + len(self.clearance.links)

    def state(self, x: Array) -> State:
        """Return the state at x."""
        return State(self.model, self._data, x, self.assignment)

    def contact_residual(self, x: Array) -> Residual:
        """Return gap, direction of the pads and distances from the desired points, scaled for a projection."""
        return self._contact_residual(self.state(x))

    def contact_and_clearance_residual(self, x: Array) -> Residual:
        """Return `contact_residual` and the violated part of every clearance (zero where it is kept)."""
        state = self.state(x)
        pushing = _scaled(_violated(self.clearance(state)), PUSH * PER_METRE)
        return _stack(self._contact_residual(state), pushing)

    def _contact_residual(self, state: State) -> Residual:
        return _stack(
            _scaled(contact_gap(state), PER_METRE),
            _scaled(facing(state), FACING),
            _scaled(desired_contacts(state), PER_METRE),
            _scaled(_violated(contact_region(state)), PER_METRE),
        )

    def evaluate(self, x: Array) -> Evaluation:
        """Return cost and constraints with gradients at x."""
        state = self.state(x)
        offsets, V = desired_contacts(state), force_cost(state)
        strict = self.model.limits.strict_cost
        psi, slope = _saturated(float(V.values[0]), strict)
        k = self.model.task.force_weight
        cost = COST_SCALE * (1e6 * float(offsets.values @ offsets.values) + k * psi)
        gradient = COST_SCALE * (2e6 * offsets.values @ offsets.jacobian + k * slope * V.jacobian[0])
        equalities = _stack(
            _scaled(contact_gap(state), PER_METRE),
            _scaled(tangency(state), PER_METRE * self.model.load.rho),
        )
        log_V = Residual(np.log(V.values / strict), V.jacobian / V.values[0])
        inequalities = _stack(
            log_V,
            self._balance(state),
            _scaled(_less(contact_region(state), INSIDE), -PER_METRE),
            _scaled(self.clearance(state), -PER_METRE),
        )
        return Evaluation(x, cost, gradient, equalities, inequalities)

    def _balance(self, state: State) -> Residual:
        unbalanced = unbalanced_wrench(state)
        scale = PER_METRE * self.model.load.rho if self.model.task.balance_wrench else 0.0
        # Rounded at zero, where the norm has a kink.
        norm, rounding = float(unbalanced.values[0]), 0.25 * UNBALANCED
        smooth = math.hypot(norm, rounding)
        return Residual(np.array([scale * (smooth - UNBALANCED)]), scale * norm / smooth * unbalanced.jacobian)

    def violations(self, state: State) -> dict[str, tuple[float, str]]:
        """Return, by name of constraint, its violation (mm, or relative for forces; 0 if kept) and where.

        Clearances are the unsmoothed ones.
        """
        gap = np.abs(contact_gap(state).values)
        slope = np.abs(tangency(state).values) * self.model.load.rho
        pads = [pad.name for pad in self.model.robot.description.pads]
        unbalanced = float(unbalanced_wrench(state).values[0]) if self.model.task.balance_wrench else 0.0
        found = {
            "contact": (1e3 * float(gap.max()), pads[int(gap.argmax())]),
            "tangency": (1e3 * float(slope.max()), pads[int(slope.argmax()) // 2]),
            "forces": (max(0.0, math.log(state.forces.V / self.model.limits.strict_cost)), ""),
            "balance": (max(0.0, unbalanced - UNBALANCED) * 1e3 * self.model.load.rho, ""),
        }
        if self.model.region is not None:
            inside = contact_region(state).values
            found["contact region"] = (max(0.0, 1e3 * float(INSIDE - inside.min())), pads[int(inside.argmin())])
        for kind, (above, pair) in self.clearance.worst(state).items():
            found[kind] = (max(0.0, -1e3 * above), pair.name)
        return found


def _saturated(V: float, strict: float) -> tuple[float, float]:
    """Return psi(V) and its slope."""
    return (V, 1.0) if strict >= V else (strict * (1.0 + math.log(V / strict)), strict / V)


def _violated(residual: Residual) -> Residual:
    """Return what is below zero, and zero elsewhere."""
    below = residual.values < 0.0
    return Residual(np.where(below, residual.values, 0.0), residual.jacobian * below[:, None])


def _less(residual: Residual, amount: float) -> Residual:
    return Residual(residual.values - amount, residual.jacobian)


def _scaled(residual: Residual, scale: float) -> Residual:
    return Residual(scale * residual.values, scale * residual.jacobian)


def _stack(*residuals: Residual) -> Residual:
    return Residual(np.concatenate([r.values for r in residuals]), np.concatenate([r.jacobian for r in residuals]))
