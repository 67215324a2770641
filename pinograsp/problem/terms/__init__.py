"""The physical quantities of the problem, one file each: value and Jacobian at a `State`.

Whether a term is cost, equality or inequality is decided in `problem.assembly`.
"""

from .approach import approach, approach_angle
from .clearance import Clearance
from .contact_gap import contact_gap
from .contact_region import contact_region
from .desired_contacts import desired_contacts
from .facing import facing
from .force_cost import force_cost
from .joint_limits import joint_limits
from .residual import Residual
from .wrench_balance import unbalanced_wrench

__all__ = [
    "Clearance",
    "Residual",
    "approach",
    "approach_angle",
    "contact_gap",
    "contact_region",
    "desired_contacts",
    "facing",
    "force_cost",
    "joint_limits",
    "unbalanced_wrench",
]
