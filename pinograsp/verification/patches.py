"""Where a point lies on a pad, judged from the point itself: distance to the patch and outward normal there.

Written apart from `geometry.patches`, which goes the other way, from contact parameters to points.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions.patches import CylinderPatch, LinePatch, PlanePatch, SpherePatch

UP = np.array([0.0, 0.0, 1.0])


def nearest_on_patch(patch: Any, point: Array) -> tuple[float, Array]:
    """Return the distance of a point to a patch and the outward normal where it is nearest; patch frame.

    Args:
        patch: the patch's description.
        point: in the patch frame (x, y, outward normal), m, shape (3,).
    """
    return _NEAREST[type(patch)](patch, point)


def _flat(patch: PlanePatch | LinePatch, point: Array) -> tuple[float, Array]:
    low, high = zip(*patch.parameters, *[(0.0, 0.0)] * (3 - len(patch.parameters)), strict=True)
    return float(np.linalg.norm(point - np.clip(point, low, high))), UP


def _cylinder(patch: CylinderPatch, point: Array) -> tuple[float, Array]:
    along = min(max(float(point[0]), patch.u[0]), patch.u[1])
    angle = _nearest_angle(math.atan2(point[1], point[2]), patch.v)
    normal = np.array([0.0, math.sin(angle), math.cos(angle)])
    return float(np.linalg.norm(point - patch.radius * normal - [along, 0.0, 0.0])), normal


def _sphere(patch: SpherePatch, point: Array) -> tuple[float, Array]:
    first = _nearest_angle(math.atan2(point[0], point[2]), patch.u)
    outwards = math.sin(first) * point[0] + math.cos(first) * point[2]
    second = _nearest_angle(math.atan2(point[1], outwards), patch.v)
    normal = np.array(
        [math.cos(second) * math.sin(first), math.sin(second), math.cos(second) * math.cos(first)],
    )
    return float(np.linalg.norm(point - patch.radius * normal)), normal


def _nearest_angle(angle: float, interval: tuple[float, float]) -> float:
    """Return the angle, or the end of the interval that is nearest to it round the circle."""
    if interval[0] <= angle <= interval[1]:
        return angle
    return min(interval, key=lambda end: abs(math.remainder(angle - end, math.tau)))


_NEAREST: dict[type, Callable[[Any, Array], tuple[float, Array]]] = {
    PlanePatch: _flat,
    LinePatch: _flat,
    CylinderPatch: _cylinder,
    SpherePatch: _sphere,
}
