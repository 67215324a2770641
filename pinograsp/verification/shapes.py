"""Geometry of the shapes that a scene file knows: one class a shape, registered in `GEOMETRY`.

A class gives the shape in its own frame; `PlacedShape` puts it into the world. Independent of
`pinograsp.geometry.shapes`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import coal
import numpy as np

from ..arrays import Array
from ..descriptions.scene import Body
from ..descriptions.shapes import Box, Capsule, Cone, Cylinder, Ellipsoid, ShapeDescription, Sphere

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
            return _circle(self._radius, math.copysign(self._half, point[2]))
        angle = math.atan2(point[1], point[0])
        x, y = self._radius * math.cos(angle), self._radius * math.sin(angle)
        return np.array([[x, y, -self._half], [x, y, self._half]])

    def edge(self, point: Array) -> float:
        """Distance to the nearer cap's circle."""
        side, cap = self._beyond(point)
        return -min(side, cap)


class CapsuleGeometry:
    """A capsule around z. Its core is a thin rod, so that penetration too is exact down to the axis."""

    def __init__(self, shape: Capsule) -> None:
        self._radius, self._half = float(shape.radius), float(shape.length) / 2
        core = 1e-3 * self._radius
        self.cores: tuple[Core, ...] = (Core(coal.Capsule(core, 2 * self._half), self._radius - core),)

    def _axis_point(self, point: Array) -> Array:
        """Return the nearest point of the rod."""
        return np.array([0.0, 0.0, min(max(float(point[2]), -self._half), self._half)])

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        return float(np.linalg.norm(point - self._axis_point(point))) - self._radius

    def inward(self, point: Array) -> Array:
        """Inward unit normal; not a number on the axis."""
        apart = self._axis_point(point) - point
        length = float(np.linalg.norm(apart))
        return np.asarray(apart / length) if length > 0.0 else np.full(3, np.nan)

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        return math.hypot(math.hypot(point[0], point[1]), abs(float(point[2])) + self._half) + self._radius

    def face(self, point: Array) -> Array:
        """Line along the side between the half balls, or the surface point itself on these."""
        outward = -self._radius * self.inward(point)
        if abs(point[2]) > self._half:
            return np.asarray(self._axis_point(point) + outward)[None]
        return np.array([outward + end * np.array([0.0, 0.0, self._half]) for end in (-1.0, 1.0)])

    def edge(self, point: Array) -> float:
        """Infinite: side and half balls join smoothly."""
        return math.inf


class ConeGeometry:
    """A cone around z, whole or truncated.

    Coal knows none that are truncated: its cores are solids of so many flat sides within it that they are nowhere
    more than `_ARC` away from it.
    """

    def __init__(self, shape: Cone) -> None:
        self._half = float(shape.height) / 2
        self._rims = np.array([[shape.bottom_radius, -self._half], [shape.top_radius, self._half]])
        slope = self._rims[1] - self._rims[0]
        self._length = float(np.linalg.norm(slope))
        self._up = slope / self._length
        self._out = np.array([self._up[1], -self._up[0]])
        cores = [Core(_turned(self._rims), 0.0)]
        inner = self._inset(PENETRATION)
        if inner is not None:
            cores.append(Core(_turned(inner), PENETRATION))
        self.cores = tuple(cores)

    def _inset(self, depth: float) -> Array | None:
        """Return the rims of the cone less what is nearer than `depth` to its surface; None if nothing is left."""
        heights = np.array([-self._half + depth, self._half - depth])
        offset = float(self._out @ self._rims[0]) - depth
        radii = (offset - self._out[1] * heights) / self._out[0]
        if (radii <= 0.0).any():  # towards a tip it ends before
            tip = offset / self._out[1]
            heights, radii = np.where(radii > 0.0, heights, tip), np.maximum(radii, 0.0)
        inner = np.column_stack([radii, heights])
        return inner if radii.max() > 0.0 and heights[0] < heights[1] else None

    def _flat(self, point: Array) -> Array:
        """Return radius and height of a point."""
        return np.array([math.hypot(point[0], point[1]), float(point[2])])

    def _depths(self, point: Array) -> tuple[float, float]:
        """Return how far a point is beyond the side and beyond the nearer end."""
        flat = self._flat(point)
        return float(self._out @ (flat - self._rims[0])), abs(float(flat[1])) - self._half

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        side, end = self._depths(point)
        if side <= 0.0 and end <= 0.0:
            return max(side, end)
        flat, low, high = self._flat(point), [0.0, -self._half], [0.0, self._half]
        pieces = ((low, self._rims[0]), (self._rims[0], self._rims[1]), (self._rims[1], high))
        return min(_from_segment(flat, np.asarray(a), np.asarray(b)) for a, b in pieces)

    def inward(self, point: Array) -> Array:
        """Inward unit normal of side or end, whichever is nearer (farther beyond, at an edge)."""
        side, end = self._depths(point)
        if end > side:
            return np.array([0.0, 0.0, -math.copysign(1.0, point[2])])
        rho = math.hypot(point[0], point[1])
        if rho == 0.0:
            return np.full(3, np.nan)
        return -np.array([self._out[0] * point[0] / rho, self._out[0] * point[1] / rho, self._out[1]])

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""
        flat = self._flat(point)
        return max(math.hypot(flat[0] + radius, flat[1] - height) for radius, height in self._rims)

    def face(self, point: Array) -> Array:
        """Line up the side, or an end as a polygon with its corners on the circle."""
        side, end = self._depths(point)
        if end > side:
            radius, height = self._rims[1 if point[2] > 0.0 else 0]
            return _circle(float(radius), float(height))
        rho = math.hypot(point[0], point[1])
        x, y = point[0] / rho, point[1] / rho
        return np.array([[radius * x, radius * y, height] for radius, height in self._rims])

    def edge(self, point: Array) -> float:
        """Distance from the circle around the end, or, on the side, from the nearer one along it."""
        side, end = self._depths(point)
        flat = self._flat(point)
        if end > side:
            return float(self._rims[1 if point[2] > 0.0 else 0, 0] - flat[0])
        along = float(self._up @ (flat - self._rims[0]))
        return min(along, self._length - along)


