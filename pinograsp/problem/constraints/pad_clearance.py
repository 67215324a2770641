"""Pad clearance: pads, and what is behind them, keep out of the parts of a compound that they do not touch.

Contact and tangency keep a pad off the part that it touches, and everything of a convex object with it. Of a compound
another part may stand in the way of the pad's rim or of the finger behind it: the handle beside a can. A row is the
least distance of what is behind the pads of a link to one part, bent as in `clearance`. The part that a pad touches,
the one nearest to its contact point, does not count for it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...collision.distances import REACH
from ...collision.pairs import PAD_CLEARANCE
from ..constraint import PER_METRE, Descents, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel
from .clearance import bend


class PadClearance(Inside):
    """Distance of pads and their links to the parts of the object that they do not touch, m."""

    name = PAD_CLEARANCE
    figures: Mapping[str, str] = {PAD_CLEARANCE: "mm"}
    descents: Descents = "clearances"
    scale = PER_METRE
    least = 0.0

    def __init__(self, model: TaskModel) -> None:
        found = model.collisions.pad_pairs
        self._pairs, self._row = found.pairs, found.groups
        self._links = [link for link, _ in found.groups]
        self.rows = tuple(f"pad clearance of {link} to part {part + 1}" for link, part in found.groups)

    def inside(self, state: State) -> Residual:
        measured, touched = state.distances, state.touched_parts
        least, jacobian = np.full(len(self.rows), REACH), np.zeros((len(self.rows), len(state.x)))
        slopes = np.zeros((len(self.rows), measured.gradients.shape[1]))
        for row, index in enumerate(measured.indices.tolist()):
            pair = self._pairs.get(index)
            if pair is None or any(touched[pad] == pair.part for pad in pair.pads):
                continue
            above, group = float(measured.values[row]) - pair.margin, self._row[pair.link, pair.part]
            if above < least[group]:
                least[group], slopes[group] = above, measured.gradients[row]
        values = np.empty(len(self.rows))
        for group, above in enumerate(least.tolist()):
            values[group], slope = bend(above, REACH)
            jacobian[group, : slopes.shape[1]] = slope * slopes[group]
        return Residual(values, jacobian)

    def violations(self, state: State) -> list[Violation]:
        return [self.largest_violation(state, "mm", 1e3, self._links)]


def pad_clearance(model: TaskModel) -> PadClearance | None:
    """Return the constraint, or None if the object is of one part."""
    return PadClearance(model) if model.collisions.pad_pairs.pairs else None
