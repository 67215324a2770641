"""The part of the wrench that no contact force balances, relative to the wrench.

For two hard fingers it is the torque about the line that joins them: the residual is then the distance of
the centre of mass from the vertical plane through that line, in parts of the object's radius.
"""

from __future__ import annotations

import numpy as np

from ...mechanics import residual_gradient
from ..state import State
from .residual import Residual


def unbalanced_wrench(state: State) -> Residual:
    """Return |w + G f| / |w| with torques divided by rho, shape (1,); zero if there is no wrench."""
    size = float(np.linalg.norm(state.model.load.scaled)) or 1.0
    gradient = residual_gradient(state.statics, state.grasp_derivatives, state.model.contact_models)
    return Residual(np.array([np.linalg.norm(state.statics.residual) / size]), gradient[None] / size)
