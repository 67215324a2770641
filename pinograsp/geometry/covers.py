"""Few convex pieces that together contain a mesh and stand off it as little as their number allows.

The surface is cut by a plane, every triangle that crosses it clipped exactly there; the parts may be cut again. A
piece is the convex hull of a part, that is of the surface T_k within the cell of space that its planes bound, and of
those corners of the cell that are in the solid which the surface encloses.

The pieces contain the surface, every point of which is in some T_k. They also contain the solid: what of it is in
a cell lies in the hull of its own boundary, that is of T_k and the sections of the solid by the planes; a section
lies in the hull of its boundary, that is of points of T_k and of segments along edges of the cell; and a segment
lies between its ends, which are points of T_k or corners of the cell in the solid. (Two planes have no corners; the
octants of a ball show that from three planes on they are needed.) Approximate decompositions as of V-HACD and CoACD
promise neither.

Pieces lie on different sides of some plane, so that none contains another.

Cuts are made one after the other in the part with the largest excess: the integral of the squared distance to the
mesh over that part's share of the outer boundary of all pieces. (A volume would count the hollow inside a shell.) The
plane is sought among 9 directions in three places each and then by a pattern search, on clustered vertices and on
hulls of the few vertices that are farthest along fixed directions. Such estimates decide where to cut, never what the
pieces are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree
from threadpoolctl import threadpool_limits

from ..arrays import Array, Indices
from .convex_solid import solid_corners, thickened
from .few_corners import corners_around, fan
from .hulls import FlatError, Hull, areas, boundary, spread
from .mesh_surface import MeshSurface
from .triangle_mesh import winding_number

_NO_AREA = 1e-12
"""Area of a mesh below which it is a line or a point, as a share of its squared extent."""
VERSION = 7
"""Of the algorithm; to be raised with every change that gives other pieces."""

MOST_CORNERS = 4000
"""Corners of a hull; one of more, as of a fine ball, gives way to a polyhedron around it."""
_MANY = 300_000
"""More points than these are not all given to Qhull, whose memory grows with the corners."""
_COARSE, _FINE = 128, 256
"""Directions of the polyhedron around many points, and around a hull of many corners."""
_SURFACE_SAMPLES = 8000
_EXCESS_SAMPLES = 1000
_TRIAL_SAMPLES = 150
_CELLS = 64
"""Cells along the diagonal of a part in each of which its vertices become one, for the search."""
_PLACES = 3
_PATTERN_STEPS = 7


class _Plane(NamedTuple):
    normal: Array
    """Unit vector, shape (3,)."""
    offset: float
    """normal . p of the plane's points, m. A part is where normal . p <= offset."""


@dataclass(frozen=True)
class _Part:
    triangles: Array
    """Shape (n, 3, 3)."""
    planes: tuple[_Plane, ...]
    hull: Hull


def cover(triangles: Array, pieces: int, tolerance: float) -> list[Array]:
    """Return the vertices of convex pieces, each of shape (k, 3), that together contain a mesh.

    They are such that Coal makes solids of them. A sheet, a mesh in one plane, is one piece as thin as such a solid can
    be: it is in the way, too, on both of its sides.

    Args:
        triangles: of the mesh, shape (n, 3, 3), m.
        pieces: their largest number; 1 gives the convex hull.
        tolerance: a piece is not cut if 95 % of its share of the outer boundary is this near to the mesh, m.

    Raises:
        FlatError: the mesh has no area: it is a line or a point.
    """
    points = triangles.reshape(-1, 3)
    try:
        whole = _Part(triangles, (), _hull(points))
    except FlatError:
        across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])  # `areas` err here
        if np.linalg.norm(across, axis=1).sum() <= _NO_AREA * float(np.ptp(points, axis=0).max()) ** 2:
            raise
        return [solid_corners(_hull(thickened(points)).vertices)]
    if pieces == 1:
        return [solid_corners(whole.hull.vertices)]
    parts = [whole]
    surface = MeshSurface(triangles)
    samples = cKDTree(spread(triangles, areas(triangles), _SURFACE_SAMPLES))
    # Threads cost more than they give on matrices as small as those of the search.
    with threadpool_limits(1):
        while len(parts) < pieces:
            worst = _worst(parts, surface, tolerance)
            if worst is None:
                break
            others = [part.hull for k, part in enumerate(parts) if k != worst]
            plane = _best_plane(_Trial(parts[worst].triangles, others, samples))
            try:
                parts[worst : worst + 1] = _cut(parts[worst], plane, whole)
            except FlatError:
                break
    return [solid_corners(part.hull.vertices) for part in parts]


