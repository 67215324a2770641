"""Where a point lies on a pad, judged from the point itself: distance to the patch, outward normal, contact face, rim.

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


def contact_face(patch: Any, point: Array) -> Array:
    """Return the part of a patch in its tangent plane where it is nearest to a point; patch frame, shape (k, 3).

    A point (sphere), the ends of a line (cylinder, line without width) or the corners of a rectangle in order, m.
    """
    match patch:
        case PlanePatch():
            return _rectangle(patch.u, patch.v)
        case LinePatch():
            half = 0.5 * patch.width
            return _rectangle(patch.u, (-half, half)) if half > 0.0 else np.array([[end, 0.0, 0.0] for end in patch.u])
        case CylinderPatch():
            offset = patch.radius * nearest_on_patch(patch, point)[1]
            return np.array([[end, offset[1], offset[2]] for end in patch.u])
        case _:
            return np.asarray(patch.radius * nearest_on_patch(patch, point)[1])[None]


def rim_distance(patch: Any, point: Array) -> float:
    """Return how far a point of a patch is from the patch's rim along the surface, m; negative beyond it.

    Of a line with a width the long sides count too; a cylinder or sphere that goes all the way round has no rim there.
    """
    match patch:
        case PlanePatch():
            return min(_within(patch.u, point[0]), _within(patch.v, point[1]))
        case LinePatch():
            across = 0.5 * patch.width - abs(float(point[1])) if patch.width > 0.0 else math.inf
            return min(_within(patch.u, point[0]), across)
        case CylinderPatch():
            around = _within_turn(patch.v, math.atan2(point[1], point[2]))
            return min(_within(patch.u, point[0]), float(patch.radius) * around)
        case _:
            first = math.atan2(point[0], point[2])
            second = math.atan2(point[1], math.hypot(point[0], point[2]))
            around = math.cos(second) * _within_turn(patch.u, first)
            return float(patch.radius) * min(around, _within(patch.v, second))


def heights(patch: Any, points: Array) -> Array:
    """Return how far points are above the surface of a patch continued: a plane, a whole sphere or cylinder, m.

    Args:
        patch: the patch's description.
        points: in the frame that the patch is described in, its link's, m, shape (n, 3).
    """
    local = (points - np.array(patch.origin)) @ patch.rotation
    match patch:
        case CylinderPatch():
            return np.asarray(np.linalg.norm(local[:, 1:], axis=1) - patch.radius)
        case SpherePatch():
            return np.asarray(np.linalg.norm(local, axis=1) - patch.radius)
        case _:
            return np.asarray(local[:, 2])


def _rectangle(u: tuple[float, float], v: tuple[float, float]) -> Array:
    return np.array([[u[0], v[0], 0.0], [u[1], v[0], 0.0], [u[1], v[1], 0.0], [u[0], v[1], 0.0]])


def _within(interval: tuple[float, float], value: float) -> float:
    return float(min(value - interval[0], interval[1] - value))


def _within_turn(interval: tuple[float, float], angle: float) -> float:
    """Return how far an angle is inside an interval, rad; inf if the interval is the whole turn."""
    low, high = interval
    if high - low >= math.tau - 1e-9:
        return math.inf
    return 0.5 * (high - low) - abs(math.remainder(angle - 0.5 * (low + high), math.tau))
