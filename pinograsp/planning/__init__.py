"""The whole way, from a robot file and a scene file to verified grasps.

`session` is the planner that stays warm, `one_shot` a single plan with it, `attempt` what happens to one start,
`outcomes` what became of all of them, `own_configuration` the check of a posture that the user gives.
"""

from .one_shot import plan
from .outcomes import Progress
from .own_configuration import ConfigurationCheck
from .session import DEFAULT_STARTS, Planner

__all__ = ["DEFAULT_STARTS", "ConfigurationCheck", "Planner", "Progress", "plan"]
