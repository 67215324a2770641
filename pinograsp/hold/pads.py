"""Pads as bodies of MuJoCo that end exactly in their patch: one entry a patch, registered in `GEOMS`.

A plane or line patch is the face of a thin box. Contact with it is a point, a line or an area, clipped to patch and
object.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..descriptions.hand import PadDescription, SoftFinger
from ..descriptions.patches import CylinderPatch, LinePatch, PlanePatch, SpherePatch

THICKNESS = 1e-3
"""Of the box behind a flat patch, m."""
_NARROWEST = 1e-3
"""Width of the box behind a line patch without one, m."""


class PadGeom(NamedTuple):
    """A solid in the frame of its patch."""

    kind: str
    """box, sphere or cylinder."""
    size: tuple[float, ...]
    """As MuJoCo has it: half edges; radius; radius and half length, m."""
    center: Array
    """m, shape (3,)."""
    rotation: Array
    """Shape (3, 3)."""


def _plane(patch: PlanePatch) -> PadGeom:
    return _box(patch.u, patch.v)


def _line(patch: LinePatch) -> PadGeom:
    half = max(patch.width, _NARROWEST) / 2
    return _box(patch.u, (-half, half))


def _box(u: tuple[float, float], v: tuple[float, float]) -> PadGeom:
    size = ((u[1] - u[0]) / 2, (v[1] - v[0]) / 2, THICKNESS / 2)
    return PadGeom("box", size, np.array([sum(u) / 2, sum(v) / 2, -THICKNESS / 2]), np.eye(3))


def _sphere(patch: SpherePatch) -> PadGeom:
    return PadGeom("sphere", (patch.radius,), np.zeros(3), np.eye(3))


def _cylinder(patch: CylinderPatch) -> PadGeom:
    along_x = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # its z axis is x of the patch
    size = (patch.radius, (patch.u[1] - patch.u[0]) / 2)
    return PadGeom("cylinder", size, np.array([sum(patch.u) / 2, 0.0, 0.0]), along_x)


GEOMS: dict[type, Callable[[Any], PadGeom]] = {
    PlanePatch: _plane,
    LinePatch: _line,
    SpherePatch: _sphere,
    CylinderPatch: _cylinder,
}
"""The solid of each described patch. A new patch is registered here."""


def pad_geom(pad: PadDescription) -> PadGeom:
    """Return the solid of a pad, in the frame of its patch."""
    return GEOMS[type(pad.patch)](pad.patch)


def is_flat(pad: PadDescription) -> bool:
    """Whether the patch of a pad is a part of a plane."""
    return isinstance(pad.patch, PlanePatch | LinePatch)


def torsional_friction(pad: PadDescription, friction: float) -> float:
    """Return MuJoCo's torsional friction coefficient, m: the greatest spin torque per normal force, mu e."""
    return friction * pad.contact.torsion_radius if isinstance(pad.contact, SoftFinger) else 0.0
