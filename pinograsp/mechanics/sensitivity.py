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
from ..compiled import compiled
from .contacts import ContactDerivatives, ContactModels, Contacts, Rows
from .forces import ForceSolution
from .statics import Statics

ROUNDING = 1e-8
"""Part of the wrench below which its residual is rounding."""


def force_cost_gradient(
    statics: Statics,
    contacts: Contacts,
    derivatives: ContactDerivatives,
    models: ContactModels,
    solution: ForceSolution,
) -> Array:
    """Return dV*/dx, shape (v,)."""
    return _force_cost_gradient(
        solution.f,
        solution.barrier.gradient,
        solution.barrier.normal_gradient,
        statics.reference_displacement(solution.y),
        statics.G,
        statics.K,
        statics.J,
        statics.compliance_inverse,
        statics.G_K_R,
        statics.residual,
        statics.load.scaled,
        statics.load.rho,
        statics.hand.joint_compliance,
        contacts,
        derivatives,
        models.rows,
    )


def residual_gradient(statics: Statics, derivatives: ContactDerivatives, models: ContactModels) -> Array:
    """Return the slope of norm(statics.residual), shape (v,); zero where the residual is only rounding."""
    norm = float(np.linalg.norm(statics.residual))
    gradient = np.zeros(derivatives.points.shape[2])
    if norm > ROUNDING * float(np.linalg.norm(statics.load.scaled)):
        weight, rho = 1.0 / norm, statics.load.rho
        _add_grasp_matrix_change(gradient, weight, statics.residual, statics.f_p, rho, derivatives, models.rows)
    return gradient


@compiled
def _force_cost_gradient(
    f: Array,
    g: Array,
    normal_gradient: Array,
    Sx: Array,
    G: Array,
    K: Array,
    J: Array,
    inverse: Array,
    G_K_R: Array,
    residual: Array,
    wrench: Array,
    rho: float,
    C_q: Array,
    contacts: Contacts,
    derivatives: ContactDerivatives,
    rows: Rows,
) -> Array:
    nu = inverse @ (wrench + G @ (K @ (J @ Sx)))
    b = inverse @ (G @ (K @ g))
    a = K @ (g - G.T @ b)
    gradient = np.zeros(derivatives.points.shape[2])
    _add_jacobian_change(gradient, 1.0, a, Sx - C_q * (J.T @ f), contacts, derivatives, rows)
    _add_jacobian_change(gradient, -1.0, f, C_q * (J.T @ a), contacts, derivatives, rows)
    _add_grasp_matrix_change(gradient, -1.0, nu, a, rho, derivatives, rows)
    _add_grasp_matrix_change(gradient, -1.0, b, f, rho, derivatives, rows)
    _add_grasp_matrix_change(gradient, -1.0, residual, G_K_R @ b, rho, derivatives, rows)
    for i in range(len(normal_gradient)):
        for axis in range(3):
            gradient += normal_gradient[i, axis] * derivatives.normals[i, axis]
    return gradient


@compiled
def _add_grasp_matrix_change(
    gradient: Array, weight: float, left: Array, f: Array, rho: float, derivatives: ContactDerivatives, rows: Rows
) -> None:
    """Add weight left . dG f: only the torque rows of G change."""
    x, y, z = weight / rho * left[3:]
    for i in range(len(rows.force)):
        force, spin = rows.force[i], rows.spin[i]
        u, v, w = f[force], f[force + 1], f[force + 2]
        dp, dn = derivatives.points[i], derivatives.normals[i]
        # torque . (dp x F) = dp . (F x torque)
        gradient += (v * z - w * y) * dp[0] + (w * x - u * z) * dp[1] + (u * y - v * x) * dp[2]
        if spin >= 0:
            gradient += f[spin] * (x * dn[0] + y * dn[1] + z * dn[2])


@compiled
def _add_jacobian_change(
    gradient: Array,
    weight: float,
    left: Array,
    rates: Array,
    contacts: Contacts,
    derivatives: ContactDerivatives,
    rows: Rows,
) -> None:
    """Add weight left . dJ rates, for left of shape (c,) and joint rates of shape (h,)."""
    for i in range(len(rows.force)):
        force, spin = rows.force[i], rows.spin[i]
        for h in range(len(rates)):
            for axis in range(3):
                gradient += weight * rates[h] * left[force + axis] * derivatives.jacobians[i, axis, h]
                if spin >= 0:
                    spinning = weight * rates[h] * left[spin]
                    gradient += spinning * contacts.normals[i, axis] * derivatives.jacobians[i, 3 + axis, h]
                    gradient += spinning * contacts.jacobians[i, 3 + axis, h] * derivatives.normals[i, axis]
