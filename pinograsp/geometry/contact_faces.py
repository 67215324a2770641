"""Contact faces: the parts of a convex surface that lie in its tangent plane at a point.

Two convex bodies that are tangent at a point touch in the intersection of their contact faces there: the footprint.
A surface that bends in every direction has a spot, one that is ruled a straight line, a flat one an area.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, cross


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
    sharp: bool = True
    """Whether the surface has edges at both ends; if not, it bends on smoothly there."""


@dataclass(frozen=True)
class Flat:
    """A convex polygon."""

    corners: Array
    """Counterclockwise about the outward normal, m, shape (k, 3)."""
    normal: Array
    """Outward unit normal, shape (3,)."""

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


def edge_distance(face: ContactFace, point: Array) -> tuple[float, Array]:
    """Return the distance of a point of the surface from the nearest edge of its contact face, and the gradient.

    A spot has no edge, nor has a line whose ends are smooth: the distance is infinite.
    """
    match face:
        case Ruling(sharp=True):
            return (-face.low, face.direction) if -face.low < face.high else (face.high, -face.direction)
        case Flat():
            room = face.room(point[None])[0]
            nearest = int(room.argmin())
            return float(room[nearest]), face.inward[nearest]
    return float("inf"), np.zeros(3)


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
