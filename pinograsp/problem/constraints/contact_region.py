"""Contact region: every contact point is in the part of the surface where the task lets it be, (14) of the paper."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...geometry.regions import Membership
from ..constraint import PER_METRE, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel


class ContactRegion(Inside):
    """Smooth membership of every contact, m."""

    name = "contact region"
    figures: Mapping[str, str] = {"contact region": "mm"}
    scale = PER_METRE
    least = 2e-6
    """How far inside its region a contact must be, m: the solver's tolerance must not let it out."""

    def __init__(self, model: TaskModel, region: Membership) -> None:
        self._region, self._T_world_object = region, model.T_world_object
        self._pads = [pad.name for pad in model.robot.description.pads]
        self.rows = tuple(f"contact region of {pad}" for pad in self._pads)

    def inside(self, state: State) -> Residual:
        R, origin = self._T_world_object[:3, :3], self._T_world_object[:3, 3]
        values, gradients = self._region((state.contacts.points - origin) @ R)
        return Residual(values, np.matmul((gradients @ R.T)[:, None, :], state.contacts.d_points)[:, 0])

    def violations(self, state: State) -> list[Violation]:
        values = self.inside(state).values
        worst = int(values.argmin())
        outside = max(0.0, 1e3 * float(self.least - values[worst]))
        return [Violation("contact region", outside, "mm", self._pads[worst], size=outside)]


def contact_region(model: TaskModel) -> ContactRegion | None:
    """Return the constraint, or None if the whole surface is allowed, or footprints are to be in a region."""
    if model.region is None or model.task.contact_regions != "point":
        return None
    return ContactRegion(model, model.region)
