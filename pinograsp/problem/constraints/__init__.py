"""The constraints of a grasp, one file each. A new one is a file and a line here."""

from __future__ import annotations

from collections.abc import Callable

from ..constraint import Constraint
from ..task_model import TaskModel
from .approach import approach
from .clearance import Clearance
from .contact_forces import ContactForces
from .contact_gap import ContactGap
from .contact_region import contact_region
from .joint_limits import joint_limits
from .object_clearance import object_clearance
from .pad_clearance import pad_clearance
from .pad_depth import pad_depth
from .pad_tangency import pad_tangency
from .pad_tilt import pad_tilt
from .surface_edge import surface_edge
from .wrench_balance import wrench_balance

CONSTRAINTS: list[Callable[[TaskModel], Constraint | None]] = [
    ContactGap,
    pad_tangency,
    pad_tilt,
    ContactForces,
    wrench_balance,
    contact_region,
    surface_edge,
    approach,
    joint_limits,
    Clearance,
    pad_clearance,
    object_clearance,
    pad_depth,
]
"""Maker of each constraint of a task, in the order of their rows; None where the task does not ask for it."""

__all__ = ["CONSTRAINTS"]
