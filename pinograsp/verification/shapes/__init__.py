"""Geometry of the shapes that a scene file knows: one file a shape, registered in `GEOMETRY`.

A class gives the shape in its own frame; `PlacedShape` puts it into the world. Independent of
`pinograsp.geometry.shapes`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import coal
import numpy as np

from ...arrays import Array
from ...descriptions.bodies import Body
from ...descriptions.regions import Region
from ...descriptions.shapes import (
    Box,
    Capsule,
    Compound,
    Cone,
    Cylinder,
    Ellipsoid,
    Mesh,
    ShapeDescription,
    Sphere,
)
from ..outlines import Rubber
from ..region_depth import least_depth
from .box import BoxGeometry
from .capsule import CapsuleGeometry
from .compound import CompoundGeometry
from .cone import ConeGeometry
from .core import Geometry
from .cylinder import CylinderGeometry
from .ellipsoid import EllipsoidGeometry
from .filled import filled
from .mesh import MeshGeometry
from .sphere import SphereGeometry

GEOMETRY: dict[type[ShapeDescription], Callable[[Any], Geometry]] = {
    Sphere: SphereGeometry,
    Box: BoxGeometry,
    Cylinder: CylinderGeometry,
    Capsule: CapsuleGeometry,
    Cone: ConeGeometry,
    Ellipsoid: EllipsoidGeometry,
    Mesh: MeshGeometry,
    Compound: lambda shape: CompoundGeometry(shape, geometry_of),
}
"""The geometry of each described shape, made from its description. A new shape is registered here."""


def geometry_of(shape: ShapeDescription) -> Geometry:
    """Return the geometry of a described shape."""
    return GEOMETRY[type(shape)](shape)


class PlacedPart:
    """A part of a body, in the world.

    Args:
        name: of the body.
        geometry: of the part.
        pose: of the part's frame, homogeneous, m, shape (4, 4).
    """

    def __init__(self, name: str, geometry: Geometry, pose: Array) -> None:
        self.name = name
        self.cores, self.hull = geometry.cores, geometry.hull
        self._geometry, self._rotation, self._origin = geometry, pose[:3, :3], pose[:3, 3]
        self.center = self._rotation @ geometry.middle + self._origin
        self.radius = geometry.radius_about(geometry.middle)
        """Of a ball about the centre that holds the part, m."""
        self.members = geometry.members @ self._rotation.T + self._origin
        """A point of every connected piece of the part, m, shape (pieces, 3)."""
        self.vertices = geometry.vertices @ self._rotation.T + self._origin
        """Corners of the part, of one without corners a point inside, m, shape (n, 3)."""
        self.placement = coal.Transform3s(self._rotation, self._origin)
        """Pose of the part, for Coal."""

    def surrounds(self, points: Array) -> bool:
        """Whether one of the points, shape (n, 3), m, is inside where no core would tell."""
        return self._geometry.surrounds((points - self._origin) @ self._rotation)


class PlacedShape:
    """A body of the scene with its geometry, in the world."""

    def __init__(self, name: str, body: Body) -> None:
        self.name = name
        self._shape, self._geometry = body.shape, geometry_of(body.shape)
        T = body.pose.matrix
        self._rotation, self.center = T[:3, :3], T[:3, 3]
        self.limits = self._geometry.limits
        self.parts = tuple(PlacedPart(name, geometry, T @ pose) for geometry, pose in self._geometry.parts)
        """Parts, of which a link is as far as from the nearest."""

    def to_object(self, point: Array) -> Array:
        """Transform world points, shape (..., 3), into the frame of the body."""
        return np.asarray((point - self.center) @ self._rotation)

    def to_world(self, point: Array) -> Array:
        """Transform a point of the frame of the body, shape (3,), into the world."""
        return np.asarray(self._rotation @ point + self.center)

    @property
    def centroid(self) -> Array:
        """Centre of mass of the body filled evenly, in its frame, m, shape (3,)."""
        return filled(self._shape, geometry_of).centroid

    def distance(self, point: Array) -> float:
        """Signed distance of a world point, shape (3,), to the surface, m."""
        return self._geometry.distance(self.to_object(point))

    def inward(self, point: Array) -> Array:
        """Inward unit normal in the world at the surface point nearest to a world point, shape (3,)."""
        return np.asarray(self._rotation @ self._geometry.inward(self.to_object(point)))

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about a world point, shape (3,), that holds the shape, m."""
        return self._geometry.radius_about(self.to_object(point))

    def distances(self, points: Array, below: float = math.inf) -> Array:
        """Signed distances of world points, shape (n, 3), to the surface, m, shape (n,).

        Those that are not less than `below` (m) may come as anything that is not less than it.
        """
        return self._geometry.distances(self.to_object(points), below)

    def footprint(self, pad_face: Array, point: Array, normal: Array) -> Array:
        """Return the vertices of a footprint, shape (k, 3): a point, the ends of a line, or a polygon in order; world.

        Args:
            pad_face: the pad's contact face: a point, the ends of a line, or the corners of a convex polygon in order,
                world, shape (k, 3), m.
            point: the contact point, world, shape (3,), m.
            normal: unit normal of the tangent plane, world, shape (3,).
        """
        found = self._geometry.footprint(self.to_object(pad_face), self.to_object(point), normal @ self._rotation)
        return np.asarray(found @ self._rotation.T + self.center)

    def region_depth(self, region: Region, footprint: Array, rubber: Rubber) -> float:
        """Return how deep the least deep part of the surface that a pad touches is in a region, m.

        Args:
            region: in the frame of the body.
            footprint: of the contact, world, shape (k, 3), m.
            rubber: of the contact, world.
        """
        touched = self._geometry.touched(rubber.moved(self._rotation, self.center))
        return least_depth(region, touched if len(touched) else self.to_object(footprint))

    def edge(self, point: Array) -> float:
        """Distance of a world point (3,) from the edges of the face that it lies on, m; inf if it has none."""
        return self._geometry.edge(self.to_object(point))
