"""A compound: all that is in one of several parts.

Outside, the signed distance is the least of those to the parts, which is exact. Inside, it is minus the greatest depth
in a part: exact where one part alone is, and where parts overlap no more than the depth below the compound's surface.
Gradient and Hessian are those of the part that is nearest.

The contact face is that of the nearest part. A straight line ends where it enters another part (`_cut`). A flat face is
left whole: what stands on it keeps pads off itself, as `problem.constraints.pad_clearance` asks, and what ends
flush with it is touched as the face is. Faces that two parts have in one plane, or lines in one line, are not joined.

All of that is for convex parts. A compound with a mesh may stand in the way, but is not grasped (`problem.checks`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...arrays import Array, Indices
from ...descriptions.shapes import Compound, Shape
from ..contact_faces import ContactFace, Ruling, placed
from ..convex_solid import ConvexPiece
from ..tessellation import Tessellation
from .convex import Exact

if TYPE_CHECKING:
    from . import Surface

COVERED = 1e-7
"""How deep in another part a straight line is covered by it, m: less is flush with it."""
STEPS = 40
_CONVERGED = 1e-9
"""Distance from a crossing from which one more step is exact, m."""


@dataclass(frozen=True)
class _Part:
    """A part at its pose in the compound's frame."""

    surface: Surface
    placement: Array

    def local(self, points: Array) -> Array:
        """Return points (n, 3) of the compound's frame in the part's."""
        return np.asarray((points - self.placement[:3, 3]) @ self.placement[:3, :3])

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian at points (n, 3), in the compound's frame."""
        R = self.placement[:3, :3]
        distances, gradients, hessians = self.surface.signed_distance(self.local(points))
        return distances, gradients @ R.T, R @ hessians @ R.T

    def distances(self, points: Array) -> Array:
        """Return the signed distances of points (n, 3) of the compound's frame."""
        return self.surface.signed_distance(self.local(points))[0]

    def contact_face(self, point: Array) -> ContactFace:
        """Return the contact face at a point of the compound's frame, in that frame."""
        return placed(self.surface.contact_face(self.local(point)), self.placement[:3, :3], self.placement[:3, 3])


class CompoundSurface(Exact):
    """Geometry of a compound.

    Args:
        shape: its parts.
        surface_of: gives the geometry of a part.
    """

    def __init__(self, shape: Compound, surface_of: Callable[[Shape], Surface]) -> None:
        self._parts = [_Part(surface_of(part.shape), part.pose.matrix) for part in shape.parts]
        self.least_width = min(part.surface.least_width for part in self._parts)
        self.radius = max(float(np.linalg.norm(p.placement[:3, 3])) + p.surface.radius for p in self._parts)
        self.edged = len(self._parts) > 1 or self._parts[0].surface.edged

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        """Return distance, gradient and Hessian of the nearest part; inside, the distance may be too little."""
        distances, gradients, hessians = (
            np.empty(len(points)),
            np.empty((len(points), 3)),
            np.empty((len(points), 3, 3)),
        )
        nearest = self.nearest_part(points)
        for number in set(nearest.tolist()):
            of_it = nearest == number
            distances[of_it], gradients[of_it], hessians[of_it] = self._parts[number].signed_distance(points[of_it])
        return distances, gradients, hessians

    def nearest_part(self, points: Array) -> Indices:
        """Return the part that each point is nearest to, or deepest in."""
        return np.asarray(self._distances(points).argmin(axis=0))

    def _distances(self, points: Array) -> Array:
        """Return the distances to all parts, shape (parts, n)."""
        return np.array([part.distances(points) for part in self._parts])

    def contact_face(self, point: Array) -> ContactFace:
        """Return the contact face of the nearest part, of a straight line what no other part covers around it."""
        apart = self._distances(point[None])[:, 0]
        own = int(apart.argmin())
        face = self._parts[own].contact_face(point)
        if isinstance(face, Ruling):
            distances, normals, hessians = self._parts[own].signed_distance(point[None])
            foot = point - distances[0] * normals[0]
            # How the foot moves with the point.
            follows = np.eye(3) - np.outer(normals[0], normals[0]) - distances[0] * hessians[0]
            for number, part in enumerate(self._parts):
                # No point of the line is nearer to a part than the foot is, less the way to that point.
                if number != own and apart[number] - abs(distances[0]) <= max(-face.low, face.high):
                    face = _cut(face, foot, follows, part)
        return face

    def extent(self, direction: Array) -> float:
        """Return the largest of what the parts reach."""
        return max(
            float(direction @ p.placement[:3, 3]) + p.surface.extent(p.placement[:3, :3].T @ direction)
            for p in self._parts
        )

    def solids(self) -> tuple[ConvexPiece, ...]:
        """Return the pieces of all parts."""
        return tuple(
            ConvexPiece(piece.geometry, part.placement @ piece.placement, number)
            for number, part in enumerate(self._parts)
            for piece in part.surface.solids()
        )

    def tessellation(self) -> Tessellation:
        """Return the triangles of all parts, without those that are wholly inside another part."""
        vertices, triangles, count = list[Array](), list[Indices](), 0
        for part in self._parts:
            tessellation = part.surface.tessellation()
            corners = tessellation.vertices @ part.placement[:3, :3].T + part.placement[:3, 3]
            others = [other.distances(corners) < -COVERED for other in self._parts if other is not part]
            hidden = [inside[tessellation.triangles].all(axis=1) for inside in others]
            seen = ~np.any(hidden, axis=0) if hidden else slice(None)
            triangles.append(tessellation.triangles[seen] + count)
            vertices.append(corners)
            count += len(corners)
        return Tessellation(np.concatenate(vertices), np.concatenate(triangles))


