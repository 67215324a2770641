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

import numpy as np

from ..arrays import Array, Indices, Integers
from ..compiled import compiled
from .mesh_parts import components, edges_of
from .triangle_tree import TriangleTree, triangle_tree

WAYS = ((0.3391, 0.2173), (-0.2719, 0.3837), (0.1571, -0.4211), (-0.3583, -0.1979))
"""How far a way goes along the first two axes while it goes 1 along the third; no special directions."""
_LEVELS = 64
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
        self._tree = triangle_tree(np.concatenate([vertices, added]), np.concatenate([faces, numbers]))

    def numbers(self, points: Array) -> Array:
        """Return the winding numbers of points, shape (n, 3), shape (n,)."""
        points = np.ascontiguousarray(points)
        return np.asarray(_counts(self._tree, points) - self._caps.angles(points))


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
def _counts(tree: TriangleTree, points: Array) -> Array:
    found = np.zeros(len(points))
    for n in range(len(points)):
        for way in range(len(WAYS)):
            found[n], sure = _count(tree, points[n, 0], points[n, 1], points[n, 2], WAYS[way][0], WAYS[way][1])
            if sure:
                break
    return found


@compiled
def _count(tree: TriangleTree, x: float, y: float, z: float, along: float, across: float) -> tuple[float, bool]:
    """Return N of a point by one way, and whether that is sure."""
    boxes, corners, starts, leaves = tree.boxes, tree.corners, tree.starts, len(tree.starts) - 1
    waiting, found, sure = np.empty(_LEVELS, dtype=np.intp), 0.0, True
    waiting[0], count = 1, 1
    while count:
        count -= 1
        box = waiting[count]
        high = boxes[box, 5] - z
        if high < 0.0:
            continue
        low = max(boxes[box, 2] - z, 0.0)
        slack = _SLACK * (abs(x) + abs(y) + abs(z) + high)
        ends = min(along * low, along * high), max(along * low, along * high)
        if x + ends[1] < boxes[box, 0] - slack or x + ends[0] > boxes[box, 3] + slack:
            continue
        ends = min(across * low, across * high), max(across * low, across * high)
        if y + ends[1] < boxes[box, 1] - slack or y + ends[0] > boxes[box, 4] + slack:
            continue
        if box < leaves:
            waiting[count], waiting[count + 1] = 2 * box, 2 * box + 1
            count += 2
            continue
        for k in range(starts[box - leaves], starts[box - leaves + 1]):
            met, told = _met(corners, k, x - along * z, y - across * z, z, along, across)
            found += met
            sure &= told
    return found, sure


@compiled
def _met(corners: Array, k: int, x: float, y: float, z: float, along: float, across: float) -> tuple[float, bool]:
    """Return 1 or -1 if the way up from a point meets a triangle, 0 if it does not, and whether that is sure.

    The place (x, y) is that where the way meets the plane of the first two axes.
    """
    ab, one = _beside(corners, k, 0, 1, x, y, along, across)
    bc, two = _beside(corners, k, 1, 2, x, y, along, across)
    if one * two < 0.0:
        return 0.0, True
    ca, three = _beside(corners, k, 2, 0, x, y, along, across)
    if one * three < 0.0 or two * three < 0.0:
        return 0.0, True
    if one == 0.0 or two == 0.0 or three == 0.0:
        return 0.0, max(corners[k, 0, 2], corners[k, 1, 2], corners[k, 2, 2]) < z
    rise = bc * (corners[k, 0, 2] - z) + ca * (corners[k, 1, 2] - z) + ab * (corners[k, 2, 2] - z)
    return (one if rise * one > 0.0 else 0.0), True


@compiled
def _beside(
    corners: Array, k: int, start: int, end: int, x: float, y: float, along: float, across: float
) -> tuple[float, float]:
    """Return twice the area of an edge and a point, seen along the way, and its sign: 0 where that is not sure."""
    sign = 1.0
    for axis in range(3):
        if corners[k, start, axis] != corners[k, end, axis]:
            if corners[k, start, axis] > corners[k, end, axis]:
                start, end, sign = end, start, -1.0
            break
    a, b = (
        corners[k, start, 0] - along * corners[k, start, 2] - x,
        corners[k, start, 1] - across * corners[k, start, 2] - y,
    )
    c, d = corners[k, end, 0] - along * corners[k, end, 2] - x, corners[k, end, 1] - across * corners[k, end, 2] - y
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
