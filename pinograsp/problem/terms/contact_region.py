"""How far inside the allowed region each contact is, (14) of the paper with limited contact surfaces."""

from __future__ import annotations

import numpy as np

from ..state import State
from .residual import Residual


def contact_region(state: State) -> Residual:
    """Return the smooth membership of every contact, m, shape (n,); empty if the whole surface is allowed."""
    model = state.model
    if model.region is None:
        return Residual(np.zeros(0), np.zeros((0, len(state.x))))
    R, origin = model.T_world_object[:3, :3], model.T_world_object[:3, 3]
    values, gradients = model.region((state.contacts.points - origin) @ R)
    return Residual(values, np.matmul((gradients @ R.T)[:, None, :], state.contacts.d_points)[:, 0])
