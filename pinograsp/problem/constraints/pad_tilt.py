"""Pad tilt: pads lie on the mean of an uneven surface up to what their rubber evens out.

With the depth delta of the rubber and half sides a along x and b along y of a pad, the outward footprint normal n of
the object, in the pad's frame (x, y, outward), keeps

    |n_x| <= -(delta / a) n_z,    |n_y| <= -(delta / b) n_z

which are four linear inequalities, and which only a normal that faces the pad can keep: n_z < 0. On a curved pad the
frame is that of the contact: x along a cylinder, y around it. In no direction is the tilt more than an angle either:

    |n_pad + n| <= STEEPEST

On a ball, around which no direction is special, |n_pad + n| <= delta / radius besides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ...arrays import Array, cross
from ...descriptions.mesh_contact import LARGEST_TILT, TURN
from ...descriptions.patches import SpherePatch
from ...geometry.patches import half_sides
from ...kinematics.robot import Pad
from ..constraint import PER_METRE, Descents, Inside, Residual, Violation
from ..state import State
from ..task_model import TaskModel
from .pad_tangency import PROJECTED, tilt_of, violation_of

WITHIN = 0.005
"""How far inside its cone a normal must be, rad: the check finds the normal in another way."""
STEEPEST = 2.0 * math.sin(0.5 * (LARGEST_TILT - TURN))
"""Largest sum of the normals of pad and object, of which the check may find as much more as two ways may differ by."""


class PadTilt(Inside):
    """How far the footprint normal is within its cone, rad-like."""

    name = "pad tangency"
    figures: Mapping[str, str] = {"pad tangency": "deg"}
    descents: Descents = "every"

    def __init__(self, model: TaskModel) -> None:
        self._pads = model.robot.pads
        self._rho = model.load.rho
        self.scale = PER_METRE * self._rho
        self._slopes = [pad.description.rubber_depth / half_sides(pad.patch) for pad in self._pads]
        self.least = min(WITHIN, 0.5 * float(np.min(self._slopes)))
        names = [(pad.description.name, ["1"] if _round(pad) else ["1", "x", "-x", "y", "-y"]) for pad in self._pads]
        self._owners = [pad for pad, (_, sides) in enumerate(names) for _ in sides]
        self.rows = tuple(f"pad tilt of {pad}, {side}" for pad, sides in names for side in sides)

    def inside(self, state: State) -> Residual:
        values, jacobian = np.empty(len(self.rows)), np.empty((len(self.rows), len(state.x)))
        normals, turning = state.footprint
        contacts, row = state.contacts, 0
        for i, pad in enumerate(self._pads):
            n, d_n = normals[i], turning[i] @ contacts.d_points[i]
            up, d_up = contacts.normals[i], contacts.d_normals[i]
            steepest = min(STEEPEST, float(self._slopes[i][0])) if _round(pad) else STEEPEST
            apart = n + up
            values[row] = 0.5 * (steepest * steepest - apart @ apart) / steepest
            jacobian[row] = -(apart @ (d_n + d_up)) / steepest
            row += 1
            if _round(pad):
                continue
            facing, d_facing = -(n @ up), -(up @ d_n + n @ d_up)
            x, d_x = self._axis(state, pad)
            y, d_y = cross(up, x), cross(d_up.T, x).T - cross(d_x.T, up).T
            for slope, axis, d_axis in zip(self._slopes[i], (x, y), (d_x, d_y), strict=True):
                tilt, d_tilt = n @ axis, axis @ d_n + n @ d_axis
                values[row], jacobian[row] = slope * facing - tilt, slope * d_facing - d_tilt
                values[row + 1], jacobian[row + 1] = slope * facing + tilt, slope * d_facing + d_tilt
                row += 2
        return Residual(values, jacobian)

    def _axis(self, state: State, pad: Pad) -> tuple[Array, Array]:
        """Return the x axis of a patch, world, and its derivative in x, shape (3, v)."""
        robot, configuration = state.model.robot, state.configuration
        x = configuration.rotations[pad.joint] @ pad.rotation[:, 0]
        rates = (configuration.jacobian[3:] * robot.supports[pad.joint]) @ robot.B
        d_x = np.zeros((3, len(state.x)))
        d_x[:, : rates.shape[1]] = cross(rates.T, x).T
        return x, d_x

    def projection(self, state: State, weight: float) -> Residual:
        """Return n_pad + n: starts are led to the middle of the cone."""
        return tilt_of(state).scaled(weight * PROJECTED)

    def violations(self, state: State) -> list[Violation]:
        """Return the tilt of the pad that is worst, if it is outside its cone."""
        above = self.inside(state).values
        worst = self._owners[int(above.argmin())]
        return [violation_of(state, worst, self._rho, kept=bool(above.min() >= self.least - 1e-6))]


def _round(pad: Pad) -> bool:
    return isinstance(pad.patch, SpherePatch)


def pad_tilt(model: TaskModel) -> PadTilt | None:
    """Return the constraint, or None if pads are tangent to the object's surface."""
    return PadTilt(model) if model.surface.uneven else None
