"""The nested problem (8): y* minimises V(w, y) over the active internal forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .barrier import Barrier, ForceLimits, barrier, minimiser
from .contacts import ContactModels
from .statics import Statics


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
        y = minimiser(f_p, E, normals, models.rows, limits.constants)
    f = f_p + E @ y
    return ForceSolution(y, f, barrier(f, normals, models, limits))
