"""Pad depth: pads, and what is behind them, are no deeper in an uneven object than their rubber yields.

A row is the least distance of the points of a set, above minus the depth of the rubber, bent as in `clearance`: a
quarter of a pad's face, or a solid behind pads.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...collision.distances import REACH
from ...collision.pairs import PAD_CLEARANCE
from ..constraint import PER_METRE, Descents, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel
from .clearance import bent_rows


class PadDepth(Inside):
    """Distance of pads to the object, above that at which they are as deep in it as they may be, m."""

    name = "pad depth"
    figures: Mapping[str, str] = {PAD_CLEARANCE: "mm"}
    descents: Descents = "clearances"
    scale = PER_METRE
    least = 0.0

    def __init__(self, model: TaskModel) -> None:
        points = model.object_points
        self._first, self._least = points.links, points.least[points.links :]
        self.rows = tuple(f"pad depth of {found.link}, {i + 1}" for i, found in enumerate(points.sets[points.links :]))
        self._links = [f"{found.link} - {model.task.object}" for found in points.sets[points.links :]]

    def inside(self, state: State) -> Residual:
        measured = state.object_distances
        begin = int(np.searchsorted(measured.indices, self._first))
        rows = measured.indices[begin:] - self._first
        above, gradients = measured.values[begin:] - self._least[rows], measured.gradients[begin:]
        return Residual(*bent_rows(above, gradients, rows, len(self.rows), len(state.x), REACH))

    def violations(self, state: State) -> list[Violation]:
        found = self.largest_violation(state, "mm", 1e3, self._links)
        return [Violation(PAD_CLEARANCE, found.value, found.unit, found.where, found.size)]


def pad_depth(model: TaskModel) -> PadDepth | None:
    """Return the constraint, or None if pads are tangent to the object's surface."""
    return PadDepth(model) if model.surface.uneven else None
