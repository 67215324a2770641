"""Signed distance of the contact points to the object's surface, zero at a grasp: (14), (21), (22)."""

from __future__ import annotations

import numpy as np

from ..state import State
from .residual import Residual


def contact_gap(state: State) -> Residual:
    """Return the signed distances, m, shape (n,)."""
    distances, normals, _ = state.surface
    return Residual(distances, np.matmul(normals[:, None, :], state.contacts.d_points)[:, 0])
