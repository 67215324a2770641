"""The optimisation problem: variables x = (q_a, sigma, q_c), costs and constraints with exact gradients.

    minimise   U(x) = sum_i ||c_desired_i - c_i(x)||^2 + k V*(x)                       (9)-(12)
    subject to bounds on x, contact on the object's surface, clearances, balance       (13)-(16)

The active internal forces y belong to x as the minimiser of the nested problem (8).
"""

from .checks import check_placement, check_task, file_findings
from .constraint import Constraint, Inside, Residual, Violation
from .constraints import CONSTRAINTS
from .cost import Cost
from .costs import COSTS
from .desired import DesiredPoints, Hold, Proposal
from .problem import Evaluation, GraspProblem
from .state import State
from .task_model import TaskModel

__all__ = [
    "CONSTRAINTS",
    "COSTS",
    "Constraint",
    "Cost",
    "DesiredPoints",
    "Evaluation",
    "GraspProblem",
    "Hold",
    "Inside",
    "Proposal",
    "Residual",
    "State",
    "TaskModel",
    "Violation",
    "check_placement",
    "check_task",
    "file_findings",
]
