"""Contact faces: the parts of a surface, convex around them, that lie in its tangent plane at a point.

Two convex bodies that are tangent at a point touch in the intersection of their contact faces there: the footprint.
A surface that bends in every direction has a spot, one that is ruled a straight line, a flat one an area.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Array, cross

NO_EDGE = (math.inf, np.zeros(3))
"""Distance from an edge where there is none, and its gradient."""


@dataclass(frozen=True)
class Spot:
    """The point alone."""


@dataclass(frozen=True)
class Ruling:
    """A straight line through the point."""

    direction: Array
    """Unit vector, shape (3,)."""
    low: float
    """Where it begins, seen from the point along `direction`, m; not positive for a point of the surface."""
    high: float
    """Where it ends, m."""
    bend: Array | None = None
    """Derivative of the direction as the point moves over the surface, 1/m, shape (3, 3); None: it does not turn."""
    sharp: tuple[bool, bool] = (True, True)
    """Whether the surface has edges where it begins and where it ends; if not, it bends on smoothly there."""
    slopes: tuple[Array | None, Array | None] = (None, None)
    """Derivatives of `low` and `high` as the point moves, shape (3,) each; None: that end stays where it is."""

    @property
    def ends(self) -> tuple[tuple[float, Array], tuple[float, Array]]:
        """How far the point is from either end, m, and the derivative of that, shape (3,); infinite if it is smooth."""
        low, high = self.slopes
        return (
            (-self.low, self.direction if low is None else -low) if self.sharp[0] else NO_EDGE,
            (self.high, -self.direction if high is None else high) if self.sharp[1] else NO_EDGE,
        )


@dataclass(frozen=True)
class Flat:
    """A convex polygon."""

    corners: Array
    """Counterclockwise about the outward normal, m, shape (k, 3)."""
    normal: Array
    """Outward unit normal, shape (3,)."""
    radius: float | None = None
    """Of the disc that the polygon is around, m; its edge is that of the surface."""

    @cached_property
    def inward(self) -> Array:
        """Inward unit normals of the edges, edge i from corner i to the next, shape (k, 3)."""
        across = cross(self.normal, np.roll(self.corners, -1, axis=0) - self.corners)
        return np.asarray(across / np.sqrt((across * across).sum(axis=1))[:, None])

    @cached_property
    def offsets(self) -> Array:
        """Of the edges: inward normal . p on them, m, shape (k,)."""
        return np.asarray((self.corners * self.inward).sum(axis=1))

    def room(self, points: Array) -> Array:
        """Return the distances of points from every edge, negative beyond it, m, shape (n, k)."""
        return np.asarray(points @ self.inward.T - self.offsets)


ContactFace = Spot | Ruling | Flat


def placed(face: ContactFace, R: Array, origin: Array) -> ContactFace:
    """Return a contact face in the frame in which its own has rotation R, shape (3, 3), and origin, shape (3,), m."""
    match face:
        case Ruling():
            bend = None if face.bend is None else R @ face.bend @ R.T
            low, high = (None if slope is None else R @ slope for slope in face.slopes)
            return replace(face, direction=R @ face.direction, bend=bend, slopes=(low, high))
        case Flat():
            return Flat(face.corners @ R.T + origin, R @ face.normal, face.radius)
    return face


def edge_distance(face: ContactFace, point: Array) -> tuple[float, Array]:
    """Return the distance of a point of the surface from the nearest edge of its contact face, and the gradient.

    A spot has no edge, nor has a line where it ends smoothly: the distance is infinite.
    """
    match face:
        case Ruling():
            low, high = face.ends
            return low if low[0] < high[0] else high
        case Flat(radius=float(radius)):
            away = point - face.corners.mean(axis=0)
            away = away - (away @ face.normal) * face.normal
            rho = max(float(np.sqrt(away @ away)), np.finfo(float).tiny)
            return radius - rho, -away / rho
        case Flat():
            room = face.room(point[None])[0]
            nearest = int(room.argmin())
            return float(room[nearest]), face.inward[nearest]
    return NO_EDGE


def widest_room(face: ContactFace) -> float:
    """Return how far from the edges of a contact face no point of it is farther, m; infinite without edges."""
    match face:
        case Ruling():
            return 0.5 * (face.high - face.low) if all(face.sharp) else math.inf
        case Flat(radius=float(radius)):
            return radius
        case Flat():  # half of its least width
            return 0.5 * float(face.room(face.corners).max(axis=0).min())
    return math.inf


def clipped(first: Flat, second: Flat) -> Array:
    """Return the corners of the part of a polygon that another one covers, in order; empty if there is none.

    The polygons lie in one plane; what the second has in corners beyond it counts as projected on it.
    """
    corners = first.corners
    for inward, offset in zip(second.inward, second.offsets, strict=True):
        if not len(corners):
            break
        inside = corners @ inward - offset
        kept = []
        for i in range(len(corners)):
            j = (i + 1) % len(corners)
            if inside[i] >= 0.0:
                kept.append(corners[i])
            if (inside[i] > 0.0) != (inside[j] > 0.0) and inside[i] != inside[j]:
                kept.append(corners[i] + inside[i] / (inside[i] - inside[j]) * (corners[j] - corners[i]))
        corners = np.array(kept).reshape(-1, 3)
    return corners
