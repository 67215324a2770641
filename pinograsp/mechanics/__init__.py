"""Grasp statics and the force problem: section 3 and appendix A of the paper, on plain arrays.

Nothing here knows robots or geometry: a grasp is its contact points, normals and hand Jacobians
(`contacts`), from which `statics` builds G, J, K, G_K^R, F_s, E_s, `barrier` the function V, `forces` its
minimiser y*, `bound` what no V* is below,
`carrying` what loads contacts can carry, and `sensitivity` the derivatives of V* and of the wrench residual.
"""

from .barrier import ForceLimits
from .bound import least_cost, least_cost_parallel
from .carrying import carried, greatest_force, greatest_force_parallel, greatest_torque
from .contacts import ContactDerivatives, ContactModels, Contacts
from .forces import ForceSolution, solve_forces
from .sensitivity import force_cost_gradient, residual_gradient
from .statics import Hand, Load, Statics, grasp_statics

__all__ = [
    "ContactDerivatives",
    "ContactModels",
    "Contacts",
    "ForceLimits",
    "ForceSolution",
    "Hand",
    "Load",
    "Statics",
    "carried",
    "force_cost_gradient",
    "grasp_statics",
    "greatest_force",
    "greatest_force_parallel",
    "greatest_torque",
    "least_cost",
    "least_cost_parallel",
    "residual_gradient",
    "solve_forces",
]
