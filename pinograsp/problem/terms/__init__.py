"""The physical quantities of the problem, one file each: value and Jacobian at a `State`.

Whether a term is cost, equality or inequality is decided in `problem.assembly`.
"""

from .clearance import Clearance
from .contact_gap import contact_gap
from .contact_region import contact_region
from .desired_contacts import desired_contacts
from .force_cost import force_cost
from .residual import Residual
from .tangency import facing, tangency
from .wrench_balance import unbalanced_wrench

__all__ = [
    "Clearance",
    "Residual",
    "contact_gap",
    "contact_region",
    "desired_contacts",
    "facing",
    "force_cost",
    "tangency",
    "unbalanced_wrench",
]
