"""Geometry of the shapes that a scene file knows: one file a shape, registered in `GEOMETRY`.

A class gives the shape in its own frame; `PlacedShape` puts it into the world. Independent of
`pinograsp.geometry.shapes`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.scene import Body
from ...descriptions.shapes import Box, Capsule, Compound, Cone, Cylinder, Ellipsoid, ShapeDescription, Sphere
from .box import BoxGeometry
from .capsule import CapsuleGeometry
from .compound import CompoundGeometry
from .cone import ConeGeometry
from .core import Core, Geometry
from .cylinder import CylinderGeometry
from .ellipsoid import EllipsoidGeometry
from .sphere import SphereGeometry

GEOMETRY: dict[type[ShapeDescription], Callable[[Any], Geometry]] = {
    Sphere: SphereGeometry,
    Box: BoxGeometry,
    Cylinder: CylinderGeometry,
    Capsule: CapsuleGeometry,
    Cone: ConeGeometry,
    Ellipsoid: EllipsoidGeometry,
    Compound: lambda shape: CompoundGeometry(shape, geometry_of),
}
"""The geometry of each described shape, made from its description. A new shape is registered here."""


def geometry_of(shape: ShapeDescription) -> Geometry:
    """Return the geometry of a described shape."""
    return GEOMETRY[type(shape)](shape)


@dataclass(frozen=True)
class PlacedPart:
    """A convex part of a body, in the world."""

    name: str
    """Of the body."""
    center: Array
    """Origin of the part's frame, m, shape (3,)."""
    radius: float
    """Of a ball about the centre that holds the part, m."""
    cores: tuple[Core, ...]
    placement: Any
    """Pose of the part, for Coal."""


class PlacedShape:
    """A body of the scene with its geometry, in the world."""

    def __init__(self, name: str, body: Body) -> None:
        self.name = name
        self._geometry = geometry_of(body.shape)
        T = body.pose.matrix
        self._rotation, self.center = T[:3, :3], T[:3, 3]
        self.radius = self._geometry.radius_about(np.zeros(3))
        whole = ((self._geometry, np.eye(4)),)
        parts = self._geometry.parts if isinstance(self._geometry, CompoundGeometry) else whole
        self.parts = tuple(self._part(geometry, T @ pose) for geometry, pose in parts)
        """Convex parts, of which a link is as far as from the nearest."""

    def _part(self, geometry: Geometry, pose: Array) -> PlacedPart:
        R, center = pose[:3, :3], pose[:3, 3]
        radius = geometry.radius_about(np.zeros(3))
        return PlacedPart(self.name, center, radius, geometry.cores, coal.Transform3s(R, center))

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
