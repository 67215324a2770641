"""The surfaces of pads as functions of their contact parameters, in the patch frame (x, y, outward normal).

A patch gives the contact point c(u, v) and the normal there, with their derivatives, how far points stand above it, and
how large its face is. `descriptions.patches` says what u and v are.
"""

from __future__ import annotations

import math
from functools import singledispatch
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..descriptions.patches import CylinderPatch, LinePatch, Patch, PlanePatch, SpherePatch

SMALLEST = 0.001
"""Half side that a pad has at least, m: a line has some rubber beside it."""


class PatchPoint(NamedTuple):
    """A point of a patch, patch frame; k contact parameters."""

    point: Array
    """m, shape (3,)."""
    normal: Array
    """Outward unit normal, shape (3,)."""
    d_point: Array
    """Shape (3, k)."""
    d_normal: Array
    """Shape (3, k)."""


@singledispatch
def patch_point(patch: object, parameters: Array) -> PatchPoint:
    """Return the point at contact parameters, shape (k,)."""
    raise NotImplementedError(type(patch).__name__)


@singledispatch
def above(patch: object, points: Array) -> Array:
    """Return how far points, patch frame, shape (n, 3), stand out of the patch's surface continued, m, shape (n,)."""
    raise NotImplementedError(type(patch).__name__)


def inside_rim(patch: Patch, reserve: float) -> Array:
    """Return the ranges of the contact parameters of points that keep a distance from the patch's rim, shape (k, 2).

    Distances are along the surface, m. On a sphere the range of u is that of the v where it is narrowest. Parameters
    that go all the way round have no rim. A range is empty, its ends in the wrong order, if the patch is too small; so
    is one of a line whose face is.
    """
    limits = np.array(patch.parameters)
    lengths = np.ones(len(limits))
    if isinstance(patch, LinePatch) and 0.0 < patch.width < 2.0 * reserve:
        return limits[:, ::-1]
    if isinstance(patch, CylinderPatch):
        lengths[1] = patch.radius
    if isinstance(patch, SpherePatch):
        steepest = float(np.abs(limits[1]).max()) - reserve / patch.radius
        lengths[:] = patch.radius * math.cos(max(steepest, 0.0)), patch.radius
    closed = isinstance(patch, CylinderPatch | SpherePatch) & (limits[:, 1] - limits[:, 0] >= math.tau - 1e-9)
    step = np.where(closed, 0.0, reserve / lengths)
    return np.asarray(limits + step[:, None] * [1.0, -1.0])


def rectangle(patch: PlanePatch | LinePatch) -> Array:
    """Return the ranges of a flat patch along x and y of its frame, m, shape (2, 2)."""
    across = patch.v if isinstance(patch, PlanePatch) else (-0.5 * patch.width, 0.5 * patch.width)
    return np.array([patch.u, across])


def half_sides(patch: Patch) -> Array:
    """Return half the sides of a patch along x and y, those of curved ones their radius, m, shape (2,)."""
    first, second = patch.parameters[0], patch.parameters[-1]
    along = 0.5 * (first[1] - first[0])
    if isinstance(patch, SpherePatch):
        sides = (patch.radius, patch.radius)
    elif isinstance(patch, CylinderPatch):
        sides = (along, patch.radius)
    else:
        sides = (along, 0.5 * (patch.width if isinstance(patch, LinePatch) else second[1] - second[0]))
    return np.maximum(sides, SMALLEST)


def face_ranges(patch: Patch) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the ranges of two parameters that span the face of a patch, each with metres a unit."""
    if isinstance(patch, LinePatch):
        return (*patch.u, 1.0), (-0.5 * patch.width, 0.5 * patch.width, 1.0)
    if isinstance(patch, PlanePatch):
        return (*patch.u, 1.0), (*patch.v, 1.0)
    if isinstance(patch, CylinderPatch):
        return (*patch.u, 1.0), (*patch.v, patch.radius)
    return (*patch.u, patch.radius), (*patch.v, patch.radius)


def face_point(patch: Patch, u: float, v: float) -> Array:
    """Return the point of the face at these parameters, patch frame, m, shape (3,)."""
    if isinstance(patch, LinePatch):
        return np.array([u, v, 0.0])
    return patch_point(patch, np.array([u, v])).point


def face_normal(patch: Patch, u: float, v: float) -> Array:
    """Return the outward unit normal of the face at these parameters, patch frame, shape (3,)."""
    return _UP if isinstance(patch, LinePatch) else patch_point(patch, np.array([u, v])).normal


_UP = np.array([0.0, 0.0, 1.0])
_ALONG = np.eye(3)
_STRAIGHT = np.zeros((3, 2))


@patch_point.register
def _(patch: PlanePatch, parameters: Array) -> PatchPoint:
    u, v = parameters
    return PatchPoint(np.array([u, v, 0.0]), _UP, _ALONG[:, :2], _STRAIGHT)


@patch_point.register
def _(patch: LinePatch, parameters: Array) -> PatchPoint:
    return PatchPoint(np.array([parameters[0], 0.0, 0.0]), _UP, _ALONG[:, :1], _STRAIGHT[:, :1])


@patch_point.register
def _(patch: CylinderPatch, parameters: Array) -> PatchPoint:
    u, (s, c) = parameters[0], _sin_cos(parameters[1])
    normal = np.array([0.0, s, c])
    d_normal = np.column_stack([np.zeros(3), [0.0, c, -s]])
    d_point = patch.radius * d_normal
    d_point[0, 0] = 1.0
    point = patch.radius * normal
    point[0] = u
    return PatchPoint(point, normal, d_point, d_normal)


@patch_point.register
def _(patch: SpherePatch, parameters: Array) -> PatchPoint:
    (su, cu), (sv, cv) = _sin_cos(parameters[0]), _sin_cos(parameters[1])
    normal = np.array([cv * su, sv, cv * cu])
    d_normal = np.column_stack([[cv * cu, 0.0, -cv * su], [-sv * su, cv, -sv * cu]])
    return PatchPoint(patch.radius * normal, normal, patch.radius * d_normal, d_normal)


@above.register(PlanePatch)
@above.register(LinePatch)
def _(patch: PlanePatch | LinePatch, points: Array) -> Array:
    return points[:, 2]


@above.register
def _(patch: CylinderPatch, points: Array) -> Array:
    return np.asarray(np.hypot(points[:, 1], points[:, 2]) - patch.radius)


@above.register
def _(patch: SpherePatch, points: Array) -> Array:
    return np.asarray(np.linalg.norm(points, axis=1) - patch.radius)


def _sin_cos(angle: float) -> tuple[float, float]:
    return math.sin(angle), math.cos(angle)
