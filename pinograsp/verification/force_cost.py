"""The cost V of the claimed contact forces, appendix A of the paper.

Written apart from `mechanics.barrier`, which minimises it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..arrays import Array
from ..descriptions.hand import PadDescription
from ..descriptions.task import Task
from .claim import Claim
from .forces import spin_force


def force_cost(claim: Claim, normals: Array, pads: Sequence[PadDescription], task: Task) -> float:
    """Return V (A7), dimensionless.

    The conditions are Coulomb's (17), (A1) with the friction angle's cosine as alpha, the least normal force (18),
    (A2), and the greatest force (18), (A3) on its norm.

    Args:
        claim: forces and spin torques.
        normals: of the contacts, into the object, world, shape (contacts, 3).
        pads: contact models, contact i on pad i.
        task: friction coefficient, force limits and kappa.
    """
    constants = task.contact
    alpha = math.cos(math.atan(constants.friction))
    V = 0.0
    for force, torque, normal, pad in zip(claim.forces, claim.spin_torques, normals, pads, strict=True):
        pressing, size = float(force @ normal), math.hypot(*force)
        conditions = (
            alpha * math.hypot(size, spin_force(torque, pad)) - pressing,
            constants.min_normal_force - pressing,
            size - constants.max_force,
        )
        V += sum(_penalty(sigma, constants.kappa) for sigma in conditions)
    return V


def _penalty(sigma: float, kappa: float) -> float:
    """Return (A6) of a quantity that is to stay below zero, N."""
    if sigma < -kappa:
        return 0.5 / (sigma * sigma)
    # The parabola that continues it at -kappa with the same value, slope and curvature.
    s = sigma / kappa
    return (1.5 * s * s + 4.0 * s + 3.0) / kappa**2
