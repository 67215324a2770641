r"""Lower bounds of V*, whatever the grasp; to rounding.

**Any hand.** Each contact's share of V is least where its force F points along its normal: then sigma_f, which grows
with the angle between both, and sigma_m are least for a given norm(F). So V* is at least n times the least share over
norm(F), for n contacts.

**Two pads that are parallel.** Where both are tangent to the object, their normals into it are e and -e, and the forces
are F_1 + F_2 = -w with w the external force. Let w have the parts a along e and b across it. The least
V over all F_1 and F_2,

    W(a, b) = min V(F_1, F_2)   with   F_1 + F_2 = -(a e + b t),   t perpendicular to e

(torques left out, spin torques zero: both only add to V) is convex in (a, b), since V is convex in the forces and the
condition linear. So it lies above its tangents: with the gradient (g_a, g_b) at an angle theta of w to e, and for all
angles within delta of theta,

    W >= W(theta) - norm(w) (abs(g_theta) sin delta + abs(g_r) (1 - cos delta))

where g_theta and g_r are the parts of the gradient across and along w. The least of these over angles that cover a
quarter of a turn bounds W for all directions, since W is even in a and in b.
"""

from __future__ import annotations

import math

import numpy as np

from .barrier import ForceLimits, barrier, minimiser, penalty
from .contacts import ContactModels

ANGLES = 181
"""Directions of the external force that are looked at, over a quarter of a turn."""
_NORMALS = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
_FREE = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 0.0]])
"""Forces of two contacts that add up to nothing: along and across the normals."""


def least_cost(contacts: int, limits: ForceLimits) -> float:
    """Return a lower bound of V* for `contacts` contacts of any hand."""

    def share(size: float) -> float:
        terms = (limits.alpha * size - size, limits.minimum - size, size - limits.maximum)
        return float(sum(penalty(sigma, limits.kappa)[0] for sigma in terms))

    # Convex in the norm of the force: golden section.
    low, high, ratio = 0.0, 2.0 * limits.maximum, 0.5 * (math.sqrt(5.0) - 1.0)
    while high - low > 1e-7 * limits.maximum:
        first, second = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, second) if share(first) < share(second) else (first, high)
    # The least value lies within a step of the middle; the slope there bounds what is missing.
    middle, step = 0.5 * (low + high), high - low
    slope = abs(share(middle + step) - share(middle - step)) / (2.0 * step)
    return contacts * (share(middle) - slope * step)


def least_cost_parallel(force: float, limits: ForceLimits) -> float:
    """Return a lower bound of V* for two parallel pads against an external force of this norm, N."""
    models, delta = ContactModels.hard(2, 1.0), 0.25 * math.pi / (ANGLES - 1)
    least = math.inf
    for theta in np.linspace(0.0, 0.5 * math.pi, ANGLES).tolist():
        along, across = np.array([math.cos(theta), math.sin(theta)]), np.array([-math.sin(theta), math.cos(theta)])
        f_p = -0.5 * force * np.tile([*along, 0.0], 2)
        f = f_p + _FREE @ minimiser(f_p, _FREE, _NORMALS, models.rows, limits.constants)
        value = barrier(f, _NORMALS, models, limits)
        gradient = -0.5 * value.gradient.reshape(2, 3).sum(axis=0)[:2]
        g_theta, g_r = abs(float(gradient @ across)), abs(float(gradient @ along))
        least = min(least, value.V - force * (g_theta * math.sin(delta) + g_r * (1.0 - math.cos(delta))))
    return least
