"""The cost V of contact forces, appendix A of the paper.

For contact i with force F, normal force f_n = F . n (n into the object) and, for a soft finger, spin torque m:

    sigma_f = alpha norm(F, m / e) - f_n        friction (A1)
    sigma_m = f_min - f_n                       least normal force (A2)
    sigma_M = norm(F) - f_max                   greatest force (A3)

all wanted below zero, and V sums 1 / (2 sigma^2) where sigma < -kappa, continued by the parabola
a sigma^2 + b sigma + c elsewhere (A6), which makes V finite, convex and twice continuously differentiable.

alpha = 1 / sqrt(1 + mu^2), the cosine of the friction angle. (The paper prints 1 / (1 + mu^2), which does not
reproduce its own V.)

All three have the form (A4), and with f = Z u, Z = [f_p, E_s], u = (1, y), it reads

    sigma_j(u) = alpha_j sqrt(u . M_j u) + beta_j . u + gamma_j

with small Gram matrices M_j: `ReducedBarrier` evaluates V and its derivatives in y from these alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .contacts import ContactModels

_TINY = 1e-24
"""Rounds the tip of the friction cone: added to squared norms, N^2."""


@dataclass(frozen=True)
class ForceLimits:
    """Constants of the force problem."""

    friction: float
    """mu_s."""
    minimum: float
    """f_min on the normal force, N."""
    maximum: float
    """f_max on the norm of the force, N."""
    kappa: float
    """Where the barrier turns into a parabola, N."""

    @property
    def alpha(self) -> float:
        """Cosine of the friction angle."""
        return 1.0 / math.sqrt(1.0 + self.friction**2)

    @property
    def strict_cost(self) -> float:
        """A V below this proves every sigma < -kappa: each single term is below 1 / (2 kappa^2)."""
        return 0.5 / self.kappa**2


@dataclass(frozen=True)
class Barrier:
    """V at one f, with its derivatives."""

    V: float
    gradient: Array
    """dV/df, shape (c,)."""
    normal_gradient: Array
    """dV/dn_i with f held, shape (n, 3)."""


def constraint_values(f: Array, normals: Array, models: ContactModels, limits: ForceLimits) -> Array:
    """Return sigma_f, sigma_m, sigma_M of every contact, N, shape (3, n)."""
    forces = models.forces(f)
    square = (forces * forces).sum(axis=1) + _TINY
    friction_norm = np.sqrt(square + _spin_square(f, models))
    normal_force = (forces * normals).sum(axis=1)
    return np.stack(
        [
            limits.alpha * friction_norm - normal_force,
            limits.minimum - normal_force,
            np.sqrt(square) - limits.maximum,
        ]
    )


def barrier(f: Array, normals: Array, models: ContactModels, limits: ForceLimits) -> Barrier:
    """Return V (A7) with its gradient in f and in the normals (n, 3)."""
    forces = models.forces(f)
    square = (forces * forces).sum(axis=1) + _TINY
    friction_norm = np.sqrt(square + _spin_square(f, models))
    V, slope, _ = penalty(constraint_values(f, normals, models, limits), limits.kappa)
    friction_slope = limits.alpha * slope[0] / friction_norm
    pressing = slope[0] + slope[1]
    gradient = np.empty_like(f)
    gradient[models.force_rows] = (friction_slope + slope[2] / np.sqrt(square))[:, None] * forces
    gradient[models.force_rows] -= pressing[:, None] * normals
    if models.soft.size:
        gradient[models.spin_rows] = friction_slope[models.soft] * f[models.spin_rows] * models.inverse_radius**2
    return Barrier(float(V.sum()), gradient, -pressing[:, None] * forces)


def _spin_square(f: Array, models: ContactModels) -> Array:
    square = np.zeros(models.count)
    if models.soft.size:
        square[models.soft] = (f[models.spin_rows] * models.inverse_radius) ** 2
    return square


def penalty(sigma: Array, kappa: float) -> tuple[Array, Array, Array]:
    """Return (A6) of every sigma with its first and second derivative."""
    a, b, c = 1.5 / kappa**4, 4.0 / kappa**3, 3.0 / kappa**2
    inside = sigma < -kappa
    inverse = 1.0 / np.where(inside, sigma, -1.0)
    square = inverse * inverse
    if inside.all():
        return 0.5 * square, -square * inverse, 3.0 * square * square
    V = np.where(inside, 0.5 * square, (a * sigma + b) * sigma + c)
    slope = np.where(inside, -square * inverse, 2.0 * a * sigma + b)
    curvature = np.where(inside, 3.0 * square * square, 2.0 * a)
    return V, slope, curvature


class ReducedBarrier:
    """V as a function of y, for f = f_p + E y."""

    def __init__(self, f_p: Array, E: Array, normals: Array, models: ContactModels, limits: ForceLimits) -> None:
        n, size = models.count, E.shape[1] + 1
        Z = np.column_stack([f_p, E])
        force = Z[models.force_rows]
        pressing = np.matmul(normals[:, None, :], force)[:, 0]
        self._M = np.empty((3 * n, size, size))
        gram = np.matmul(force.transpose(0, 2, 1), force)
        gram[:, 0, 0] += _TINY
        self._M[:n] = self._M[n : 2 * n] = self._M[2 * n :] = gram
        for i, row, inverse in zip(models.soft, models.spin_rows, models.inverse_radius, strict=True):
            self._M[i] += np.outer(Z[row], Z[row]) * inverse**2
        self._alpha = np.repeat([limits.alpha, 0.0, 1.0], n)
        self._beta = np.zeros((3 * n, size))
        self._beta[:n] = self._beta[n : 2 * n] = -pressing
        self._gamma = np.repeat([0.0, limits.minimum, -limits.maximum], n)
        self._kappa = limits.kappa
        self.pressing = pressing

    def __call__(self, y: Array) -> tuple[float, Array, Array]:
        """Return V, dV/dy and d2V/dy2."""
        u = np.concatenate([[1.0], y])
        Mu = self._M @ u
        norm = np.sqrt(Mu @ u)
        sigma = self._alpha * norm + self._beta @ u + self._gamma
        V, slope, curvature = penalty(sigma, self._kappa)
        unit = Mu / norm[:, None]
        direction = self._alpha[:, None] * unit + self._beta
        bend = slope * self._alpha / norm
        hessian = (direction.T * curvature) @ direction - (unit.T * bend) @ unit
        hessian += (bend @ self._M.reshape(len(bend), -1)).reshape(hessian.shape)
        return float(V.sum()), slope @ direction[:, 1:], hessian[1:, 1:]
