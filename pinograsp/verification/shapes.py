"""Geometry of the shapes that a scene file knows: one class a shape, registered in `GEOMETRY`.

A class gives the shape in its own frame; `PlacedShape` puts it into the world. Independent of
`pinograsp.geometry.shapes`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import coal
import numpy as np

from ..arrays import Array
from ..descriptions.scene import Body
from ..descriptions.shapes import Box, Cylinder, ShapeDescription, Sphere

PENETRATION = 2e-5
"""How deep a link may stick in the object, m: 0.02 mm."""
_ARC = 2e-7
"""How far an arc may bulge out of the polygon that stands for it, m."""
_CORNERS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


@dataclass(frozen=True)
class Core:
    """A body inside the shape: the shape without everything nearer than `inset` (m) to its surface."""

    solid: Any
    """Coal geometry, centred like the shape."""
    inset: float


class Geometry(Protocol):
    """A shape in its own frame; points have shape (3,), metres.

    `cores` are tried in turn until one is clear of a mesh: Coal measures meshes only when they are apart.
    """

    cores: tuple[Core, ...]

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface, negative inside."""

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the surface at its point nearest to `point`."""

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""

    def face(self, point: Array) -> Array:
        """Part of the surface in the tangent plane at the surface point nearest to `point`.

        A point, the ends of a line, or the corners of a convex polygon in order, shape (k, 3).
        """

    def edge(self, point: Array) -> float:
        """Distance of `point` from the edges of the face that it lies on; inf if the face has none."""


class SphereGeometry:
    """A ball. Its core is next to a point, so that penetration too is exact down to the centre."""

    def __init__(self, shape: Sphere) -> None:
        self._radius = float(shape.radius)
        core = 1e-3 * self._radius
        self.cores: tuple[Core, ...] = (Core(coal.Sphere(core), self._radius - core),)

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        return float(np.linalg.norm(point)) - self._radius

    def inward(self, point: Array) -> Array:
        """Inward unit normal; not a number at the centre."""
        length = float(np.linalg.norm(point))
        return -point / length if length > 0.0 else np.full(3, np.nan)

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        return self._radius + float(np.linalg.norm(point))

    def face(self, point: Array) -> Array:
        """Surface point itself."""
        return np.asarray(-self._radius * self.inward(point))[None]

    def edge(self, point: Array) -> float:
        """Infinite: a sphere has no edges."""
        return math.inf


class BoxGeometry:
    """A box. Its second core is the box less the penetration that is allowed."""

    def __init__(self, shape: Box) -> None:
        self._half = np.array(shape.size, dtype=np.float64) / 2
        cores = [Core(coal.Box(*map(float, shape.size)), 0.0)]
        if self._half.min() > PENETRATION:
            inner = 2 * (self._half - PENETRATION)
            cores.append(Core(coal.Box(*map(float, inner)), PENETRATION))
        self.cores = tuple(cores)

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        beyond = np.abs(point) - self._half
        return float(np.linalg.norm(np.maximum(beyond, 0.0)) + min(beyond.max(), 0.0))

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the nearest face (of the face farthest beyond, at an edge)."""
        axis = int(np.argmax(np.abs(point) - self._half))
        normal = np.zeros(3)
        normal[axis] = -1.0 if point[axis] > 0.0 else 1.0
        return normal

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        return float(np.linalg.norm(np.abs(point) + self._half))

    def face(self, point: Array) -> Array:
        """Corners of the side that is nearest (farthest beyond, at an edge)."""
        axis = int(np.argmax(np.abs(point) - self._half))
        corners = np.empty((4, 3))
        corners[:, axis] = math.copysign(self._half[axis], point[axis])
        corners[:, [i for i in range(3) if i != axis]] = _CORNERS * np.delete(self._half, axis)
        return corners

    def edge(self, point: Array) -> float:
        """Distance to the nearest side of the rectangle."""
        beyond = np.abs(point) - self._half
        return float(-np.delete(beyond, int(np.argmax(beyond))).max())


