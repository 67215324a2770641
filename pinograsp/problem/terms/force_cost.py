"""V* (8): how well the best contact forces keep friction and force limits."""

from __future__ import annotations

import numpy as np

from ...mechanics import force_cost_gradient
from ..state import State
from .residual import Residual


def force_cost(state: State) -> Residual:
    """Return V*, dimensionless, shape (1,)."""
    gradient = force_cost_gradient(
        state.statics, state.grasp, state.grasp_derivatives, state.model.contact_models, state.forces
    )
    return Residual(np.array([state.forces.V]), gradient[None])
