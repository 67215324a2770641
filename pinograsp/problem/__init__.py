"""The optimisation problem: variables x = (q_a, sigma, q_c), terms with exact gradients, and their assembly.

    minimise   U(x) = sum_i ||c_desired_i - c_i(x)||^2 + k V*(x)                       (9)-(12)
    subject to bounds on x, contact on the object's surface, clearances, balance       (13)-(16)

The active internal forces y belong to x as the minimiser of the nested problem (8).
"""

from .assembly import UNITS, Evaluation, GraspProblem
from .checks import check_task
from .state import State
from .task_model import TaskModel

__all__ = ["UNITS", "Evaluation", "GraspProblem", "State", "TaskModel", "check_task"]
