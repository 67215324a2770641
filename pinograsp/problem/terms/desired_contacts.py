"""Distance vectors of the contacts from their desired points; their squared norms sum to Phi (9)."""

from __future__ import annotations

from ..state import State
from .residual import Residual


def desired_contacts(state: State) -> Residual:
    """Return c_i - c_desired_i, m, shape (3 n,)."""
    offsets = state.contacts.points - state.desired
    return Residual(offsets.ravel(), state.contacts.d_points.reshape(offsets.size, -1))
