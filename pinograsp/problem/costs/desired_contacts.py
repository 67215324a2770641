"""Desired contacts: Phi (9), the sum of the squared distances of the contacts from their desired points.

Where a task leaves them out, each start is led to a pair of points that is proposed to it. It goes on from there as
constraints and forces have it: nobody wants the contacts to be at these points, and Phi is zero.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ..constraint import PER_METRE, Descents, Projected, Residual
from ..cost import Cost
from ..state import State
from ..task_model import TaskModel

FACING = 60.0
"""Weight in the projection of pads that look at the face of their desired point, per radian: above pad tangency's."""


class DesiredContacts(Cost, Projected):
    """Phi, mm^2."""

    name = "desired contacts"
    descents: Descents = "targets"

    def offsets(self, state: State) -> Residual:
        """Return c_i - c_desired_i, m, shape (3 n,)."""
        offsets = state.contacts.points - state.desired
        return Residual(offsets.ravel(), state.contacts.d_points.reshape(offsets.size, -1))

    def value(self, state: State) -> tuple[float, Array]:
        values, jacobian = self.offsets(state)
        return 1e6 * float(values @ values), 2e6 * values @ jacobian

    def facings(self, state: State) -> Residual:
        """Return n_pad + n of what each pad is to look at, dimensionless, shape (3 n,)."""
        flat = np.any(state.desired_normals, axis=1)
        values = np.where(flat[:, None], state.contacts.normals + state.desired_normals, 0.0)
        jacobian = np.where(flat[:, None, None], state.contacts.d_normals, 0.0)
        return Residual(values.ravel(), jacobian.reshape(values.size, -1))

    def projection(self, state: State, weight: float) -> Residual:
        """Return the distances, and that pads look at the faces that are meant: other faces do not let them go."""
        offsets = self.offsets(state).scaled(weight * PER_METRE)
        if not np.any(state.desired_normals):
            return offsets
        facings = self.facings(state).scaled(weight * FACING)
        return Residual(*(np.concatenate(parts) for parts in zip(offsets, facings, strict=True)))


class ProposedContacts(DesiredContacts):
    """Nothing, in a task that desires no contacts: the projection alone draws them to those that are proposed."""

    name = "proposed contacts"

    def value(self, state: State) -> tuple[float, Array]:
        return 0.0, np.zeros(len(state.x))


def desired_contacts(model: TaskModel) -> DesiredContacts:
    """Return the cost."""
    return ProposedContacts() if model.task.desired_contacts is None else DesiredContacts()
