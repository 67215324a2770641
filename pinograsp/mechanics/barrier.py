"""The cost V of contact forces, appendix A of the paper, and its minimiser over internal forces.

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
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from .contacts import ContactModels, Rows

MAX_ITERATIONS = 60
ARMIJO = 1e-4
SQUEEZE = 0.7
"""Normal force, in parts of f_max, at which the search for y* starts."""
_TINY = 1e-24
"""Rounds the tip of the friction cone: added to squared norms, N^2."""


class Constants(NamedTuple):
    """The numbers of `ForceLimits` that V needs."""

    alpha: float
    minimum: float
    maximum: float
    kappa: float


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

    @cached_property
    def constants(self) -> Constants:
        """The numbers that V needs."""
        return Constants(self.alpha, self.minimum, self.maximum, self.kappa)


@dataclass(frozen=True)
class Barrier:
    """V at one f, with its derivatives."""

    V: float
    gradient: Array
    """dV/df, shape (c,)."""
    normal_gradient: Array
    """dV/dn_i with f held, shape (n, 3)."""
    terms: Array
    """The terms of V, of sigma_f, sigma_m and sigma_M of every contact, shape (n, 3)."""


def barrier(f: Array, normals: Array, models: ContactModels, limits: ForceLimits) -> Barrier:
    """Return V (A7) with its gradient in f and in the normals (n, 3)."""
    return Barrier(*_barrier(f, normals, models.rows, limits.constants))


@compiled
def _barrier(f: Array, normals: Array, rows: Rows, limits: Constants) -> tuple[float, Array, Array, Array]:
    V, gradient, normal_gradient = 0.0, np.zeros(len(f)), np.empty((len(rows.force), 3))
    terms = np.empty((len(rows.force), 3))
    for i in range(len(rows.force)):
        row, torsion = rows.force[i], f[rows.spin[i]] * rows.inverse_radius[i]
        square, pressing = _TINY, 0.0
        for axis in range(3):
            square += f[row + axis] ** 2
            pressing += f[row + axis] * normals[i, axis]
        size, cone = math.sqrt(square), math.sqrt(square + torsion**2)
        V_f, friction, _ = penalty(limits.alpha * cone - pressing, limits.kappa)
        V_m, least, _ = penalty(limits.minimum - pressing, limits.kappa)
        V_M, greatest, _ = penalty(size - limits.maximum, limits.kappa)
        V += V_f + V_m + V_M
        terms[i, 0], terms[i, 1], terms[i, 2] = V_f, V_m, V_M
        along = limits.alpha * friction / cone
        for axis in range(3):
            F, n = f[row + axis], normals[i, axis]
            gradient[row + axis] = (along + greatest / size) * F - (friction + least) * n
            normal_gradient[i, axis] = -(friction + least) * F
        if rows.spin[i] >= 0:
            gradient[rows.spin[i]] = along * torsion * rows.inverse_radius[i]
    return V, gradient, normal_gradient, terms


@compiled
def penalty(sigma: float, kappa: float) -> tuple[float, float, float]:
    """Return (A6) of a sigma with its first and second derivative."""
    if sigma < -kappa:
        inverse = 1.0 / sigma
        square = inverse * inverse
        return 0.5 * square, -square * inverse, 3.0 * square * square
    a, b, c = 1.5 / kappa**4, 4.0 / kappa**3, 3.0 / kappa**2
    return (a * sigma + b) * sigma + c, 2.0 * a * sigma + b, 2.0 * a


@compiled
def minimiser(f_p: Array, E: Array, normals: Array, rows: Rows, limits: Constants) -> Array:
    """Return y* (8), shape (e_s,).

    V is strictly convex in y, so a damped Newton iteration in e_s dimensions finds the minimiser to machine
    precision from anywhere. It starts where the squeezing force is nearest to a fixed part of what the contacts may
    bear.

    Args:
        f_p: particular solution, N, shape (c,).
        E: basis of the internal forces, shape (c, e_s), e_s > 0.
        normals: unit normals into the object, shape (n, 3).
        rows: of the contacts in f.
        limits: constants of V.
    """
    reduced = reduced_barrier(f_p, E, normals, rows, limits)
    y = _initial(reduced)
    V, gradient, hessian = reduced_value(reduced, y)
    for _ in range(MAX_ITERATIONS):
        step = -np.linalg.solve(hessian, gradient)
        decrement = -(gradient * step).sum()
        if decrement <= 1e-15 * (1.0 + V):
            return y + step
        length = 1.0
        trial = reduced_value(reduced, y + step)
        while not trial[0] <= V - ARMIJO * length * decrement:
            length *= 0.5
            if length < 1e-10:
                return y
            trial = reduced_value(reduced, y + length * step)
        y = y + length * step
        V, gradient, hessian = trial
    return y


@compiled
def _initial(reduced: ReducedBarrier) -> Array:
    """Return the y whose normal forces are nearest to SQUEEZE f_max (least squares)."""
    n, size = len(reduced.pressing), reduced.pressing.shape[1] - 1
    square, right = 1e-12 * np.eye(size), np.zeros(size)
    for i in range(n):
        per_y = reduced.pressing[i, 1:]
        for j in range(size):
            right[j] += per_y[j] * (SQUEEZE * reduced.limits.maximum - reduced.pressing[i, 0])
            for k in range(size):
                square[j, k] += per_y[j] * per_y[k]
    return np.linalg.solve(square, right).astype(np.float64)


class ReducedBarrier(NamedTuple):
    """V as a function of y, for f = f_p + E y, with e_s entries of y: matrices of m = 1 + e_s rows."""

    cone: Array
    """Gram matrices M_j of sigma_f, shape (n, m, m)."""
    size: Array
    """Gram matrices M_j of sigma_M, shape (n, m, m)."""
    pressing: Array
    """Normal forces per u, shape (n, m)."""
    limits: Constants


@compiled
def reduced_barrier(f_p: Array, E: Array, normals: Array, rows: Rows, limits: Constants) -> ReducedBarrier:
    """Return V in terms of y; E has shape (c, e_s)."""
    n, m = len(rows.force), E.shape[1] + 1
    Z = np.empty((len(f_p), m))
    for row in range(len(f_p)):
        Z[row, 0] = f_p[row]
        for k in range(1, m):
            Z[row, k] = E[row, k - 1]
    cone, size, pressing = np.zeros((n, m, m)), np.zeros((n, m, m)), np.zeros((n, m))
    for i in range(n):
        size[i, 0, 0] = _TINY
        for j in range(m):
            for axis in range(3):
                F = Z[rows.force[i] + axis]
                pressing[i, j] += normals[i, axis] * F[j]
                for k in range(m):
                    size[i, j, k] += F[j] * F[k]
            for k in range(m):
                torsion = Z[rows.spin[i], j] * Z[rows.spin[i], k] * rows.inverse_radius[i] ** 2
                cone[i, j, k] = size[i, j, k] + torsion
    return ReducedBarrier(cone, size, pressing, limits)


@compiled
def reduced_value(reduced: ReducedBarrier, y: Array) -> tuple[float, Array, Array]:
    """Return V, dV/dy and d2V/dy2, shapes (), (e_s,), (e_s, e_s)."""
    m = len(y) + 1
    u = np.ones(m)
    u[1:] = y
    V, gradient, hessian = 0.0, np.zeros(m), np.zeros((m, m))
    limits = reduced.limits
    for i in range(len(reduced.pressing)):
        cone, size, pressing = reduced.cone[i], reduced.size[i], reduced.pressing[i]
        V += _add_term(cone, limits.alpha, pressing, -1.0, 0.0, u, limits.kappa, gradient, hessian)
        V += _add_term(size, 0.0, pressing, -1.0, limits.minimum, u, limits.kappa, gradient, hessian)
        V += _add_term(size, 1.0, pressing, 0.0, -limits.maximum, u, limits.kappa, gradient, hessian)
    return V, gradient[1:].copy(), hessian[1:, 1:].copy()


@compiled
def _add_term(
    M: Array,
    alpha: float,
    pressing: Array,
    beta: float,
    gamma: float,
    u: Array,
    kappa: float,
    gradient: Array,
    hessian: Array,
) -> float:
    """Return the penalty of one sigma_j(u), where beta_j = beta pressing, and add its derivatives in u."""
    m = len(u)
    unit = np.zeros(m)
    square, sigma = 0.0, gamma
    for j in range(m):
        for k in range(m):
            unit[j] += M[j, k] * u[k]
        square += unit[j] * u[j]
        sigma += beta * pressing[j] * u[j]
    norm = math.sqrt(square)
    V, slope, curvature = penalty(sigma + alpha * norm, kappa)
    unit /= norm
    for j in range(m):
        direction = alpha * unit[j] + beta * pressing[j]
        gradient[j] += slope * direction
        for k in range(m):
            bent = slope * alpha / norm * (M[j, k] - unit[j] * unit[k])
            hessian[j, k] += bent + curvature * direction * (alpha * unit[k] + beta * pressing[k])
    return V
