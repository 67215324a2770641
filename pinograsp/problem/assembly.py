"""The terms put together as cost, equalities and inequalities, scaled for a solver.

    cost          COST_SCALE (Phi [mm^2] + k psi(V*))
    equalities    contact gap, pads facing the surface               = 0
    inequalities  V*, unbalanced wrench, region, approach, joint limits, clearance of links <= 0

Scaling: one millimetre is 0.1 in every constraint, and the cost is U / 1000; this decides how many starts
succeed. psi(V) = V up to the value that proves every friction and force limit (strict_cost), and grows like log V
beyond it, so that the enormous V of a hopeless geometry does not drown everything else; no grasp that keeps
the inequality on V* sees the difference.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from .state import State
from .task_model import TaskModel
from .terms import (
    Clearance,
    Residual,
    approach,
    approach_angle,
    contact_gap,
    contact_region,
    desired_contacts,
    facing,
    force_cost,
    joint_limits,
    unbalanced_wrench,
)

COST_SCALE = 1e-3
PER_METRE = 100.0
"""Constraint value per metre of violation."""
PER_RADIAN = 10.0
"""Constraint value per radian of an approach direction outside its cone."""
FACING = 4.0
"""Weight of the pads' directions in the projection, per radian."""
INSIDE = 2e-6
"""How far inside its region a contact must be, m: the solver's tolerance must not let it out."""
DEPENDENT = 1e-4
"""Singular value, in parts of the largest, below which equalities count as dependent."""
INSIDE_CONE = 2e-5
"""How far inside its cone the approach direction must be, rad: as for `INSIDE`."""
INSIDE_LIMITS = 2e-5
"""How far inside its limits a joint must be that several synergies move, rad (m): as for `INSIDE`."""
UNBALANCED = 5e-4
"""Unbalanced part of the wrench that is let pass."""

UNITS = {"forces": "", "approach": "deg", "joint limits": "deg"}
"""Units of violations that are not in mm; forces are relative. A degree weighs about as much as a millimetre."""


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


class _Inside(NamedTuple):
    """A term that is to be positive: how far inside something the grasp is; no rows if nothing is asked for."""

    of: Callable[[State], Residual]
    scale: float
    least: float
    """How far inside it must be."""


_INSIDES = (
    _Inside(contact_region, PER_METRE, INSIDE),
    _Inside(approach, PER_RADIAN, INSIDE_CONE),
    _Inside(joint_limits, PER_RADIAN, INSIDE_LIMITS),
)


class _Part(NamedTuple):
    """Rows of a stacked residual."""

    residual: Residual
    scale: float
    least: float = 0.0
    """Taken from the values."""
    violated: bool = False
    """Whether only values below `least` count."""


