"""Surface edge: contact points are on a face of the object's surface, and keep the task's reserve from its edges.

Without a reserve, contact and tangency ask for the same. But a contact that has slid over an edge, where the signed
distance bends round a corner, does not find back from these alone.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...geometry.contact_faces import edge_distance
from ..constraint import PER_METRE, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel

FAR = 0.03
"""Distance that counts as such, m: a surface may have no edge."""


class SurfaceEdge(Inside):
    """Distance of every contact point from the nearest edge of the face that it is on, m."""

    name = "surface edge"
    figures: Mapping[str, str] = {"surface edge": "mm"}
    scale = PER_METRE

    def __init__(self, model: TaskModel) -> None:
        self._pads = [pad.name for pad in model.robot.description.pads]
        self.least = model.task.reserve.rim
        self._far = self.least + FAR
        self.rows = tuple(f"surface edge of {pad}" for pad in self._pads)

    def inside(self, state: State) -> Residual:
        values, jacobian = np.full(len(self.rows), self._far), np.zeros((len(self.rows), len(state.x)))
        for pad, (point, d_point) in enumerate(zip(state.contacts.points, state.contacts.d_points, strict=True)):
            distance, gradient = edge_distance(state.contact_faces[pad], point)
            if distance < self._far:
                values[pad], jacobian[pad] = distance, gradient @ d_point
        return Residual(values, jacobian)

    def violations(self, state: State) -> list[Violation]:
        return [self.largest_violation(state, "mm", 1e3, self._pads)]


def surface_edge(model: TaskModel) -> SurfaceEdge | None:
    """Return the constraint, or None if the object's surface has no edges."""
    return SurfaceEdge(model) if model.surface.edged else None
