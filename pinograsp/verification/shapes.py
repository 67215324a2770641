"""Geometry of the shapes that a scene file knows: one class a shape, registered in `GEOMETRY`.

A class gives the shape in its own frame; `PlacedShape` puts it into the world. Independent of
`pinograsp.models.shapes`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import coal
import numpy as np
from numpy.typing import NDArray

from ..descriptions.scene import Body
from ..descriptions.shapes import Box, Sphere

Array = NDArray[np.float64]

PENETRATION = 2e-5
"""How deep a link may stick in the object, m: 0.02 mm."""


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


class SphereGeometry:
    """A ball. Its core is next to a point, so that penetration too is exact down to the centre."""

    def __init__(self, shape: Sphere) -> None:
        self._radius = float(shape.radius)
        core = 1e-3 * self._radius
        self.cores = (Core(coal.Sphere(core), self._radius - core),)

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


GEOMETRY: dict[type, Any] = {Sphere: SphereGeometry, Box: BoxGeometry}


class PlacedShape:
    """A body of the scene with its geometry, in the world."""

    def __init__(self, name: str, body: Body) -> None:
        self.name = name
        self._geometry: Geometry = GEOMETRY[type(body.shape)](body.shape)
        T = body.pose.matrix
        self._rotation, self.center = T[:3, :3], T[:3, 3]
        self.radius = self._geometry.radius_about(np.zeros(3))
        self.cores = self._geometry.cores
        self.placement = coal.Transform3s(self._rotation, self.center)

    def _local(self, point: Array) -> Array:
        return np.asarray(self._rotation.T @ (point - self.center))

    def distance(self, point: Array) -> float:
        """Signed distance of a world point, shape (3,), to the surface, m."""
        return self._geometry.distance(self._local(point))

    def inward(self, point: Array) -> Array:
        """Inward unit normal in the world at the surface point nearest to a world point, shape (3,)."""
        return np.asarray(self._rotation @ self._geometry.inward(self._local(point)))

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about a world point, shape (3,), that holds the shape, m."""
        return self._geometry.radius_about(self._local(point))
