"""Pad tilt: of grasps of an uneven surface within the cone of `constraints.pad_tilt`, less tilted ones are better.

Without it, solutions sit on the border of the cone. The cost is none of U, the paper's, and is not reported as part of
it.
"""

from __future__ import annotations

from ...arrays import Array
from ..constraints.pad_tangency import tilt_of
from ..cost import Cost
from ..state import State
from ..task_model import TaskModel

LEVER = 11.0
"""Of the tilt, mm: about half the side of a pad."""


class PadTilt(Cost):
    """Sum of (LEVER |n_pad + n|)^2 over the pads, mm^2: for small tilts, of the squared way of a pad's rim."""

    name = "pad tilt"

    def value(self, state: State) -> tuple[float, Array]:
        sums, jacobian = tilt_of(state)
        return LEVER**2 * float(sums @ sums), 2.0 * LEVER**2 * (sums @ jacobian)


def pad_tilt(model: TaskModel) -> PadTilt | None:
    """Return the cost, or None if pads are tangent to the object's surface."""
    return PadTilt() if model.surface.uneven else None
