"""Object clearance: links that are no pads keep their margin from an uneven object, which Coal does not measure.

Rows are joined as those of `clearance` are; the pairs are those of a link's solids and the object.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...collision.distances import REACH
from ...collision.object_points import link_points
from ...collision.scene_world import MARGIN_EXCESS
from ...collision.world import CLEARANCES
from ..constraint import PER_METRE, Descents, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel
from .clearance import smooth_minima


class ObjectClearance(Inside):
    """Clearance of every link to the object, m."""

    name = CLEARANCES["target"]
    figures: Mapping[str, str] = {CLEARANCES["target"]: "mm"}
    descents: Descents = "clearances"
    scale = PER_METRE
    least = 0.0

    def __init__(self, model: TaskModel) -> None:
        self._points = link_points(model.robot, model.task.margin.object + MARGIN_EXCESS)
        self._links = [found.link for found in self._points.sets]
        links = list(dict.fromkeys(self._links))
        self.rows = tuple(f"object clearance of {link}" for link in links)
        self._link_of = np.array([links.index(link) for link in self._links], dtype=np.intp)
        self._counts = np.bincount(self._link_of, minlength=len(links))
        self._object = model.task.object

    def inside(self, state: State) -> Residual:
        measured = state.object_distances(self._points)
        above = measured.values - self._points.least[measured.indices]
        links = self._link_of[measured.indices]
        values, slopes = smooth_minima(above, measured.gradients, links, self._counts, REACH)
        jacobian = np.zeros((len(values), len(state.x)))
        jacobian[:, : slopes.shape[1]] = slopes
        return Residual(values, jacobian)

    def violations(self, state: State) -> list[Violation]:
        """Return the violation of the solid that is nearest, if one is near."""
        measured = state.object_distances(self._points)
        if not len(measured.indices):
            return []
        above = measured.values - self._points.least[measured.indices]
        worst = int(above.argmin())
        missing = max(0.0, -1e3 * float(above[worst]))
        link = self._links[int(measured.indices[worst])]
        return [Violation(self.name, missing, "mm", f"{link} - {self._object}", size=missing)]


def object_clearance(model: TaskModel) -> ObjectClearance | None:
    """Return the constraint, or None if Coal measures the distances to the object."""
    return ObjectClearance(model) if model.surface.uneven else None
