"""Derivatives of V* and of the wrench residual with respect to the variables of a problem.

V* = min_y V(f, n), f = f_p + E_s y. By the envelope theorem y* need not be differentiated; and since dV/df is
perpendicular to range(F_s) at y*, neither must the basis E_s: with x = F_s^+ E_s y*, f = f_p + F_s x and

    dV* = g . df|_x + dV/dn . dn,          g = dV/df.

f is the solution, with some nu, of the linear system (C = C_s + J C_q J^T = K^-1)

    C f + G^T nu = J S x,     G f = -P w,

so that nu = (G K G^T)^+ (w + G K J S x). Its adjoint a = K (g - G^T b), b = (G K G^T)^+ G K g, gives

    g . df = a . dJ (S x - C_q J^T f) - f . dJ (C_q J^T a) - nu . dG a - b . dG f - r . dG G_K^R b

where the last term is b . dP w with r = (I - P) w, and dP = (I - P) dG G_K^R + transpose for constant rank.
The same formula gives the slope of the residual's norm: d|r| = r . dG f_p / |r|.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .contacts import ContactDerivatives, ContactModels, Contacts
from .forces import ForceSolution
from .statics import Statics


def force_cost_gradient(
    statics: Statics,
    contacts: Contacts,
    derivatives: ContactDerivatives,
    models: ContactModels,
    solution: ForceSolution,
) -> Array:
    """Return dV*/dx, shape (v,)."""
    g = solution.barrier.gradient
    f = solution.f
    G, K, J = statics.G, statics.K, statics.J
    inverse = statics.compliance_inverse
    Sx = statics.reference_displacement(solution.y)
    nu = inverse @ (statics.load.scaled + G @ (K @ (J @ Sx)))
    b = inverse @ (G @ (K @ g))
    a = K @ (g - G.T @ b)

    def dG(left: Array, right: Array) -> Array:
        return _grasp_matrix_change(left, right, statics, derivatives, models)

    C_q = statics.hand.joint_compliance
    gradient = _jacobian_change(a, Sx - C_q * (J.T @ f), contacts, derivatives, models)
    gradient -= _jacobian_change(f, C_q * (J.T @ a), contacts, derivatives, models)
    gradient -= dG(nu, a) + dG(b, f) + dG(statics.residual, statics.G_K_R @ b)
    gradient += solution.barrier.normal_gradient.ravel() @ derivatives.normals.reshape(-1, len(gradient))
    return gradient


def residual_gradient(statics: Statics, derivatives: ContactDerivatives, models: ContactModels) -> Array:
    """Return the slope of norm(statics.residual), shape (v,); zero where the residual is only rounding."""
    norm = float(np.linalg.norm(statics.residual))
    if norm <= 1e-10 * float(np.linalg.norm(statics.load.scaled)):
        return np.zeros(derivatives.points.shape[2])
    return _grasp_matrix_change(statics.residual, statics.f_p, statics, derivatives, models) / norm


def _grasp_matrix_change(
    left: Array, f: Array, statics: Statics, derivatives: ContactDerivatives, models: ContactModels
) -> Array:
    """Return left . dG f, shape (v,): only the torque rows of G change."""
    torque = left[3:] / statics.load.rho
    F = models.forces(f)
    # torque . (dp x F) = dp . (F x torque)
    lever = np.empty_like(F)
    lever[:, 0] = F[:, 1] * torque[2] - F[:, 2] * torque[1]
    lever[:, 1] = F[:, 2] * torque[0] - F[:, 0] * torque[2]
    lever[:, 2] = F[:, 0] * torque[1] - F[:, 1] * torque[0]
    variables = derivatives.points.shape[2]
    change = lever.ravel() @ derivatives.points.reshape(-1, variables)
    for i, row in zip(models.soft, models.spin_rows, strict=True):
        change = change + f[row] * (torque @ derivatives.normals[i])
    return np.asarray(change)


def _jacobian_change(
    left: Array, rates: Array, contacts: Contacts, derivatives: ContactDerivatives, models: ContactModels
) -> Array:
    """Return left . dJ rates, shape (v,), for left of shape (c,) and joint rates of shape (h,)."""
    n, _, h, v = derivatives.jacobians.shape
    wrenches = models.wrenches(left, contacts.normals)
    change = rates @ (wrenches.ravel() @ derivatives.jacobians.reshape(6 * n, h * v)).reshape(h, v)
    for i, row in zip(models.soft, models.spin_rows, strict=True):
        change = change + left[row] * ((contacts.jacobians[i, 3:] @ rates) @ derivatives.normals[i])
    return np.asarray(change)
