"""Desired contacts: Phi (9), the sum of the squared distances of the contacts from their desired points."""

from __future__ import annotations

from ...arrays import Array
from ..constraint import PER_METRE, Descents, Projected, Residual
from ..cost import Cost
from ..state import State
from ..task_model import TaskModel


class DesiredContacts(Cost, Projected):
    """Phi, mm^2."""

    name = "desired contacts"
    descents: Descents = "targets"

    def __init__(self, model: TaskModel) -> None:
        """Nothing of a task is needed that its states do not know."""

    def offsets(self, state: State) -> Residual:
        """Return c_i - c_desired_i, m, shape (3 n,)."""
        offsets = state.contacts.points - state.desired
        return Residual(offsets.ravel(), state.contacts.d_points.reshape(offsets.size, -1))

    def value(self, state: State) -> tuple[float, Array]:
        values, jacobian = self.offsets(state)
        return 1e6 * float(values @ values), 2e6 * values @ jacobian

    def projection(self, state: State, weight: float) -> Residual:
        return self.offsets(state).scaled(weight * PER_METRE)
