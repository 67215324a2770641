"""Interface of the shapes: their geometry, the bodies within them that Coal measures, and how contacts are judged."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ...arrays import Array
from ..footprint import footprint
from ..outlines import Rubber

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
    turn: float
    """How far a normal may be off, rad."""
    yields: bool
    """Whether pads yield by their rubber's depth; else they are tangent to the surface and do not enter it."""


FORMULA = Limits(gap=PENETRATION, region=0.0, margin=1e-6, turn=0.0, yields=False)
"""Of surfaces that are known by a formula."""


class Geometry(Protocol):
    """A shape in its own frame; points have shape (3,), metres.

    `cores` are tried in turn until one is clear of a mesh: Coal measures meshes only when they are apart.
    """

    cores: tuple[Core, ...]
    members: Array
    """A point of every connected part of the shape, shape (parts, 3)."""
    vertices: Array
    """Corners of the surface, of one without corners a point inside, shape (n, 3)."""
    middle: Array
    """Centre of a ball that holds the shape, shape (3,)."""
    limits: Limits

    @property
    def parts(self) -> tuple[tuple[Geometry, Array], ...]:
        """Parts of a compound, of another shape itself, each with its pose in the frame of the shape, shape (4, 4)."""

    @property
    def hull(self) -> Core:
        """A convex body; the shape is nowhere farther outside of it than its inset."""

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface, negative inside."""

    def distances(self, points: Array, below: float = math.inf) -> Array:
        """Signed distances of points, shape (n, 3), to the surface, shape (n,).

        Those that are not less than `below` (m) may come as anything that is not less than it.
        """

    def surrounds(self, points: Array) -> bool:
        """Whether one of the points, shape (n, 3), is inside where no core would tell."""

    def inward(self, point: Array) -> Array:
        """Inward unit normal of the surface at its point nearest to `point`."""

    def radius_about(self, point: Array) -> float:
        """Radius of the least ball about `point` that holds the shape."""

    def face(self, point: Array) -> Array:
        """Part of the surface in the tangent plane at the surface point nearest to `point`.

        A point, the ends of a line, or the corners of a convex polygon in order, shape (k, 3).
        """

    def footprint(self, pad_face: Array, point: Array, normal: Array) -> Array:
        """Return the vertices of a footprint, shape (k, 3): a point, the ends of a line, or a polygon in order.

        Args:
            pad_face: the pad's contact face: a point, the ends of a line, or the corners of a convex polygon in order,
                shape (k, 3).
            point: the contact point.
            normal: unit normal of the tangent plane, shape (3,).
        """

    def touched(self, rubber: Rubber) -> Array:
        """Return what of the surface rubber touches as it yields, as triangles, shape (n, 3, 3).

        None of them if pads do not yield: they touch the footprint and no more.
        """

    def edge(self, point: Array) -> float:
        """Distance of `point` from the edges of the face that it lies on; inf if the face has none."""


class FormulaGeometry:
    """What shapes with a formula share, and compounds unless they say otherwise.

    The first core of a shape of one part is the shape itself, or the shape less its inset.
    """

    cores: tuple[Core, ...]
    members: Array = np.zeros((1, 3))
    vertices: Array = np.zeros((1, 3))
    middle: Array = np.zeros(3)
    limits: Limits = FORMULA

    @property
    def parts(self: Geometry) -> tuple[tuple[Geometry, Array], ...]:
        """The shape itself."""
        return ((self, np.eye(4)),)

    @property
    def hull(self) -> Core:
        """The first core."""
        return self.cores[0]

    def distance(self, point: Array) -> float:
        """Signed distance of a point to the surface, negative inside."""
        raise NotImplementedError

    def distances(self, points: Array, below: float = math.inf) -> Array:
        """Signed distances of points, shape (n, 3), to the surface, shape (n,), all of them as they are."""
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
        """Return the common part of the contact faces of pad and shape."""
        return footprint(pad_face, self.face(point), point, normal)

    def touched(self, rubber: Rubber) -> Array:
        """Return nothing: pads do not yield."""
        return np.zeros((0, 3, 3))