class _Seen(NamedTuple):
    """A part, seen from a point of a line."""

    t: float
    """Where on the line, m."""
    outside: float
    """How far outside the part, m."""
    slope: float
    """Of that, along the line."""
    normal: Array
    """Gradient there, in the frame of the part, shape (3,)."""


def _cut(face: Ruling, foot: Array, follows: Array, part: _Part) -> Ruling:
    """Return what of a straight line is not in a convex part: up to where it enters it on either side.

    If the point itself is in the part, the line begins or ends where it is out of it, on the nearer side.

    Args:
        face: the line through the foot.
        foot: the surface point that is nearest to the point of the line, m, shape (3,).
        follows: derivative of the foot in the point, shape (3, 3).
        part: another one than the line's.
    """
    start, along = part.local(foot), part.placement[:3, :3].T @ face.direction

    def seen(t: float) -> _Seen:
        distances, normals, _ = part.surface.signed_distance((start + t * along)[None])
        return _Seen(t, float(distances[0]) + COVERED, float(normals[0] @ along), normals[0])

    def crossing(at: _Seen, sign: float, last: float) -> _Seen | None:
        """Return where the line enters the part, from outside it on towards `last`; None if it does not.

        The distance to a convex part is convex along the line: Newton's method never steps beyond the crossing.
        """
        for _ in range(STEPS):
            if sign * at.slope >= 0.0:
                return None
            t = at.t - at.outside / at.slope
            if sign * (t - last) > 0.0:
                return None
            if at.outside <= _CONVERGED:
                return at._replace(t=t)
            at = seen(t)
        return at

    def slope(at: _Seen) -> Array:
        bend = 0.0 if face.bend is None else face.bend
        normal = part.placement[:3, :3] @ at.normal
        return np.asarray(-normal @ (follows + at.t * bend) / at.slope)

    def until(at: _Seen) -> Ruling:
        return replace(face, high=at.t, sharp=(face.sharp[0], True), slopes=(face.slopes[0], slope(at)))

    def since(at: _Seen) -> Ruling:
        return replace(face, low=at.t, sharp=(True, face.sharp[1]), slopes=(slope(at), face.slopes[1]))

    here = seen(0.0)
    if here.outside > 0.0:
        end = crossing(here, 1.0, face.high)
        if end is not None:
            return until(end)
        begin = crossing(here, -1.0, face.low)
        return face if begin is None else since(begin)
    ends = seen(face.low), seen(face.high)
    below = crossing(ends[0], 1.0, 0.0) if ends[0].outside > 0.0 else None
    above = crossing(ends[1], -1.0, 0.0) if ends[1].outside > 0.0 else None
    if above is not None and (below is None or above.t < -below.t):
        return since(above)
    return replace(face, low=0.0, high=0.0, sharp=(True, True)) if below is None else until(below)
