"""The parts of the cost U, one file each. A new one is a file and a line here."""

from __future__ import annotations

from collections.abc import Callable

from ..cost import Cost
from ..task_model import TaskModel
from .desired_contacts import desired_contacts
from .force_cost import ForceCost
from .pad_tilt import pad_tilt

COSTS: list[Callable[[TaskModel], Cost | None]] = [
    desired_contacts,
    ForceCost,
    pad_tilt,
]
"""Maker of each cost of a task, in the order of their sum; None where the task does not ask for it."""

__all__ = ["COSTS"]
