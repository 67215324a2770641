"""The problem of a task: its costs and constraints, put together for a solver.

The solver minimises COST_SCALE times the sum of the costs, with equalities = 0 and inequalities <= 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar, get_args

import numpy as np
from scipy.linalg import block_diag

from ..arrays import Array
from .constraint import Constraint, Descents, Kind, Projected, Residual, Violation
from .constraints import CONSTRAINTS
from .cost import Cost
from .costs import COSTS
from .desired import DesiredPoints
from .state import State
from .task_model import TaskModel

COST_SCALE = 1e-3
DEPENDENT = 1e-4
"""Singular value, in parts of the largest, below which equalities count as dependent."""

KEPT = 4
"""States that a problem keeps: solves, and steps of them, begin where the ones before have ended."""

Part = TypeVar("Part")


@dataclass(frozen=True)
class Evaluation:
    """Scaled values and Jacobians at one x: all that a solver sees."""

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


class Rows(NamedTuple):
    """Names of the rows of an `Evaluation`."""

    equalities: tuple[str, ...]
    inequalities: tuple[str, ...]


class GraspProblem:
    """The problem of one task for one assignment of pads to desired points.

    Args:
        model: the task.
        assignment: desired point of every pad.
        constraints: makers of the constraints, in the order of their rows.
        costs: makers of the costs.
        desired: points that are proposed; None: those that the task desires.
    """

    def __init__(
        self,
        model: TaskModel,
        assignment: tuple[int, ...],
        constraints: Sequence[Callable[[TaskModel], Constraint | None]] = CONSTRAINTS,
        costs: Sequence[Callable[[TaskModel], Cost | None]] = COSTS,
        desired: DesiredPoints | None = None,
    ) -> None:
        self.model = model
        self.assignment = assignment
        wanted = desired or DesiredPoints(model.desired_points, model.desired_normals)
        self._desired = DesiredPoints(wanted.points[list(assignment)], wanted.normals[list(assignment)])
        self.constraints = _made(constraints, model)
        self.costs = _made(costs, model)
        self._equalities, self._inequalities = self._of("equality"), self._of("inequality")
        projected = [term for term in (*self.constraints, *self.costs) if isinstance(term, Projected)]
        self._projected: dict[Descents, list[Projected]] = {
            descents: [term for term in projected if term.descents == descents] for descents in get_args(Descents)
        }
        self.rows = Rows(_rows(self._equalities), _rows(self._inequalities))
        self._data = model.robot.model.createData()
        self._states: dict[bytes, State] = {}
        low, high = model.parameter_limits.T
        self.lower = np.concatenate([model.lower, low])
        self.upper = np.concatenate([model.upper, high])
        self.free = self.lower < self.upper
        """Variables that are not locked."""

    def _of(self, kind: Kind) -> list[Constraint]:
        return [constraint for constraint in self.constraints if constraint.kind == kind]

    def state(self, x: Array) -> State:
        """Return the state at x; the last few are kept, with all that was measured there."""
        key = x.tobytes()
        state = self._states.pop(key, None)
        if state is None:
            state = State(self.model, self._data, x.copy(), self._desired)
        self._states[key] = state
        if len(self._states) > KEPT:
            del self._states[next(iter(self._states))]
        return state

    def evaluate(self, x: Array) -> Evaluation:
        """Return cost and constraints with gradients at x."""
        state = self.state(x)
        values, gradients = zip(*(cost.value(state) for cost in self.costs), strict=True)
        return Evaluation(
            x,
            COST_SCALE * sum(values),
            COST_SCALE * sum(gradients),
            _stacked([constraint.residual(state) for constraint in self._equalities]),
            _stacked([constraint.residual(state) for constraint in self._inequalities]),
        )

    def projection_residual(self, x: Array, target_weight: float, clearance_weight: float) -> Residual:
        """Return the stacked residual that the projection minimises.

        Args:
            x: the point, shape (v,).
            target_weight: of the distances from the desired contacts; 0: left out.
            clearance_weight: of the violated clearances; 0: left out, not measured.
        """
        state = self.state(x)
        weights: dict[Descents, float] = {"every": 1.0, "targets": target_weight, "clearances": clearance_weight}
        return _stacked(
            [
                term.projection(state, weight)
                for descents, weight in weights.items()
                if weight > 0.0
                for term in self._projected[descents]
            ]
        )

    def equality_basis(self, near: Evaluation) -> Array:
        """Return combinations of the equalities that are independent near a point of contact, shape (r, rows).

        Among those that every equality calls independent, some can depend on others, there and wherever the solver
        goes from there: pads that are parallel whatever the hand does cannot both be tilted against the straight line
        of a cylinder. What is left out stays part of `Evaluation.violation`.
        """
        state = self.state(near.x)
        across = block_diag(*(constraint.independent(state) for constraint in self._equalities))
        rows, sizes, _ = np.linalg.svd((across @ near.equalities.jacobian)[:, self.free], full_matrices=False)
        return np.asarray(rows[:, sizes > DEPENDENT * sizes.max()].T @ across)

    def violations(self, state: State) -> tuple[Violation, ...]:
        """Return the violations of all constraints, those that are kept with a value of 0.

        The bounds of the posture, and joint ranges with them, always hold.
        """
        return tuple(violation for constraint in self.constraints for violation in constraint.violations(state))


def _made(makers: Iterable[Callable[[TaskModel], Part | None]], model: TaskModel) -> tuple[Part, ...]:
    """Return the terms that the task asks for."""
    return tuple(part for make in makers if (part := make(model)) is not None)


def _rows(constraints: Iterable[Constraint]) -> tuple[str, ...]:
    return tuple(row for constraint in constraints for row in constraint.rows)


def _stacked(parts: list[Residual]) -> Residual:
    """Return the rows of all parts, one below the other."""
    values, jacobians = zip(*parts, strict=True)
    return Residual(np.concatenate(values), np.concatenate(jacobians))
