"""Interface of the shapes: their geometry, the bodies within them that Coal measures, and how contacts are judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ...arrays import Array
from ...descriptions.regions import Region
from ..footprint import footprint
from ..region_depth import least_depth

PENETRATION = 2e-5
"""How deep a link may stick in the object, m: 0.02 mm."""


@dataclass(frozen=True)
class Core:
    """A body inside the shape: the shape without everything nearer than `inset` (m) to its surface."""

    solid: Any
    """Coal geometry, centred like the shape."""
    inset: float


@dataclass(frozen=True)
class Limits:
    """What the figures of contacts allow, which is a matter of how exactly a surface is known."""

    gap: float
    """Distance of a contact point from the surface, m."""
    region: float
    """How far a footprint, or a contact point, may be outside its region, m."""
    margin: float
    """By how much links that are no pads may fall short of their margin, m."""
    yields: bool
    """Whether pads yield by their rubber's depth; else they are tangent to the surface and do not enter it."""


RIGID = Limits(gap=PENETRATION, region=0.0, margin=1e-6, yields=False)
"""Of surfaces that are known by a formula."""


@dataclass(frozen=True)
class Rubber:
    """The rubber at a contact, frame of the body."""

    outline: Array
    """Corners in order of the rectangle of the pad's tangent plane in which its rubber touches, shape (4, 3), m."""
    outward: Array
    """Outward unit normal of the pad, shape (3,)."""
    depth: float
    """By which it yields, m."""


class Geometry(Protocol):
    """A shape in its own frame; points have shape (3,), metres.

    `cores` are tried in turn until one is clear of a mesh: Coal measures meshes only when they are apart.
    """

    cores: tuple[Core, ...]
    hull: Core
    """A convex body; the shape is nowhere farther outside of it than its inset."""
    members: Array
    """A point of every connected part of the shape, shape (parts, 3)."""
    middle: Array
    """Centre of a ball that holds the shape, shape (3,)."""
    limits: Limits

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface, negative inside."""

    def distances(self, points: Array) -> Array:
        """Signed distances of points, shape (n, 3), to the surface, shape (n,)."""

    def surrounds(self, points: Array) -> bool:
        """Whether one of the points, shape (n, 3), is inside where no core would tell."""

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the surface at its point nearest to `point`."""

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""

    def footprint(self, pad_face: Array, point: Array, normal: Array) -> Array:
        """Return the vertices of a footprint, shape (k, 3): a point, the ends of a line, or a polygon in order.

        Args:
            pad_face: the pad's contact face: a point, the ends of a line, or the corners of a convex polygon in order,
                shape (k, 3).
            point: the contact point.
            normal: unit normal of the tangent plane, shape (3,).
        """

    def region_depth(self, region: Region, footprint: Array, rubber: Rubber) -> float:
        """Return how deep the least deep part of the surface that a pad touches is in a region, m.

        Args:
            region: in the shape's frame.
            footprint: of the contact, shape (k, 3).
            rubber: of the contact.
        """

    def edge(self, point: Array) -> float:
        """Distance of `point` from the edges of the face that it lies on; inf if the face has none."""


class ConvexGeometry:
    """What convex shapes with a formula share: their first core is the shape itself, or the shape less its inset."""

    cores: tuple[Core, ...]
    members = np.zeros((1, 3))
    middle = np.zeros(3)
    limits = RIGID

    @property
    def hull(self) -> Core:
        """The first core."""
        return self.cores[0]

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface, negative inside."""
        raise NotImplementedError

    def distances(self, points: Array) -> Array:
        """Signed distances of points, shape (n, 3), to the surface, shape (n,)."""
        return np.array([self.distance(point) for point in points])

    def surrounds(self, points: Array) -> bool:
        """Never: a mesh inside enters the first core."""
        return False

    def face(self, point: Array) -> Array:
        """Part of the surface in the tangent plane at the surface point nearest to `point`.

        A point, the ends of a line, or the corners of a convex polygon in order, shape (k, 3).
        """
        raise NotImplementedError

    def footprint(self, pad_face: Array, point: Array, normal: Array) -> Array:
        """Common part of the contact faces of pad and shape."""
        return footprint(pad_face, self.face(point), point, normal)

    def region_depth(self, region: Region, footprint: Array, rubber: Rubber) -> float:
        """That of the footprint: rigid bodies touch no more."""
        return least_depth(region, footprint)
