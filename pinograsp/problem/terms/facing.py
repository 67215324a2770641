"""Directions of pads and surface against each other: zero where both are tangent and face each other.

Together with a zero gap this is contact without penetration of pad and object: a penetration tolerance t
instead would let the contact slide by sqrt(2 r t).
"""

from __future__ import annotations

import numpy as np

from ..state import State
from .residual import Residual


def facing(state: State) -> Residual:
    """Return n_pad + n_object, dimensionless, shape (3 n,).

    Two of a pad's three components are independent where it faces the surface (`GraspProblem.equality_basis`). For
    small tilts the norm is the angle between pad and surface.
    """
    _, normals, hessians = state.surface
    contacts = state.contacts
    values = contacts.normals + normals
    jacobian = contacts.d_normals + np.matmul(hessians, contacts.d_points)
    return Residual(values.ravel(), jacobian.reshape(values.size, -1))