class EllipsoidGeometry:
    """An ellipsoid. Its second core holds all of it that is deeper than the penetration that is allowed."""

    def __init__(self, shape: Ellipsoid) -> None:
        self._axes = np.array(shape.semi_axes, dtype=np.float64)
        cores = [Core(coal.Ellipsoid(*self._axes), 0.0)]
        if self._axes.min() > PENETRATION:
            cores.append(Core(coal.Ellipsoid(*(self._axes - PENETRATION)), PENETRATION))
        self.cores = tuple(cores)

    def _nearest(self, point: Array) -> Array:
        """Return the nearest point of the surface, found by bisection of the multiplier.

        With F(t) = sum of (a p / (t + a^2))^2, the largest root of F = 1 is between max(a |p| - a^2) and
        |a p| - min a^2.
        """
        squares, loads = self._axes**2, self._axes * np.maximum(np.abs(point), 1e-9 * self._axes)
        low, high = float((loads - squares).max()), float(np.linalg.norm(loads) - squares.min())
        for _ in range(200):
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
            if ((loads / (middle + squares)) ** 2).sum() > 1.0:
                low = middle
            else:
                high = middle
        there = self._axes * loads / (0.5 * (low + high) + squares)
        return np.asarray(np.copysign(there, point))

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface."""
        apart = float(np.linalg.norm(point - self._nearest(point)))
        return apart if ((point / self._axes) ** 2).sum() > 1.0 else -apart

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the surface at its point nearest to `point`."""
        slope = self._nearest(point) / self._axes**2
        return np.asarray(-slope / np.linalg.norm(slope))

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape; a little more off the origin."""
        return float(self._axes.max() + np.linalg.norm(point))

    def face(self, point: Array) -> Array:
        """Surface point itself."""
        return self._nearest(point)[None]

    def edge(self, point: Array) -> float:
        """Infinite: an ellipsoid has no edges."""
        return math.inf


def _turned(rims: Array) -> Any:
    """Return a cone between two rims (radius, height), shape (2, 2), as a convex solid of flat sides for Coal.

    Its corners have few neighbours each, of which Coal bears 255: ends are cut into zigzags, and a tip is blunt.
    """
    count = len(_circle(float(rims[:, 0].max()), 0.0))
    angles = np.arange(count) * (2 * math.pi / count)
    corners, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for radius, height in rims:
        r = max(float(radius), 0.5 * _ARC)
        corners.extend(list(np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(count, height)])))
    order = [k // 2 if k % 2 == 0 else count - 1 - k // 2 for k in range(count)]
    for k in range(count - 2):
        a, b, c = sorted(order[k : k + 3])
        triangles.append(coal.Triangle(c, b, a))
        triangles.append(coal.Triangle(count + a, count + b, count + c))
    for k in range(count):
        following = (k + 1) % count
        triangles.append(coal.Triangle(k, following, count + following))
        triangles.append(coal.Triangle(k, count + following, count + k))
    return coal.Convex(corners, triangles)


@lru_cache(maxsize=64)
def _circle(radius: float, height: float) -> Array:
    """Return the corners of a polygon on a circle across z, no arc of which bulges more than `_ARC`, shape (n, 3)."""
    count = max(16, math.ceil(math.pi / math.acos(max(0.0, 1.0 - _ARC / radius)))) if radius > 0.0 else 1
    angles = np.arange(count) * (2 * math.pi / count)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(count, height)])


def _from_segment(point: Array, start: Array, end: Array) -> float:
    """Return the distance of a point of the plane from a segment."""
    along = end - start
    share = min(max(float((point - start) @ along) / max(float(along @ along), 1e-300), 0.0), 1.0)
    return float(np.linalg.norm(point - start - share * along))


GEOMETRY: dict[type[ShapeDescription], Callable[[Any], Geometry]] = {
    Sphere: SphereGeometry,
    Box: BoxGeometry,
    Cylinder: CylinderGeometry,
    Capsule: CapsuleGeometry,
    Cone: ConeGeometry,
    Ellipsoid: EllipsoidGeometry,
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
