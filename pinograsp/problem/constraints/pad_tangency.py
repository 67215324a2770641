"""Pad tangency: pads and surface are tangent and face each other.

Together with a zero gap this is contact without penetration of pad and object: a penetration tolerance t
instead would let the contact slide by sqrt(2 r t). On an uneven surface `pad_tilt` takes its place.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ...arrays import Array
from ..constraint import PER_METRE, Constraint, Descents, Kind, Projected, Residual, Violation
from ..state import State
from ..task_model import TaskModel

PROJECTED = 4.0
"""Weight in the projection, per radian."""


class PadTangency(Constraint, Projected):
    """Sum of the outward normals of pad and surface, zero at a grasp; for small tilts its norm is the angle."""

    name = "pad tangency"
    kind: Kind = "equality"
    descents: Descents = "every"
    figures: Mapping[str, str] = {"pad tangency": "deg"}

    def __init__(self, model: TaskModel) -> None:
        self._pads = [pad.name for pad in model.robot.description.pads]
        self._rho = model.load.rho
        self.rows = tuple(f"pad tangency of {pad}, {axis}" for pad in self._pads for axis in "xyz")

    def sums(self, state: State) -> Residual:
        """Return n_pad + n_object, dimensionless, shape (3 n,)."""
        return tilt_of(state)

    def residual(self, state: State) -> Residual:
        return self.sums(state).scaled(PER_METRE * self._rho)

    def projection(self, state: State, weight: float) -> Residual:
        return self.sums(state).scaled(weight * PROJECTED)

    def violations(self, state: State) -> list[Violation]:
        sums = np.linalg.norm(state.contacts.normals + state.footprint[0], axis=1)
        return [violation_of(state, int(sums.argmax()), self._rho)]

    def independent(self, state: State) -> Array:
        """Return, of the three components of every pad, the two across the surface's normal, shape (2 n, 3 n)."""
        normals = state.footprint[0]
        n = len(normals)
        across = np.zeros((2 * n, 3 * n))
        for i, normal in enumerate(normals):
            _, _, axes = np.linalg.svd(normal[None])
            across[2 * i : 2 * i + 2, 3 * i : 3 * i + 3] = axes[1:]
        return across


def tilt_of(state: State) -> Residual:
    """Return the sums of the outward normals of every pad and of the object as the pad feels it, shape (3 n,)."""
    normals, derivatives = state.footprint
    contacts = state.contacts
    values = contacts.normals + normals
    jacobian = contacts.d_normals + np.matmul(derivatives, contacts.d_points)
    return Residual(values.ravel(), jacobian.reshape(values.size, -1))


def violation_of(state: State, pad: int, rho: float, *, kept: bool = False) -> Violation:
    """Return the tilt of a pad against the object as a violation, 0 if it is no more than it may be."""
    apart = float(np.linalg.norm(state.contacts.normals[pad] + state.footprint[0][pad]))
    tilt = 0.0 if kept else 2.0 * math.asin(min(1.0, 0.5 * apart))
    name = state.model.robot.description.pads[pad].name
    return Violation("pad tangency", math.degrees(tilt), "deg", name, 1e3 * rho * tilt)


def pad_tangency(model: TaskModel) -> PadTangency | None:
    """Return the constraint, or None if the object's surface is uneven."""
    return None if model.surface.uneven else PadTangency(model)
