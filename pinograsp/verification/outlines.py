"""Where the rubber of a pad touches what it yields to: rectangles in tangent planes, and points all over a pad."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions.patches import CylinderPatch, LinePatch, PlanePatch
from .patches import nearest_on_patch

LEAST_SIDE = 1e-3
"""Half a side that a pad has at least, m: a line without a width bears on some rubber."""


@dataclass(frozen=True)
class Rubber:
    """Where the rubber of a pad touches what it yields to: a rectangle in the pad's tangent plane at a contact, m."""

    origin: Array
    """Of the rectangle's frame, on the pad, shape (3,)."""
    rotation: Array
    """Of the rectangle's frame, shape (3, 3); columns x, y, outward normal."""
    low: Array
    """Least coordinates along x and y, shape (2,)."""
    high: Array
    """Greatest coordinates along x and y, shape (2,)."""
    depth: float
    """By which it yields."""

    def moved(self, rotation: Array, origin: Array) -> Rubber:
        """Return the same in the frame of this pose in its present frame."""
        return replace(self, origin=(self.origin - origin) @ rotation, rotation=rotation.T @ self.rotation)


def rubber_at(patch: Any, point: Array, depth: float) -> Rubber:
    """Return where rubber that yields by a depth touches what is tangent to it at a point; patch frame.

    A flat pad touches with all of its face. In a direction in which a pad of radius R is curved, rubber that is pressed
    in by `depth` touches sqrt(2 R depth) to each side, or less where the patch ends.

    Args:
        patch: the patch's description.
        point: in the patch frame, m, shape (3,).
        depth: m.
    """
    match patch:
        case PlanePatch():
            return _flat(patch.u, patch.v, depth)
        case LinePatch():
            return _flat(patch.u, (-0.5 * patch.width, 0.5 * patch.width), depth)
        case CylinderPatch():
            normal = nearest_on_patch(patch, point)[1]
            around = _pressed(patch.radius, patch.v, math.atan2(normal[1], normal[2]), depth)
            x, along = np.array([1.0, 0.0, 0.0]), patch.u
        case _:
            normal = nearest_on_patch(patch, point)[1]
            first, second = math.atan2(normal[0], normal[2]), math.asin(normal[1])
            x = np.array([math.cos(first), 0.0, -math.sin(first)])
            along = _pressed(patch.radius * math.cos(second), patch.u, first, depth)
            around = _pressed(patch.radius, patch.v, second, depth)
    rotation = np.column_stack([x, np.cross(normal, x), normal])
    low, high = np.transpose([along, around])
    return Rubber(patch.radius * normal, rotation, low, high, depth)


def _flat(u: tuple[float, float], v: tuple[float, float], depth: float) -> Rubber:
    low, high = np.transpose([u, v])
    return Rubber(np.zeros(3), np.eye(3), low, high, depth)


def _pressed(radius: float, interval: tuple[float, float], angle: float, depth: float) -> tuple[float, float]:
    """Return from where to where pressed rubber touches round a curved pad, m from the contact."""
    half = math.sqrt(2.0 * radius * depth)
    if interval[1] - interval[0] >= math.tau - 1e-9:
        return -half, half
    return max(-half, radius * (interval[0] - angle)), min(half, radius * (interval[1] - angle))


def half_sides(patch: Any) -> Array:
    """Return half the sides of a pad along x and y, its radius where it is curved, at least `LEAST_SIDE`; m, (2,)."""
    match patch:
        case PlanePatch():
            sides = 0.5 * (patch.u[1] - patch.u[0]), 0.5 * (patch.v[1] - patch.v[0])
        case LinePatch():
            sides = 0.5 * (patch.u[1] - patch.u[0]), 0.5 * patch.width
        case CylinderPatch():
            sides = 0.5 * (patch.u[1] - patch.u[0]), patch.radius
        case _:
            sides = patch.radius, patch.radius
    return np.maximum(sides, LEAST_SIDE)


def points_of(patch: Any, spacing: float) -> Array:
    """Return points all over a patch, at most a spacing (m) apart along it, its rim included; patch frame, (n, 3)."""
    match patch:
        case PlanePatch():
            u, v = _grid(patch.u, patch.v, spacing, spacing)
            return np.column_stack([u, v, np.zeros(len(u))])
        case LinePatch():
            u, v = _grid(patch.u, (-0.5 * patch.width, 0.5 * patch.width), spacing, spacing)
            return np.column_stack([u, v, np.zeros(len(u))])
        case CylinderPatch():
            u, v = _grid(patch.u, patch.v, spacing, spacing / patch.radius)
            return np.column_stack([u, patch.radius * np.sin(v), patch.radius * np.cos(v)])
        case _:
            u, v = _grid(patch.u, patch.v, spacing / patch.radius, spacing / patch.radius)
            return np.asarray(patch.radius * np.column_stack([np.cos(v) * np.sin(u), np.sin(v), np.cos(v) * np.cos(u)]))


def _grid(u: tuple[float, float], v: tuple[float, float], du: float, dv: float) -> tuple[Array, Array]:
    along = (np.linspace(*ends, 1 + math.ceil((ends[1] - ends[0]) / step)) for ends, step in ((u, du), (v, dv)))
    first, second = np.meshgrid(*along)
    return first.ravel(), second.ravel()
