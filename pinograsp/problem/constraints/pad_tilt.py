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

from ...arrays import Array
from ...compiled import compiled
from ...descriptions.mesh_contact import LARGEST_TILT, TURN
from ...descriptions.patches import SpherePatch
from ...geometry.patches import half_sides
from ...kinematics.pads import Pad
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
        self._steepest = [
            min(STEEPEST, float(slopes[0])) if _round(pad) else STEEPEST
            for pad, slopes in zip(self._pads, self._slopes, strict=True)
        ]
        self.least = min(WITHIN, 0.5 * float(np.min(self._slopes)))
        names = [(pad.description.name, ["1"] if _round(pad) else ["1", "x", "-x", "y", "-y"]) for pad in self._pads]
        self._owners = [pad for pad, (_, sides) in enumerate(names) for _ in sides]
        self.rows = tuple(f"pad tilt of {pad}, {side}" for pad, sides in names for side in sides)

    def inside(self, state: State) -> Residual:
        normals, turning = state.footprint
        contacts, B = state.contacts, state.model.robot.B
        d_normals = np.matmul(turning, contacts.d_points)
        values, jacobian = np.empty(len(self.rows)), np.empty((len(self.rows), len(state.x)))
        row = 0
        for i, pad in enumerate(self._pads):
            count = 1 if _round(pad) else 5
            within_cone(
                normals[i],
                d_normals[i],
                contacts.normals[i],
                contacts.d_normals[i],
                state.configuration.rotations[pad.joint] @ pad.rotation[:, 0],
                contacts.angular[i] @ B,
                self._slopes[i],
                self._steepest[i],
                values[row : row + count],
                jacobian[row : row + count],
            )
            row += count
        return Residual(values, jacobian)

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


@compiled
def within_cone(
    n: Array,
    d_n: Array,
    up: Array,
    d_up: Array,
    x: Array,
    turns: Array,
    slopes: Array,
    steepest: float,
    values: Array,
    jacobian: Array,
) -> None:
    """Write how far a normal is within the cone of a pad, rad-like: the first row, or all five, and derivatives.

    Args:
        n: footprint normal of the object, world, shape (3,).
        d_n: its derivatives, shape (3, v).
        up: normal of the pad, world, shape (3,).
        d_up: its derivatives, shape (3, v).
        x: axis of the pad, world, shape (3,).
        turns: angular velocity of the pad per rate of the posture, which comes first in x, shape (3, p).
        slopes: most of |n_x| and |n_y| in parts of -n_z, shape (2,).
        steepest: most of |n_pad + n|.
        values: rows, shape (1,) or (5,).
        jacobian: their derivatives, shape (1, v) or (5, v).
    """
    apart = n + up
    values[0] = 0.5 * (steepest * steepest - _dot(apart, apart)) / steepest
    for k in range(d_n.shape[1]):
        jacobian[0, k] = -(_dot(apart, d_n[:, k]) + _dot(apart, d_up[:, k])) / steepest
    if len(values) == 1:
        return
    y, facing = _cross(up, x), -_dot(n, up)
    for axis in range(2):
        slope, tilt = slopes[axis], _dot(n, x if axis == 0 else y)
        values[1 + 2 * axis], values[2 + 2 * axis] = slope * facing - tilt, slope * facing + tilt
    for k in range(d_n.shape[1]):
        d_x = _cross(turns[:, k], x) if k < turns.shape[1] else np.zeros(3)
        d_y = _cross(d_up[:, k], x) + _cross(up, d_x)
        d_facing = -_dot(up, d_n[:, k]) - _dot(n, d_up[:, k])
        for axis in range(2):
            slope = slopes[axis]
            d_tilt = _dot(x if axis == 0 else y, d_n[:, k]) + _dot(n, d_x if axis == 0 else d_y)
            jacobian[1 + 2 * axis, k], jacobian[2 + 2 * axis, k] = slope * d_facing - d_tilt, slope * d_facing + d_tilt


@compiled
def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@compiled
def _cross(a: Array, b: Array) -> Array:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def pad_tilt(model: TaskModel) -> PadTilt | None:
    """Return the constraint, or None if pads are tangent to the object's surface."""
    return PadTilt(model) if model.surface.uneven else None