def _hull(points: Array) -> Hull:
    """Return the hull of points, shape (n, 3), or of few corners around them."""
    hull = Hull(points if len(points) <= _MANY else corners_around(points, _COARSE))
    return hull if len(hull.vertices) <= MOST_CORNERS else Hull(corners_around(hull.vertices, _FINE))


def _worst(parts: Sequence[_Part], surface: MeshSurface, tolerance: float) -> int | None:
    """Return the part with the largest excess of those that exceed the tolerance."""
    points, owners = boundary([part.hull for part in parts], _EXCESS_SAMPLES)
    distances = surface.distances(points)
    excesses = [distances[owners == k] for k in range(len(parts))]
    sums = [float(np.square(d).sum()) if len(d) and np.percentile(d, 95) > tolerance else 0.0 for d in excesses]
    return int(np.argmax(sums)) if max(sums) > 0.0 else None


def _cut(part: _Part, plane: _Plane, whole: _Part) -> list[_Part]:
    below, above = clip(part.triangles, *plane)
    opposite = _Plane(-plane.normal, -plane.offset)
    return [_part(below, (*part.planes, plane), whole), _part(above, (*part.planes, opposite), whole)]


def _part(triangles: Array, planes: tuple[_Plane, ...], whole: _Part) -> _Part:
    corners = np.reshape(_corners(planes), (-1, 3))
    near = corners[whole.hull.holds(corners)]  # of what is outside the hull, no winding number need be found
    inside = [corner for corner in near if abs(winding_number(whole.triangles, corner)) > 0.5]
    return _Part(triangles, planes, _hull(np.concatenate([triangles.reshape(-1, 3), np.reshape(inside, (-1, 3))])))


def clip(triangles: Array, normal: Array, offset: float) -> tuple[Array, Array]:
    """Cut triangles by a plane.

    Args:
        triangles: shape (n, 3, 3).
        normal: of the plane, shape (3,).
        offset: normal . p of its points.

    Returns:
        Triangles where normal . p is at most and at least the offset, shapes (m, 3, 3).
    """
    heights = triangles @ normal - offset
    below, above = (heights <= 0.0).all(axis=1), (heights >= 0.0).all(axis=1)
    crossing = ~(below | above)
    crossed, h = triangles[crossing], heights[crossing]
    # Turn every crossing triangle so that its first corner is alone on its side.
    negative = h < 0.0
    alone = np.where(negative.sum(axis=1) == 1, negative.argmax(axis=1), (~negative).argmax(axis=1))
    order = (alone[:, None] + np.arange(3)) % 3
    rows = np.arange(len(crossed))[:, None]
    (a, b, c), (ha, hb, hc) = crossed[rows, order].transpose(1, 0, 2), h[rows, order].T
    ab = a + (ha / (ha - hb))[:, None] * (b - a)
    ac = a + (ha / (ha - hc))[:, None] * (c - a)
    tips = np.stack([a, ab, ac], axis=1)
    rests = np.stack([ab, b, c, ab, c, ac], axis=1).reshape(-1, 2, 3, 3)
    down = ha < 0.0
    return (
        np.concatenate([triangles[below], tips[down], rests[~down].reshape(-1, 3, 3)]),
        np.concatenate([triangles[above & ~below], tips[~down], rests[down].reshape(-1, 3, 3)]),
    )


def _corners(planes: Sequence[_Plane]) -> list[Array]:
    """Return the points where three of the planes meet and that no other plane cuts off."""
    corners = []
    for three in combinations(planes, 3):
        normals = np.array([plane.normal for plane in three])
        if abs(np.linalg.det(normals)) > 1e-9:
            corner = np.linalg.solve(normals, [plane.offset for plane in three])
            if all(plane.normal @ corner <= plane.offset + 1e-9 for plane in planes):
                corners.append(corner)
    return corners


# ---- the search for a plane


