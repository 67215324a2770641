"""The nested problem (8): y* minimises V(w, y) over the active internal forces.

V is strictly convex in y, so a damped Newton iteration in e_s dimensions finds the minimiser to machine
precision from anywhere. It starts where the squeezing force is nearest to a fixed part of what the contacts may bear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .barrier import Barrier, ForceLimits, ReducedBarrier, barrier
from .contacts import ContactModels
from .statics import Statics

MAX_ITERATIONS = 60
ARMIJO = 1e-4
SQUEEZE = 0.7
"""Normal force, in parts of f_max, at which the iteration starts."""


@dataclass(frozen=True)
class ForceSolution:
    """The best contact forces of a grasp."""

    y: Array
    """Active internal forces in the basis E_s, shape (e_s,)."""
    f: Array
    """Contact forces on the object, shape (c,)."""
    barrier: Barrier
    """V and its derivatives at f."""

    @property
    def V(self) -> float:
        """V* (8)."""
        return self.barrier.V


def solve_forces(statics: Statics, normals: Array, models: ContactModels, limits: ForceLimits) -> ForceSolution:
    """Minimise V over y.

    Args:
        statics: the grasp's matrices.
        normals: unit normals into the object, shape (n, 3).
        models: contact models.
        limits: friction and force limits.
    """
    E, f_p = statics.E_s, statics.f_p
    y = np.zeros(0)
    if E.shape[1]:
        reduced = ReducedBarrier(f_p, E, normals, models, limits)
        y = _newton(reduced, _initial(reduced, limits))
    f = f_p + E @ y
    return ForceSolution(y, f, barrier(f, normals, models, limits))


def _newton(reduced: ReducedBarrier, y: Array) -> Array:
    V, gradient, hessian = reduced(y)
    for _ in range(MAX_ITERATIONS):
        step = -np.linalg.solve(hessian, gradient)
        decrement = -float(gradient @ step)
        if decrement <= 1e-15 * (1.0 + V):
            return np.asarray(y + step)
        length = 1.0
        while True:
            trial = reduced(y + length * step)
            if trial[0] <= V - ARMIJO * length * decrement:
                break
            length *= 0.5
            if length < 1e-10:
                return y
        y = y + length * step
        V, gradient, hessian = trial
    return y


def _initial(reduced: ReducedBarrier, limits: ForceLimits) -> Array:
    """Return the y whose normal forces are nearest to SQUEEZE f_max (least squares)."""
    per_y = reduced.pressing[:, 1:]
    missing = SQUEEZE * limits.maximum - reduced.pressing[:, 0]
    square = per_y.T @ per_y
    square += 1e-12 * np.eye(len(square))
    return np.linalg.solve(square, per_y.T @ missing)
