"""Surface edge: contact points keep the task's reserve from the edges of the object's surface.

A contact in a surface's tangent plane and on the surface is on its contact face; without a reserve no more is asked.
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
            distance, gradient = edge_distance(state.contact_face(pad), point)
            if distance < self._far:
                values[pad], jacobian[pad] = distance, gradient @ d_point
        return Residual(values, jacobian)

    def violations(self, state: State) -> list[Violation]:
        values = self.inside(state).values
        worst = int(values.argmin())
        missing = max(0.0, 1e3 * float(self.least - values[worst]))
        return [Violation("surface edge", missing, "mm", self._pads[worst], size=missing)]


def surface_edge(model: TaskModel) -> SurfaceEdge | None:
    """Return the constraint, or None if the task asks for no reserve."""
    return SurfaceEdge(model) if model.task.reserve.rim > 0.0 else None
