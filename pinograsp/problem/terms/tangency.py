"""Slope of the object's surface against the pad, zero where both are tangent.

Together with a zero gap this is contact without penetration of pad and object: a penetration tolerance t
instead would let the contact slide by sqrt(2 r t).
"""

from __future__ import annotations

import numpy as np

from ..state import State
from .residual import Residual


def facing(state: State) -> Residual:
    """Return n_pad + n_object, shape (3 n,): zero only where a pad faces the surface and is tangent to it.

    Not fit for an equality constraint (two of three components are independent there), but, unlike
    `tangency`, not zero where a pad turns its back.
    """
    _, normals, hessians = state.surface
    contacts = state.contacts
    values = contacts.normals + normals
    jacobian = contacts.d_normals + np.matmul(hessians, contacts.d_points)
    return Residual(values.ravel(), jacobian.reshape(values.size, -1))


def tangency(state: State) -> Residual:
    """Return n_object . (pad axes x, y), dimensionless, shape (2 n,).

    A pad that faces away from the object is tangent too; its forces then cannot press, which V shows.
    """
    _, normals, hessians = state.surface
    contacts = state.contacts
    values = np.matmul(contacts.axes, normals[:, :, None])[:, :, 0]
    d_normals = np.matmul(hessians, contacts.d_points)
    jacobian = np.matmul(contacts.axes, d_normals)
    jacobian += np.matmul(normals[:, None, None, :], contacts.d_axes)[:, :, 0]
    return Residual(values.ravel(), jacobian.reshape(values.size, -1))
