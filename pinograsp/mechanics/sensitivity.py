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

from ..arrays import Array, Indices
from ..compiled import compiled
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
        contacts.normals,
        contacts.jacobians,
        derivatives.points,
        derivatives.normals,
        derivatives.jacobians,
        models.rows.force,
        models.rows.spin,
    )


def residual_gradient(statics: Statics, derivatives: ContactDerivatives, models: ContactModels) -> Array:
    """Return the slope of norm(statics.residual), shape (v,); zero where the residual is only rounding."""
    norm = float(np.linalg.norm(statics.residual))
    gradient = np.zeros(derivatives.points.shape[2])
    if norm > 1e-10 * float(np.linalg.norm(statics.load.scaled)):
        change = derivatives.points, derivatives.normals, models.rows.force, models.rows.spin
        _add_grasp_matrix_change(gradient, 1.0 / norm, statics.residual, statics.f_p, statics.load.rho, *change)
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
    normals: Array,
    jacobians: Array,
    d_points: Array,
    d_normals: Array,
    d_jacobians: Array,
    force: Indices,
    spin: Indices,
) -> Array:
    nu = inverse @ (wrench + G @ (K @ (J @ Sx)))
    b = inverse @ (G @ (K @ g))
    a = K @ (g - G.T @ b)
    gradient = np.zeros(d_points.shape[2])
    change = normals, jacobians, d_normals, d_jacobians, force, spin
    _add_jacobian_change(gradient, 1.0, a, Sx - C_q * (J.T @ f), *change)
    _add_jacobian_change(gradient, -1.0, f, C_q * (J.T @ a), *change)
    _add_grasp_matrix_change(gradient, -1.0, nu, a, rho, d_points, d_normals, force, spin)
    _add_grasp_matrix_change(gradient, -1.0, b, f, rho, d_points, d_normals, force, spin)
    _add_grasp_matrix_change(gradient, -1.0, residual, G_K_R @ b, rho, d_points, d_normals, force, spin)
    for i in range(len(force)):
        for axis in range(3):
            gradient += normal_gradient[i, axis] * d_normals[i, axis]
    return gradient


@compiled
def _add_grasp_matrix_change(
    gradient: Array,
    weight: float,
    left: Array,
    f: Array,
    rho: float,
    d_points: Array,
    d_normals: Array,
    force: Indices,
    spin: Indices,
) -> None:
    """Add weight left . dG f: only the torque rows of G change."""
    x, y, z = weight / rho * left[3:]
    for i in range(len(force)):
        u, v, w = f[force[i] : force[i] + 3]
        # torque . (dp x F) = dp . (F x torque)
        gradient += (v * z - w * y) * d_points[i, 0] + (w * x - u * z) * d_points[i, 1]
        gradient += (u * y - v * x) * d_points[i, 2]
        if spin[i] >= 0:
            m = f[spin[i]]
            gradient += m * x * d_normals[i, 0] + m * y * d_normals[i, 1] + m * z * d_normals[i, 2]


@compiled
def _add_jacobian_change(
    gradient: Array,
    weight: float,
    left: Array,
    rates: Array,
    normals: Array,
    jacobians: Array,
    d_normals: Array,
    d_jacobians: Array,
    force: Indices,
    spin: Indices,
) -> None:
    """Add weight left . dJ rates, for left of shape (c,) and joint rates of shape (h,)."""
    for i in range(len(force)):
        for h in range(len(rates)):
            for axis in range(3):
                gradient += weight * rates[h] * left[force[i] + axis] * d_jacobians[i, axis, h]
            if spin[i] >= 0:
                spinning = weight * rates[h] * left[spin[i]]
                for axis in range(3):
                    gradient += spinning * normals[i, axis] * d_jacobians[i, 3 + axis, h]
                    gradient += spinning * jacobians[i, 3 + axis, h] * d_normals[i, axis]
