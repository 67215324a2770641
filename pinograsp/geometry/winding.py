"""How often a surface goes around points: its winding number, exact, next to long triangles and far from all alike.

Go from a point along one of `WAYS`, and count the triangles that are met: +1 through one from its inner to its outer
side, -1 the other way. Of a closed surface that count N is the winding number. Where it has openings, let caps close
them, fans of triangles over their borders: with these the count is that of a closed surface, and caps have a solid
angle of 4 pi w, so that the winding number is N - w. Openings are looked at from within `CLEAR` radii of them; farther
away, w is less than a tenth.

Whether a way meets a triangle is told by the sides of its edges on which the point is, seen along the way. Where the
point is so near to one of them that rounding might decide, another way is gone. Neighbours see their edge from the same
ends, taken in the same order, so that no way passes between them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices, Integers, Mask
from ..compiled import compiled, compiled_for_threads
from .box_tree import WIDE, box_ends, box_tree, groups
from .in_threads import in_threads
from .mesh_parts import components, edges_of
from .triangle_tree import pieces
from .turned_boxes import turn_boxes

WAYS = ((0.3391, 0.2173), (-0.2719, 0.3837), (0.1571, -0.4211), (-0.3583, -0.1979))
"""How far a way goes along the first two axes while it goes 1 along the third; no special directions."""
FEW = 30
"""Points for which the triangles are not put into a tree along another way than the first."""
_WAITING = 256
"""Boxes that wait to be looked at, at most."""
CLEAR = 2.0
"""Radius about an opening within which its solid angle counts, in parts of its own."""
_SLACK = 1e-12
_ROUNDING = 1e-14
"""Of areas, in parts of the lengths that they are made of."""


class Winding:
    """Winding numbers of a surface.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3), f > 0.
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        self._caps = _Caps(vertices, faces)
        added = self._caps.triangles.reshape(-1, 3)
        numbers = len(vertices) + np.arange(len(added)).reshape(-1, 3)
        self._surface = np.concatenate([vertices, added]), np.concatenate([faces, numbers])
        self._trees: dict[tuple[float, float], _WayTree] = {}

    def numbers(self, points: Array) -> Array:
        """Return the winding numbers of points, shape (n, 3), shape (n,)."""
        points, rest = np.ascontiguousarray(points), np.arange(len(points))
        found = np.zeros(len(points))
        for way in WAYS:
            if len(rest):
                found[rest], sure = self._counted(points[rest], way)
                rest = rest[~sure]
        return np.asarray(found - self._caps.angles(points))

    def _counted(self, points: Array, way: tuple[float, float]) -> tuple[Array, Mask]:
        """Return N of points, shape (n, 3), and whether that is sure, shapes (n,)."""
        counts, sure = np.zeros(len(points)), np.ones(len(points), dtype=bool)
        seen, (vertices, faces) = _seen(points, way), self._surface
        if way not in self._trees and way != WAYS[0] and len(points) <= FEW:
            _count_all(_seen(vertices, way)[faces], seen, counts, sure)
            return counts, sure
        if way not in self._trees:
            self._trees[way] = _way_tree(_seen(pieces(vertices, faces)[0], way))
        in_threads(_count_above, self._trees[way], seen, counts, sure)
        return counts, sure


def _seen(points: Array, way: tuple[float, float]) -> Array:
    """Return points, shape (..., 3), seen along a way: it leads along their third axis."""
    seen = points.copy()
    seen[..., 0] -= way[0] * points[..., 2]
    seen[..., 1] -= way[1] * points[..., 2]
    return seen


class _WayTree(NamedTuple):
    """Boxes around triangles that are seen along a way, as `box_tree.BoxTree`."""

    parts: Array
    """m, shape (boxes, 6, 8), along the axes of the box that they are parts of."""
    axes: Array
    """The first of these in each box, shape (boxes, 2); `turned_boxes`."""
    shift: int
    corners: Array
    """Of the triangle that each leaf is, or which is never met, m, shape (leaves, 3, 3)."""


def _way_tree(corners: Array) -> _WayTree:
    """Return the tree of triangles, shape (n, 3, 3), m."""
    low, high = box_ends(corners)
    grouped, counts = groups(0.5 * (low + high))
    low, high, empty = low[grouped], high[grouped], np.arange(WIDE) >= counts[:, None]
    low[empty], high[empty] = np.inf, -np.inf
    boxes = box_tree(low.reshape(-1, 3), high.reshape(-1, 3))
    leaves = corners[grouped.ravel()]
    return _WayTree(boxes.parts, turn_boxes(boxes, leaves, empty.ravel()), boxes.shift, leaves)


