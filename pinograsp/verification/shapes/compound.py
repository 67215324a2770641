"""A compound: all that is in one of several parts."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ...arrays import Array
from ...descriptions.shapes import Compound, ShapeDescription
from ..outlines import Rubber
from .core import FORMULA, Core, FormulaGeometry, Geometry

COVERED = 1e-7
"""How deep in another part a line of a part's side is covered, m."""
_STEPS, _CLOSE = 300, 1e-9


class CompoundGeometry(FormulaGeometry):
    """Several parts at their poses.

    Outside, distances are exact. Inside, where parts overlap, they are no more than the depth below the surface. A line
    along the side of a part ends where it enters another part; flat faces are not cut.
    """

    cores: tuple[Core, ...] = ()

    def __init__(self, shape: Compound, geometry_of: Callable[[ShapeDescription], Geometry]) -> None:
        self._parts = tuple((geometry_of(part.shape), part.pose.matrix) for part in shape.parts)
        yielding = [geometry.limits for geometry, _ in self._parts if geometry.limits.yields]
        self.limits = yielding[0] if yielding else FORMULA

    @property
    def parts(self) -> tuple[tuple[Geometry, Array], ...]:
        """Parts, each with its pose."""
        return self._parts

    def _local(self, number: int, point: Array) -> Array:
        T = self._parts[number][1]
        return np.asarray((point - T[:3, 3]) @ T[:3, :3])

    def _distance(self, number: int, point: Array) -> float:
        return self._parts[number][0].distance(self._local(number, point))

    def _nearest(self, point: Array) -> int:
        return min(range(len(self._parts)), key=lambda number: self._distance(number, point))

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface, or to the nearest part's where several hold the point."""
        return self._distance(self._nearest(point), point)

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the nearest part."""
        number = self._nearest(point)
        geometry, T = self._parts[number]
        return np.asarray(T[:3, :3] @ geometry.inward(self._local(number, point)))

    def distances(self, points: Array, below: float = math.inf) -> Array:
        """Signed distances of points, shape (n, 3), shape (n,); of those not less than `below`, no more than that."""
        each = [geometry.distances((points - T[:3, 3]) @ T[:3, :3], below) for geometry, T in self._parts]
        return np.asarray(np.min(each, axis=0))

    def footprint(self, pad_face: Array, point: Array, normal: Array) -> Array:
        """Return that of the nearest part, if pads yield to it."""
        number = self._nearest(point)
        geometry, T = self._parts[number]
        if not geometry.limits.yields:
            return super().footprint(pad_face, point, normal)
        found = geometry.footprint(self._local(number, pad_face), self._local(number, point), normal @ T[:3, :3])
        return np.asarray(found @ T[:3, :3].T + T[:3, 3])

    def touched(self, rubber: Rubber) -> Array:
        """Return that of all parts."""
        each = [
            geometry.touched(rubber.moved(T[:3, :3], T[:3, 3])) @ T[:3, :3].T + T[:3, 3] for geometry, T in self._parts
        ]
        return np.concatenate(each)

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds all parts."""
        return max(geometry.radius_about(self._local(i, point)) for i, (geometry, _) in enumerate(self._parts))

    def face(self, point: Array) -> Array:
        """Face of the nearest part; of a line along its side what no other part covers."""
        number = self._nearest(point)
        corners = self._face(number, point)
        if len(corners) != 2:
            return corners
        low, high = self._free(number, point, corners)
        unit = _unit(corners)
        return np.array([corners[0] + low * unit, corners[0] + high * unit])

    def edge(self, point: Array) -> float:
        """Distance from the edges of the nearest part's face, and along a line from where another part covers it."""
        number = self._nearest(point)
        distance = self._parts[number][0].edge(self._local(number, point))
        corners = self._face(number, point)
        if len(corners) == 2:
            at = float(_unit(corners) @ (point - corners[0]))
            low, high = self._free(number, point, corners)
            if low > 0.0:
                distance = min(distance, at - low)
            if high < float(np.linalg.norm(corners[1] - corners[0])):
                distance = min(distance, high - at)
        return distance

    def _face(self, number: int, point: Array) -> Array:
        geometry, T = self._parts[number]
        return np.asarray(geometry.face(self._local(number, point)) @ T[:3, :3].T + T[:3, 3])

    def _free(self, own: int, point: Array, line: Array) -> tuple[float, float]:
        """Return from where to where, m from its start, no other part covers a line, around the point or beside it."""
        unit, length = _unit(line), float(np.linalg.norm(line[1] - line[0]))
        at = min(max(float(unit @ (point - line[0])), 0.0), length)

        def outside(number: int, along: float) -> float:
            return self._distance(number, line[0] + along * unit) + COVERED

        low, high = 0.0, length
        others = [number for number in range(len(self._parts)) if number != own]
        for number in (number for number in others if outside(number, at) <= 0.0):
            # Out of the part, to where that is nearer.
            below, above = (_border(lambda t, n=number: outside(n, t), at, end) for end in (low, high))  # type: ignore[misc]
            if below == low and above == high:
                return at, at
            if above == high or (below != low and at - below <= above - at):
                at = high = below
            else:
                at = low = above
            others.remove(number)
        for number in others:
            low, high = (_border(lambda t, n=number: outside(n, t), at, end) for end in (low, high))  # type: ignore[misc]
        return low, high


def _unit(line: Array) -> Array:
    along = line[1] - line[0]
    return np.asarray(along / np.linalg.norm(along))


def _border(outside: Callable[[float], float], start: float, end: float) -> float:
    """Return where, from `start` on, a line crosses the surface of a convex part; `end` if it does not before.

    No step is longer than the distance to the surface.

    Args:
        outside: signed distance to the part along the line, m.
        start: m along the line.
        end: m along the line.
    """
    at, sign = start, math.copysign(1.0, end - start)
    for _ in range(_STEPS):
        step = abs(outside(at))
        if step < _CLOSE:
            return at
        at += sign * step
        if sign * (at - end) >= 0.0:
            return end
    return at
