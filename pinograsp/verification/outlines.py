"""Where the rubber of a pad touches what it yields to: rectangles in tangent planes, and points all over a pad."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions.patches import CylinderPatch, LinePatch, PlanePatch
from .patches import nearest_on_patch


@dataclass(frozen=True)
class Outline:
    """Where the rubber of a pad touches: a rectangle in the pad's tangent plane at a contact; patch frame."""

    origin: Array
    """Of the rectangle's frame, on the pad, m, shape (3,)."""
    rotation: Array
    """Shape (3, 3); columns x, y, outward normal."""
    low: Array
    """Least coordinates along x and y, m, shape (2,)."""
    high: Array
    """Greatest coordinates, shape (2,)."""


def outline(patch: Any, point: Array, depth: float) -> Outline:
    """Return where rubber that yields by a depth touches what is tangent to it at a point.

    A flat pad touches with all of its face. In a direction in which a pad of radius R is curved, rubber that is pressed
    in by `depth` touches sqrt(2 R depth) to each side, or less where the patch ends.

    Args:
        patch: the patch's description.
        point: in the patch frame, m, shape (3,).
        depth: m.
    """
    match patch:
        case PlanePatch():
            return Outline(np.zeros(3), np.eye(3), *np.transpose([patch.u, patch.v]))
        case LinePatch():
            half = 0.5 * patch.width
            return Outline(np.zeros(3), np.eye(3), *np.transpose([patch.u, (-half, half)]))
        case CylinderPatch():
            normal = nearest_on_patch(patch, point)[1]
            around = _pressed(patch.radius, patch.v, math.atan2(normal[1], normal[2]), depth)
            y = np.array([0.0, normal[2], -normal[1]])
            rotation = np.column_stack([[1.0, 0.0, 0.0], y, normal])
            return Outline(patch.radius * normal, rotation, *np.transpose([patch.u, around]))
        case _:
            normal = nearest_on_patch(patch, point)[1]
            first, second = math.atan2(normal[0], normal[2]), math.asin(normal[1])
            x = np.array([math.cos(first), 0.0, -math.sin(first)])
            across = _pressed(patch.radius * math.cos(second), patch.u, first, depth)
            upwards = _pressed(patch.radius, patch.v, second, depth)
            rotation = np.column_stack([x, np.cross(normal, x), normal])
            return Outline(patch.radius * normal, rotation, *np.transpose([across, upwards]))


def _pressed(radius: float, interval: tuple[float, float], angle: float, depth: float) -> tuple[float, float]:
    """Return from where to where pressed rubber touches round a curved pad, m from the contact."""
    half = math.sqrt(2.0 * radius * depth)
    if interval[1] - interval[0] >= math.tau - 1e-9:
        return -half, half
    return max(-half, radius * (interval[0] - angle)), min(half, radius * (interval[1] - angle))


def half_sides(patch: Any, depth: float) -> tuple[float, float]:
    """Return half the sides of the rectangle in which the rubber of a pad touches, along its x and y, m.

    A line without a width has no side across: there it counts as wide as it is long.
    """
    match patch:
        case PlanePatch():
            return 0.5 * (patch.u[1] - patch.u[0]), 0.5 * (patch.v[1] - patch.v[0])
        case LinePatch():
            length = patch.u[1] - patch.u[0]
            return 0.5 * length, 0.5 * (patch.width if patch.width > 0.0 else length)
        case CylinderPatch():
            return 0.5 * (patch.u[1] - patch.u[0]), _half_arc(patch.radius, patch.v, depth)
        case _:
            return _half_arc(patch.radius, patch.u, depth), _half_arc(patch.radius, patch.v, depth)


def _half_arc(radius: float, interval: tuple[float, float], depth: float) -> float:
    return min(0.5 * radius * (interval[1] - interval[0]), math.sqrt(2.0 * radius * depth))


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
            return np.asarray(
                patch.radius * np.column_stack([np.cos(v) * np.sin(u), np.sin(v), np.cos(v) * np.cos(u)])
            )


def _grid(u: tuple[float, float], v: tuple[float, float], du: float, dv: float) -> tuple[Array, Array]:
    along = (np.linspace(*ends, 1 + math.ceil((ends[1] - ends[0]) / step)) for ends, step in ((u, du), (v, dv)))
    first, second = np.meshgrid(*along)
    return first.ravel(), second.ravel()