class CylinderGeometry:
    """A cylinder around z. Its second core is the cylinder less the penetration that is allowed."""

    def __init__(self, shape: Cylinder) -> None:
        self._radius, self._half = float(shape.radius), float(shape.height) / 2
        cores = [Core(coal.Cylinder(self._radius, 2 * self._half), 0.0)]
        if min(self._radius, self._half) > PENETRATION:
            inner = coal.Cylinder(self._radius - PENETRATION, 2 * (self._half - PENETRATION))
            cores.append(Core(inner, PENETRATION))
        self.cores = tuple(cores)

    def _beyond(self, point: Array) -> tuple[float, float]:
        """Return how far a point is beyond the side and beyond the nearer cap."""
        return math.hypot(point[0], point[1]) - self._radius, abs(float(point[2])) - self._half

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        side, cap = self._beyond(point)
        return math.hypot(max(side, 0.0), max(cap, 0.0)) + min(max(side, cap), 0.0)

    def inward(self, point: Array) -> Array:
        """Inward unit normal of side or cap, whichever is nearer (farther beyond, at an edge)."""
        side, cap = self._beyond(point)
        if cap > side:
            return np.array([0.0, 0.0, -math.copysign(1.0, point[2])])
        across = np.array([point[0], point[1], 0.0])
        length = float(np.linalg.norm(across))
        return -across / length if length > 0.0 else np.full(3, np.nan)

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        return math.hypot(math.hypot(point[0], point[1]) + self._radius, abs(float(point[2])) + self._half)

    def face(self, point: Array) -> Array:
        """Line along the side from cap to cap, or a cap as a polygon with its corners on the circle."""
        side, cap = self._beyond(point)
        if cap > side:
            return np.column_stack(
                [self._radius * self._circle, np.full(len(self._circle), math.copysign(self._half, point[2]))]
            )
        angle = math.atan2(point[1], point[0])
        x, y = self._radius * math.cos(angle), self._radius * math.sin(angle)
        return np.array([[x, y, -self._half], [x, y, self._half]])

    def edge(self, point: Array) -> float:
        """Distance to the nearer cap's circle."""
        side, cap = self._beyond(point)
        return -min(side, cap)

    @cached_property
    def _circle(self) -> Array:
        """Corners of the unit circle's polygon, as many as keep the bulges of the arcs below `_ARC`, shape (n, 2)."""
        count = max(16, math.ceil(math.pi / math.acos(max(0.0, 1.0 - _ARC / self._radius))))
        angles = np.arange(count) * (2 * math.pi / count)
        return np.column_stack([np.cos(angles), np.sin(angles)])


GEOMETRY: dict[type[ShapeDescription], Callable[[Any], Geometry]] = {
    Sphere: SphereGeometry,
    Box: BoxGeometry,
    Cylinder: CylinderGeometry,
}
"""The geometry of each described shape, made from its description. A new shape is registered here."""


class PlacedShape:
    """A body of the scene with its geometry, in the world."""

    def __init__(self, name: str, body: Body) -> None:
        self.name = name
        self._geometry = GEOMETRY[type(body.shape)](body.shape)
        T = body.pose.matrix
        self._rotation, self.center = T[:3, :3], T[:3, 3]
        self.radius = self._geometry.radius_about(np.zeros(3))
        self.cores = self._geometry.cores
        self.placement = coal.Transform3s(self._rotation, self.center)

    def to_object(self, point: Array) -> Array:
        """Transform world points, shape (..., 3), into the frame of the body."""
        return np.asarray((point - self.center) @ self._rotation)

    def distance(self, point: Array) -> float:
        """Signed distance of a world point, shape (3,), to the surface, m."""
        return self._geometry.distance(self.to_object(point))

    def inward(self, point: Array) -> Array:
        """Inward unit normal in the world at the surface point nearest to a world point, shape (3,)."""
        return np.asarray(self._rotation @ self._geometry.inward(self.to_object(point)))

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about a world point, shape (3,), that holds the shape, m."""
        return self._geometry.radius_about(self.to_object(point))

    def face(self, point: Array) -> Array:
        """Part of the surface in the tangent plane nearest to a world point (3,); world, shape (k, 3), m."""
        return np.asarray(self._geometry.face(self.to_object(point)) @ self._rotation.T + self.center)

    def edge(self, point: Array) -> float:
        """Distance of a world point (3,) from the edges of the face that it lies on, m; inf if it has none."""
        return self._geometry.edge(self.to_object(point))