class _Caps:
    """Fans over the borders of the openings of a surface.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        ends, edge, direction, _ = edges_of(faces)
        net = np.bincount(edge, weights=direction, minlength=len(ends)).astype(np.int64)
        border = np.flatnonzero(net)
        forward = np.where((net[border] > 0)[:, None], ends[border][:, ::-1], ends[border])
        forward = np.repeat(forward, np.abs(net[border]), axis=0)
        part = np.unique(components(forward, len(vertices))[forward[:, 0]], return_inverse=True)[1]
        order = np.argsort(part, kind="stable")
        edges = vertices[forward[order]]
        self._starts = np.searchsorted(part[order], np.arange(int(part.max(initial=-1)) + 2))
        bounds = [edges[i:j].reshape(-1, 3) for i, j in zip(self._starts, self._starts[1:], strict=False)]
        middles = np.array([0.5 * (of.min(axis=0) + of.max(axis=0)) for of in bounds]).reshape(-1, 3)
        self._reach = np.array([CLEAR * 0.5 * np.linalg.norm(np.ptp(of, axis=0)) for of in bounds])
        tips = np.repeat(middles, np.diff(self._starts), axis=0)
        self.triangles = np.concatenate([edges, tips[:, None]], axis=1)
        """Shape (n, 3 corners, 3), m."""
        self._middles = middles

    def angles(self, points: Array) -> Array:
        """Return w, as above, of points, shape (n, 3)."""
        return _angles(points, self.triangles, self._starts, self._middles, self._reach)


@compiled
def _count_all(corners: Array, points: Array, found: Array, sure: Mask) -> None:
    """Add to N of points what all of some triangles make, shape (t, 3, 3), and write whether that is sure."""
    for n in range(len(points)):
        for k in range(len(corners)):
            met, known = _met(corners, k, points[n, 0], points[n, 1], points[n, 2])
            found[n] += met
            sure[n] &= known


@compiled_for_threads
def _count_above(tree: _WayTree, points: Array, found: Array, sure: Mask) -> None:
    """Do as `_count_all` does, with a tree."""
    parts, axes, shift, corners, boxes = tree.parts, tree.axes, tree.shift, tree.corners, len(tree.parts)
    waiting, above = np.empty(_WAITING, dtype=np.intp), np.empty(8)
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        waiting[0], count = 0, 1
        while count:
            count -= 1
            box = waiting[count]
            if box >= boxes:
                met, known = _met(corners, box - boxes, x, y, z)
                found[n] += met
                sure[n] &= known
                continue
            a, b = axes[box, 0], axes[box, 1]
            _above(parts[box], a * x + b * y, a * y - b * x, z, above)
            for j in range(8):
                waiting[count] = 8 * box + j + shift
                count += int(above[j])  # where it is 0, the next one comes to this place


@compiled
def _above(boxes: Array, x: float, y: float, z: float, above: Array) -> None:
    """Write 1 for each of some boxes, shape (6, n), that a point is in or below, and else 0.

    The number of boxes is asked for, although it is known: with a number that it knows, the compiler makes no use of
    instructions for several at once.
    """
    size = abs(x) + abs(y) + abs(z)
    for j in range(boxes.shape[1]):
        slack = _SLACK * (size + boxes[5, j] - z)
        along = (x >= boxes[0, j] - slack) & (x <= boxes[3, j] + slack)
        across = (y >= boxes[1, j] - slack) & (y <= boxes[4, j] + slack)
        above[j] = 1.0 if (z <= boxes[5, j]) & along & across else 0.0


@compiled
def _met(corners: Array, k: int, x: float, y: float, z: float) -> tuple[float, bool]:
    """Return 1 or -1 if the way up from a point meets a triangle, 0 if it does not, and whether that is sure."""
    ab, one = _beside(corners, k, 0, 1, x, y)
    bc, two = _beside(corners, k, 1, 2, x, y)
    if one * two < 0.0:
        return 0.0, True
    ca, three = _beside(corners, k, 2, 0, x, y)
    if one * three < 0.0 or two * three < 0.0:
        return 0.0, True
    if one == 0.0 or two == 0.0 or three == 0.0:
        return 0.0, max(corners[k, 0, 2], corners[k, 1, 2], corners[k, 2, 2]) < z
    rise = bc * (corners[k, 0, 2] - z) + ca * (corners[k, 1, 2] - z) + ab * (corners[k, 2, 2] - z)
    return (one if rise * one > 0.0 else 0.0), True


@compiled
def _beside(corners: Array, k: int, start: int, end: int, x: float, y: float) -> tuple[float, float]:
    """Return twice the area of an edge and a point, seen along the way, and its sign: 0 where that is not sure."""
    sign, apart = 1.0, corners[k, start, 0] - corners[k, end, 0]
    if apart > 0.0 or (apart == 0.0 and corners[k, start, 1] > corners[k, end, 1]):
        start, end, sign = end, start, -1.0
    a, b = corners[k, start, 0] - x, corners[k, start, 1] - y
    c, d = corners[k, end, 0] - x, corners[k, end, 1] - y
    area, sizes = a * d - b * c, abs(a) + abs(b) + abs(c) + abs(d)
    if abs(area) <= _ROUNDING * sizes * (sizes + abs(x) + abs(y)):
        return 0.0, 0.0
    return sign * area, sign if area > 0.0 else -sign


@compiled
def _angles(points: Array, triangles: Array, starts: Indices, middles: Array, reach: Array) -> Array:
    found = np.zeros(len(points))
    for n in range(len(points)):
        total = 0.0
        for k in range(len(middles)):
            x, y, z = points[n, 0] - middles[k, 0], points[n, 1] - middles[k, 1], points[n, 2] - middles[k, 2]
            if x * x + y * y + z * z <= reach[k] * reach[k]:
                for i in range(starts[k], starts[k + 1]):
                    total += _angle(triangles[i] - points[n])
        found[n] = total / (4.0 * math.pi)
    return found


@compiled
def _angle(corners: Array) -> float:
    """Return the solid angle of a triangle seen from the origin, positive from behind it."""
    a, b, c = corners[0], corners[1], corners[2]
    volume = (
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    ab, bc = a[0] * b[0] + a[1] * b[1] + a[2] * b[2], b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
    ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2]
    aa = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    bb = math.sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2])
    cc = math.sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2])
    return 2.0 * math.atan2(volume, aa * bb * cc + ab * cc + bc * aa + ca * bb)
