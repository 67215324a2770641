"""Contact gap: the contact points are on the object's surface, (14), (21), (22)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..constraint import PER_METRE, Constraint, Descents, Kind, Projected, Residual, Violation
from ..state import State
from ..task_model import TaskModel


class ContactGap(Constraint, Projected):
    """Signed distance of every contact point to the surface, zero at a grasp."""

    name = "contact gap"
    kind: Kind = "equality"
    descents: Descents = "every"
    figures: Mapping[str, str] = {"contact gap": "mm"}

    def __init__(self, model: TaskModel) -> None:
        self._pads = [pad.name for pad in model.robot.description.pads]
        self.rows = tuple(f"contact gap of {pad}" for pad in self._pads)

    def gaps(self, state: State) -> Residual:
        """Return the signed distances, m, shape (n,)."""
        distances, normals, _ = state.surface
        return Residual(distances, np.matmul(normals[:, None, :], state.contacts.d_points)[:, 0])

    def residual(self, state: State) -> Residual:
        return self.gaps(state).scaled(PER_METRE)

    def projection(self, state: State, weight: float) -> Residual:
        return self.gaps(state).scaled(weight * PER_METRE)

    def violations(self, state: State) -> list[Violation]:
        gaps = np.abs(state.surface[0])
        worst = int(gaps.argmax())
        return [Violation("contact gap", 1e3 * float(gaps[worst]), "mm", self._pads[worst])]