class GraspProblem:
    """The problem of one task for one assignment of pads to desired points."""

    def __init__(self, model: TaskModel, assignment: tuple[int, ...]) -> None:
        self.model = model
        self.assignment = assignment
        self.clearance = Clearance(model)
        self._data = model.robot.model.createData()
        pads = model.robot.description.pads
        low, high = model.robot.parameter_limits.T
        self.lower = np.concatenate([model.lower, low])
        self.upper = np.concatenate([model.upper, high])
        regions = 0 if model.region is None else len(pads)
        cones = 0 if model.approach is None else 1
        limits = 2 * len(model.robot.shared_joints)
        self.inequality_count = 2 + regions + cones + limits + len(self.clearance.links)

    def state(self, x: Array) -> State:
        """Return the state at x."""
        return State(self.model, self._data, x, self.assignment)

    def projection_residual(self, x: Array, wishes: float, clearances: float) -> Residual:
        """Return what a projection makes small: all constraints on geometry, as residuals, and the wish.

        Gap and direction of the pads, and where they are violated region, approach, joint limits, clearances; scaled.

        Args:
            x: the point, shape (v,).
            wishes: weight of the distances from the desired points; 0: left out.
            clearances: weight of the violated clearances; 0: left out, not measured.
        """
        state = self.state(x)
        parts = [_Part(contact_gap(state), PER_METRE), _Part(facing(state), FACING)]
        parts += [_Part(term.of(state), term.scale, term.least, violated=True) for term in _INSIDES]
        if wishes > 0.0:
            parts.append(_Part(desired_contacts(state), wishes * PER_METRE))
        if clearances > 0.0:
            parts.append(_Part(self.clearance(state), clearances * PER_METRE, violated=True))
        return _stack(parts)

    def equality_basis(self, near: Evaluation) -> Array:
        """Return combinations of the equalities that are independent near a point of contact, shape (r, 4 n).

        Of the three components of a pad's direction two are independent where it faces the surface: those across the
        surface's normal. Among them some can depend on others, there and wherever the solver goes from there: pads
        that are parallel whatever the hand does cannot both be tilted against the straight line of a cylinder. What is
        left out stays part of `Evaluation.violation`.
        """
        normals = self.state(near.x).surface[1]
        n = len(normals)
        across = np.zeros((3 * n, 4 * n))
        across[:n, :n] = np.eye(n)
        for i, normal in enumerate(normals):
            _, _, axes = np.linalg.svd(normal[None])
            across[n + 2 * i : n + 2 * i + 2, n + 3 * i : n + 3 * i + 3] = axes[1:]
        rows, sizes, _ = np.linalg.svd(across @ near.equalities.jacobian, full_matrices=False)
        return np.asarray(rows[:, sizes > DEPENDENT * sizes.max()].T @ across)

    def evaluate(self, x: Array) -> Evaluation:
        """Return cost and constraints with gradients at x."""
        state = self.state(x)
        offsets, V = desired_contacts(state), force_cost(state)
        strict = self.model.limits.strict_cost
        psi, slope = _saturated(float(V.values[0]), strict)
        k = self.model.task.force_weight
        cost = COST_SCALE * (1e6 * float(offsets.values @ offsets.values) + k * psi)
        gradient = COST_SCALE * (2e6 * offsets.values @ offsets.jacobian + k * slope * V.jacobian[0])
        equalities = [_Part(contact_gap(state), PER_METRE), _Part(facing(state), PER_METRE * self.model.load.rho)]
        log_V = Residual(np.log(V.values / strict), V.jacobian / V.values[0])
        inequalities = [_Part(log_V, 1.0), _Part(self._balance(state), 1.0)]
        inequalities += [_Part(term.of(state), -term.scale, term.least) for term in _INSIDES]
        inequalities.append(_Part(self.clearance(state), -PER_METRE))
        return Evaluation(x, cost, gradient, _stack(equalities), _stack(inequalities))

    def _balance(self, state: State) -> Residual:
        unbalanced = unbalanced_wrench(state)
        scale = PER_METRE * self.model.load.rho if self.model.task.balance_wrench else 0.0
        # Rounded at zero, where the norm has a kink.
        norm, rounding = float(unbalanced.values[0]), 0.25 * UNBALANCED
        smooth = math.hypot(norm, rounding)
        return Residual(np.array([scale * (smooth - UNBALANCED)]), scale * norm / smooth * unbalanced.jacobian)

    def violations(self, state: State) -> dict[str, tuple[float, str]]:
        """Return, by name of constraint, its violation (in `UNITS`, 0 if kept) and where.

        Clearances are the unsmoothed ones. The bounds of the posture, and joint ranges with them, always hold.
        """
        gap = np.abs(contact_gap(state).values)
        slope = np.linalg.norm(facing(state).values.reshape(-1, 3), axis=1) * self.model.load.rho
        pads = [pad.name for pad in self.model.robot.description.pads]
        unbalanced = float(unbalanced_wrench(state).values[0]) if self.model.task.balance_wrench else 0.0
        found = {
            "contact": (1e3 * float(gap.max()), pads[int(gap.argmax())]),
            "tangency": (1e3 * float(slope.max()), pads[int(slope.argmax())]),
            "forces": (max(0.0, math.log(state.forces.V / self.model.limits.strict_cost)), ""),
            "balance": (max(0.0, unbalanced - UNBALANCED) * 1e3 * self.model.load.rho, ""),
        }
        if self.model.region is not None:
            inside = contact_region(state).values
            found["contact region"] = (max(0.0, 1e3 * float(INSIDE - inside.min())), pads[int(inside.argmin())])
        if self.model.approach is not None:
            beyond = approach_angle(state) + INSIDE_CONE - self.model.approach.angle
            found["approach"] = (max(0.0, math.degrees(beyond)), self.model.robot.description.arm.wrist)
        if len(shared := self.model.robot.shared_joints):
            inside = joint_limits(state).values - INSIDE_LIMITS
            name = self.model.robot.joint_names[shared[int(inside.argmin()) % len(shared)]]
            found["joint limits"] = (max(0.0, -math.degrees(inside.min())), name)
        for kind, (above, pair) in self.clearance.worst(state).items():
            found[kind] = (max(0.0, -1e3 * above), pair.name)
        return found


def _saturated(V: float, strict: float) -> tuple[float, float]:
    """Return psi(V) and its slope."""
    return (V, 1.0) if strict >= V else (strict * (1.0 + math.log(V / strict)), strict / V)


def _stack(parts: list[_Part]) -> Residual:
    """Return scale (value - least) of all rows; of parts that count where they are violated, zero elsewhere."""
    counts = [len(part.residual.values) for part in parts]
    scales, least, violated = np.repeat([part[1:] for part in parts], counts, axis=0).T
    values = np.concatenate([part.residual.values for part in parts]) - least
    scales = np.where((violated > 0.0) & (values >= 0.0), 0.0, scales)
    return Residual(scales * values, scales[:, None] * np.concatenate([part.residual.jacobian for part in parts]))
