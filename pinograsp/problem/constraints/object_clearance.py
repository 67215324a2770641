"""Object clearance: links that are no pads keep their margin from an uneven object, which Coal does not measure.

Rows are joined as those of `clearance` are; the pairs are those of a link's solids and the object.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...arrays import Array, Indices
from ...collision.distances import REACH
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
        points = model.object_points
        self._least = points.least[: points.links]
        self._links = [found.link for found in points.sets[: points.links]]
        links = list(dict.fromkeys(self._links))
        self.rows = tuple(f"object clearance of {link}" for link in links)
        self._link_of = np.array([links.index(link) for link in self._links], dtype=np.intp)
        self._counts = np.bincount(self._link_of, minlength=len(links))
        self._object = model.task.object

    def inside(self, state: State) -> Residual:
        indices, above, gradients = self._measured(state)
        values, slopes = smooth_minima(above, gradients, self._link_of[indices], self._counts, REACH)
        jacobian = np.zeros((len(values), len(state.x)))
        jacobian[:, : slopes.shape[1]] = slopes
        return Residual(values, jacobian)

    def _measured(self, state: State) -> tuple[Indices, Array, Array]:
        """Return the sets of links that were measured, distances above what is wanted of them, m, and gradients."""
        measured = state.object_distances
        count = int(np.searchsorted(measured.indices, len(self._least)))
        indices = measured.indices[:count]
        return indices, measured.values[:count] - self._least[indices], measured.gradients[:count]

    def violations(self, state: State) -> list[Violation]:
        """Return the violation of the solid that is nearest, if one is near."""
        indices, above, _ = self._measured(state)
        if not len(indices):
            return []
        worst = int(above.argmin())
        missing = max(0.0, -1e3 * float(above[worst]))
        link = self._links[int(indices[worst])]
        return [Violation(self.name, missing, "mm", f"{link} - {self._object}", size=missing)]


def object_clearance(model: TaskModel) -> ObjectClearance | None:
    """Return the constraint, or None if Coal measures the distances to the object."""
    return ObjectClearance(model) if model.surface.uneven else None