class _Trial:
    """Estimates of what a cut of a part leaves of the excess.

    Args:
        triangles: of the part, shape (n, 3, 3).
        others: hulls of the other parts.
        samples: tree of points on the mesh.
    """

    def __init__(self, triangles: Array, others: Sequence[Hull], samples: Any) -> None:
        self.vertices, self._edges = _clustered(triangles)
        self._others = others
        self._samples = samples

    def __call__(self, plane: _Plane) -> float:
        """Return the excess of the two parts, m^4; infinite if one of them is flat."""
        heights = self.vertices @ plane.normal - plane.offset
        first, second = heights[self._edges].T
        crossing = (first < 0.0) != (second < 0.0)
        first, second = first[crossing], second[crossing]
        start, end = self.vertices[self._edges[crossing]].transpose(1, 0, 2)
        section = start + (first / (first - second))[:, None] * (end - start)
        sides = heights <= 0.0, heights >= 0.0
        return self._excess([np.concatenate([self.vertices[side], section]) for side in sides])

    def _excess(self, clouds: Sequence[Array]) -> float:
        try:
            hulls = [Hull(_farthest(points)) for points in clouds]
        except FlatError:
            return np.inf
        points, _ = boundary(hulls, _TRIAL_SAMPLES, self._others)
        area = sum(hull.areas.sum() for hull in hulls)
        return float(np.square(self._samples.query(points)[0]).sum() * area / _TRIAL_SAMPLES)


def _farthest(points: Array) -> Array:
    """Return the points, of shape (n, 3), that are farthest along fixed directions."""
    return points[np.unique((_FAN @ points.T).argmax(axis=1))] if len(points) else points


def _clustered(triangles: Array) -> tuple[Array, Indices]:
    """Return one vertex of each small cell of space, shape (n, 3), and the edges between them, shape (m, 2)."""
    points = triangles.reshape(-1, 3)
    extents = np.ptp(points, axis=0)
    cells = ((points - points.min(axis=0)) / (np.linalg.norm(extents) / _CELLS)).astype(np.int64)
    _, chosen, cluster = np.unique(cells @ [1, 2 * _CELLS, 4 * _CELLS**2], return_index=True, return_inverse=True)
    corners = cluster.reshape(-1, 3)
    ends = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    low, high = np.minimum(*ends), np.maximum(*ends)
    edges = np.unique((low * len(chosen) + high)[low < high])
    return points[chosen], np.column_stack(np.divmod(edges, len(chosen)))


def _best_plane(trial: _Trial) -> _Plane:
    """Return the plane that leaves the least excess of those that are tried."""
    places = np.arange(1, _PLACES + 1) / (_PLACES + 1)
    heights = [trial.vertices @ normal for normal in _LATTICE]
    planes = [
        _Plane(normal, float(h.min() + place * np.ptp(h)))
        for normal, h in zip(_LATTICE, heights, strict=True)
        for place in places
    ]
    values = [trial(plane) for plane in planes]
    best = int(np.argmin(values))
    translation = float(np.ptp(trial.vertices @ planes[best].normal)) / (2 * (_PLACES + 1))
    return _pattern_search(trial, planes[best], values[best], translation, trial.vertices.mean(axis=0))


def _pattern_search(
    excess: Callable[[_Plane], float], plane: _Plane, least: float, translation: float, middle: Array
) -> _Plane:
    """Rotate and translate a plane, each time to the first better one; where there is none, with half the step."""
    rotation = 0.25
    for _ in range(_PATTERN_STEPS):
        across = np.cross(plane.normal, np.eye(3)[int(np.abs(plane.normal).argmin())])
        across /= np.linalg.norm(across)
        axes = (across, np.cross(plane.normal, across))
        moves = [_rotated(plane, step * axis, middle) for axis in axes for step in (rotation, -rotation)]
        moves += [_Plane(plane.normal, plane.offset + step) for step in (translation, -translation)]
        for move in moves:
            found = excess(move)
            if found < least:
                least, plane = found, move
                break
        else:
            rotation, translation = 0.5 * rotation, 0.5 * translation
    return plane


def _rotated(plane: _Plane, change: Array, middle: Array) -> _Plane:
    """Add to the normal, about the point of the plane that is nearest to `middle`."""
    normal = plane.normal + change
    normal /= np.linalg.norm(normal)
    nearest = middle - (plane.normal @ middle - plane.offset) * plane.normal
    return _Plane(normal, float(normal @ nearest))


def _lattice() -> Array:
    """Return the axes and the diagonals between two of them, one of two opposite directions each, shape (9, 3)."""
    ahead = [step for step in product((-1.0, 0.0, 1.0), repeat=3) if step > (0.0, 0.0, 0.0) and 0.0 in step]
    return np.array([np.array(step) / np.linalg.norm(step) for step in ahead])


_LATTICE = _lattice()
_FAN = fan(96)
