"""On which side of triangles the inside of a body is, found by few looks.

The winding number is the same at both ends of a way that crosses no triangle. So it is the same all along the front of
a triangle, and all along its back, but for what other triangles part from it (`crossings`), and where no opening of the
surface is near (`openings`). One look beside a place on it, its seat, tells of every point whose foot on it a straight
way leads to from there, clear of what crosses it. Where seats are, and what is seen there, `looks` says.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array, Indices, Integers, Mask
from ..compiled import compiled
from .crossings import Crossings
from .openings import Openings
from .pieces import edges_of

_CORNER = 1e-9
"""Share of a triangle's corner in a foot below which it counts as none."""
_LEVEL = 1e-12
"""Distance from a plane below which a point is on neither side of it, m."""
_UNTOLD, _BACK, _FRONT = 0, 1, 2


class Triangles:
    """Triangles and what is beside them.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        self.vertices, self.faces = vertices, faces
        self.corners = vertices[faces]
        across = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        self.normals = across / np.linalg.norm(across, axis=1)[:, None]
        self.middles = self.corners.mean(axis=1)
        self.beside = neighbours(faces)

    def at(self, shares: Array, numbers: Indices) -> Array:
        """Return places on some of them, shape (n, 3), m.

        Args:
            shares: of their corners, shape (3,) or (n, 3).
            numbers: of the triangles, shape (n,).
        """
        return np.asarray(np.einsum("...k,nkj->nj", shares, self.corners[numbers]))

    @cached_property
    def radii(self) -> Array:
        """Of balls around the middles that hold them, m, shape (f,)."""
        return np.asarray(np.linalg.norm(self.corners - self.middles[:, None], axis=2).max(axis=1))


class Sides:
    """Which sides of triangles are inside.

    Args:
        triangles: of the surface.
        openings: of the surface.
        known: what `looks.seen` returned of them.
    """

    def __init__(self, triangles: Triangles, openings: Openings, known: Mapping[str, Any]) -> None:
        self._triangles, self._openings = triangles, openings
        self._front, self._back, self._clear = (np.asarray(known[name]) for name in ("front", "back", "clear"))
        self._seats = np.asarray(known["seats"])
        starts, others = np.asarray(known["starts"]), np.asarray(known["others"])
        self._crossings = Crossings(triangles.corners, triangles.normals, starts, others)
        self.bounding = np.asarray(known["bounding"])
        """Which have an outside next to them, shape (f,)."""

    def told(self, points: Array, numbers: Indices, feet: Array) -> tuple[Mask, Mask]:
        """Return of which points their triangles tell whether they are inside, and which of these are, shape (n,).

        Args:
            points: shape (n, 3), m.
            numbers: of the triangles that are nearest to them, shape (n,).
            feet: of the points on these, shape (n, 3), m.
        """
        of = self._triangles
        side, owners = _sides(points, numbers, feet, of.corners, of.normals, of.beside, self._clear)
        told = side != _UNTOLD
        told &= ~self._openings.near(np.stack([points, feet], axis=1), np.zeros(len(points)))
        for number in owners:
            told &= self._crossings.free(number, feet, self._seats[number])
        chosen = owners[0]
        return told, told & np.where(side == _FRONT, self._front[chosen], self._back[chosen])


@compiled
def _sides(
    points: Array, numbers: Indices, feet: Array, corners: Array, normals: Array, beside: Indices, clear: Mask
) -> tuple[Integers, Indices]:
    """Return on which side of a triangle points are, shape (n,), which one that is, and the other one at their feet.

    A foot on an edge belongs to the two triangles there: the one whose plane is farther from the point tells.
    """
    side = np.full(len(points), _UNTOLD)
    owners = np.empty((2, len(points)), dtype=np.intp)
    shares, e, f, g = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(len(points)):
        own = numbers[i]
        owners[0, i] = owners[1, i] = own
        ee = ef = ff = eg = fg = 0.0
        for k in range(3):
            e[k], f[k] = corners[own, 1, k] - corners[own, 0, k], corners[own, 2, k] - corners[own, 0, k]
            g[k] = feet[i, k] - corners[own, 0, k]
            ee, ef, ff = ee + e[k] * e[k], ef + e[k] * f[k], ff + f[k] * f[k]
            eg, fg = eg + e[k] * g[k], fg + f[k] * g[k]
        area = ee * ff - ef * ef
        shares[1], shares[2] = (ff * eg - ef * fg) / area, (ee * fg - ef * eg) / area
        shares[0] = 1.0 - shares[1] - shares[2]
        other, missing = own, 0
        for k in range(3):
            if shares[k] < _CORNER:
                other, missing = beside[own, k], missing + 1
        if missing > 1 or other < 0 or not clear[own] or not clear[other]:
            continue
        height = away = 0.0
        for k in range(3):
            height += (points[i, k] - feet[i, k]) * normals[own, k]
            away += (points[i, k] - feet[i, k]) * normals[other, k]
        if abs(height) < abs(away):
            owners[0, i], owners[1, i], height = other, own, away
        else:
            owners[1, i] = other
        if abs(height) > _LEVEL:
            side[i] = _FRONT if height > 0.0 else _BACK
    return side, owners


def neighbours(faces: Integers) -> Indices:
    """Return the triangle at the edge opposite each corner; -1 where there is none or more than one, shape (f, 3)."""
    owner = np.tile(np.arange(len(faces)), 3)
    corner = np.repeat(np.arange(3), len(faces))
    edge = edges_of(np.concatenate([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]]))[1]
    order = edge.argsort(kind="stable")
    count = np.bincount(edge)
    pairs = (count.cumsum() - count)[count == 2]
    beside = np.full((len(faces), 3), -1, dtype=np.intp)
    for one, other in ((order[pairs], order[pairs + 1]), (order[pairs + 1], order[pairs])):
        beside[owner[one], corner[one]] = owner[other]
    return beside
