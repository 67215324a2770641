r"""Loads that contacts can carry: what no grasp of a hand exceeds, and what contacts at given places do.

**Any hand.** n contacts of at most f_max each carry no force above n f_max.

**Two pads that are parallel.** Their forces lie in friction cones of half-angle phi about e and -e, so the angle
between them is at least pi - 2 phi, and

    norm(F_1 + F_2)^2 <= f_1^2 + f_2^2 - 2 f_1 f_2 cos 2 phi

which is convex in f_1 and in f_2: it is greatest where each is 0 or f_max. So they carry no force above
f_max max(1, 2 sin phi).

**Torques.** A contact at most r from the centre of mass has a torque of at most r f_max about it, and a soft finger of
torsion radius e a spin torque of at most e mu f_max besides.
"""

from __future__ import annotations

import math
from typing import Any

import clarabel
import numpy as np
from scipy import sparse

from ..arrays import Array, cross
from .barrier import ForceLimits
from .contacts import ContactModels

MOST = 1e3
"""Factor of a load above which it does not matter how much more is carried."""
TINY = 1e-3
"""Least length that divides torques, m."""
_SOLVED = (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)


def greatest_force(contacts: int, limits: ForceLimits) -> float:
    """Return the force that no grasp of so many contacts exceeds, N."""
    return contacts * limits.maximum


def greatest_force_parallel(limits: ForceLimits) -> float:
    """Return the force that no grasp of two parallel pads exceeds, N."""
    return limits.maximum * max(1.0, 2.0 * math.sin(math.atan(limits.friction)))


def greatest_torque(models: ContactModels, limits: ForceLimits, radius: float) -> float:
    """Return the torque about the centre of mass that no contacts within a radius of it, m, exceed, N m."""
    return float((limits.maximum * (radius + limits.friction * models.torsion_radius)).sum())


def carried(points: Array, normals: Array, models: ContactModels, limits: ForceLimits, wrench: Array) -> float | None:
    """Return the greatest factor of a wrench that forces at contacts balance within friction and force limits.

    Args:
        points: from the centre of mass, m, shape (n, 3).
        normals: unit normals into the object, shape (n, 3).
        models: of the contacts.
        limits: of the forces.
        wrench: external force and torque about the centre of mass, N and N m, shape (6,).

    Returns:
        At most `MOST`; None if the solver fails.
    """
    size = len(models.contact_compliance)
    rho = max(TINY, float(np.linalg.norm(points, axis=1).max()))
    balance = np.zeros((6, size + 1))  # of the forces and the factor, torques divided by rho
    balance[:, size] = np.concatenate([wrench[:3], wrench[3:] / rho])
    lines, cones, sides = np.zeros((len(points) + 2, size + 1)), list[Array](), list[Array]()
    for i, (point, normal, first, spin) in enumerate(zip(points, normals, *models.rows[:2], strict=True)):
        force, torsion = np.eye(3, size + 1, first), np.zeros((1, size + 1))
        balance[:3] += force
        balance[3:] += np.array([cross(point, axis) for axis in np.eye(3)]).T / rho @ force
        if spin >= 0:
            balance[3:, spin] = normal / rho
            torsion[0, spin] = models.rows.inverse_radius[i]
        lines[i] = normal @ force
        cones += [np.vstack([lines[i] / limits.alpha, force, torsion]), np.vstack([np.zeros(size + 1), force])]
        sides += [np.zeros(5), np.array([limits.maximum, 0.0, 0.0, 0.0])]
    lines[-2, size], lines[-1, size] = 1.0, -1.0
    bounds = np.array([*(-limits.minimum for _ in points), 0.0, MOST])
    solution = clarabel.DefaultSolver(
        sparse.csc_matrix((size + 1, size + 1)),
        -np.eye(1, size + 1, size)[0],
        sparse.csc_matrix(np.vstack([balance, -lines, *(-cone for cone in cones)])),
        np.concatenate([np.zeros(6), bounds, *sides]),
        [
            clarabel.ZeroConeT(6),
            clarabel.NonnegativeConeT(len(lines)),
            *(clarabel.SecondOrderConeT(len(side)) for side in sides),
        ],
        _settings(),
    ).solve()
    return float(solution.x[size]) if solution.status in _SOLVED else None


def _settings() -> Any:
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    return settings
