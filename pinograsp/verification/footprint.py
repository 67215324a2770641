"""The footprint of a contact: all that pad and object touch, where the contact point is but its centre of pressure.

At the contact point pad and object share the tangent plane. What of the pad lies in that plane is a point (of a
sphere), a straight line (of a cylinder's side) or a polygon (a flat face), and so is what of the object lies in it.
Both sets are convex; the footprint is their intersection. Rigid bodies are meant: rubber that yields touches more.

The sets are projected onto the tangent plane of the object, so that a small tilt does not matter. Two lines that are
parallel to within one degree touch along their overlap, others meet in the contact point. The contact point always
belongs to the footprint, also where it lies a little beyond an edge.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, cross

PARALLEL = math.radians(1.0)
"""Angle between two lines up to which they count as parallel, rad."""
EDGE = 1e-7
"""An edge that is nearer to the contact point than this counts as so far away, m: a line along an edge stays whole."""
_AREA = 1e-14


def footprint(pad_face: Array, object_face: Array, point: Array, normal: Array) -> Array:
    """Return the vertices of a footprint, shape (k, 3): k = 1 a point, 2 a line, 3 or more a polygon in order.

    All in one frame, m.

    Args:
        pad_face: the pad's contact face: a point, the ends of a line, or the corners of a convex polygon in order,
            shape (k, 3).
        object_face: the object's contact face likewise.
        point: the contact point, shape (3,).
        normal: unit normal of the tangent plane, shape (3,).
    """
    if len(pad_face) == 1 or len(object_face) == 1:
        return point[None]
    axes = tangents(normal)
    first, second = ((face - point) @ axes.T for face in (object_face, pad_face))
    if len(first) > len(second):
        first, second = second, first
    if len(second) == 2:
        found = _overlap(first, second)
    elif len(first) == 2:
        found = _clipped_line(first, second)
    else:
        found = _clipped_polygon(second, first)
    return np.asarray(point + found @ axes)


def thinned(vertices: Array, most: int) -> Array:
    """Return at most so many of the vertices of a footprint, shape (k, 3): the outermost in directions all round."""
    if len(vertices) <= most:
        return vertices
    spokes = vertices - vertices[0]
    normal = cross(spokes, np.roll(spokes, -1, axis=0)).sum(axis=0)
    flat = spokes @ tangents(normal / math.sqrt(normal @ normal)).T
    angles = np.arange(most) * (2 * math.pi / most)
    outermost = (flat @ np.array([np.cos(angles), np.sin(angles)])).argmax(axis=0)
    return np.asarray(vertices[np.unique(outermost)])


def tangents(normal: Array) -> Array:
    """Return two unit vectors that span the plane across a normal, rows of a (2, 3) matrix, right-handed with it."""
    least = np.zeros(3)
    least[int(np.abs(normal).argmin())] = 1.0
    x, y, z = normal
    first = np.array([least[1] * z - least[2] * y, least[2] * x - least[0] * z, least[0] * y - least[1] * x])
    first /= math.sqrt(first @ first)
    a, b, c = first
    return np.array([first, [y * c - z * b, z * a - x * c, x * b - y * a]])


def _direction(line: Array) -> Array | None:
    """Return the unit direction of a line in the plane, shape (2, 2); None if it has no length there."""
    along = line[1] - line[0]
    length = math.hypot(*along)
    return None if length < EDGE else along / length


def _interval(line: Array, direction: Array) -> tuple[float, float]:
    """Return from where to where a line reaches along a direction, the contact point (0) included."""
    ends = line @ direction
    return min(0.0, float(ends.min())), max(0.0, float(ends.max()))


def _overlap(first: Array, second: Array) -> Array:
    """Return the common part of two lines, shape (1 or 2, 2)."""
    d, e = _direction(first), _direction(second)
    if d is None or e is None or abs(d[0] * e[1] - d[1] * e[0]) > math.sin(PARALLEL):
        return np.zeros((1, 2))
    ends = _interval(first, d), _interval(second, d)
    return _line(max(low for low, _ in ends), min(high for _, high in ends), d)


def _line(low: float, high: float, direction: Array) -> Array:
    if high - low < EDGE:
        return np.zeros((1, 2))
    return np.array([low * direction, high * direction])


def _clipped_line(line: Array, polygon: Array) -> Array:
    """Return the common part of a line and a polygon, shape (1 or 2, 2)."""
    d, area = _direction(line), _area(polygon)
    if d is None or abs(area) < _AREA:
        return np.zeros((1, 2))
    low, high = _interval(line, d)
    dx, dy = d.tolist()
    corners = polygon.tolist()
    # Few corners: plain numbers take a tenth of the time of arrays.
    for (x, y), (ahead_x, ahead_y) in zip(corners, corners[1:] + corners[:1], strict=True):
        out_x, out_y = math.copysign(1.0, area) * (ahead_y - y), math.copysign(1.0, area) * (x - ahead_x)
        slope, offset = out_x * dx + out_y * dy, max(out_x * x + out_y * y, EDGE * math.hypot(out_x, out_y))
        if slope > 0.0:
            high = min(high, offset / slope)
        elif slope < 0.0:
            low = max(low, offset / slope)
    return _line(low, high, d)


def _clipped_polygon(polygon: Array, by: Array) -> Array:
    """Return the common part of two polygons, shape (k, 2); the first may have many corners."""
    own, sides = _sides(polygon), _sides(by)
    if own is None or sides is None:
        return np.zeros((1, 2))
    corners = _with_origin(_counterclockwise(polygon), own[1])
    for normal, offset in zip(*sides, strict=True):
        heights = corners @ normal - max(float(offset), EDGE)
        after = np.roll(heights, -1)
        ahead = np.roll(corners, -1, axis=0)
        crossing = (heights < 0.0) != (after < 0.0)
        share = np.where(crossing, heights / np.where(crossing, heights - after, 1.0), 0.0)
        cuts = corners + share[:, None] * (ahead - corners)
        both = np.stack([corners, cuts], axis=1).reshape(-1, 2)
        corners = both[np.stack([heights < 0.0, crossing], axis=1).ravel()]
    apart = np.abs(corners - np.roll(corners, -1, axis=0)).max(axis=1) > 1e-2 * EDGE
    return np.asarray(corners[apart])


def _counterclockwise(polygon: Array) -> Array:
    return polygon if _area(polygon) > 0.0 else polygon[::-1]


def _area(polygon: Array) -> float:
    """Return the area of a polygon, negative if its corners go round clockwise."""
    x, y = polygon.T
    return 0.5 * float(x[:-1] @ y[1:] - x[1:] @ y[:-1] + x[-1] * y[0] - x[0] * y[-1])


def _sides(polygon: Array) -> tuple[Array, Array] | None:
    """Return outward unit normals n and offsets b of a polygon's sides, n . p <= b inside; None if it is degenerate."""
    if abs(_area(polygon)) < _AREA:
        return None
    corners = _counterclockwise(polygon)
    along = np.roll(corners, -1, axis=0) - corners
    along /= np.sqrt((along * along).sum(axis=1))[:, None]
    normals = np.column_stack([along[:, 1], -along[:, 0]])
    return normals, (normals * corners).sum(axis=1)


def _with_origin(polygon: Array, offsets: Array) -> Array:
    """Return the convex hull of a polygon, counter-clockwise, and of the contact point, the origin."""
    seen = offsets < 0.0
    if not seen.any():
        return polygon
    start = int(np.flatnonzero(seen & ~np.roll(seen, 1))[0])
    kept = np.roll(polygon, -(start + int(seen.sum())), axis=0)[: len(polygon) - int(seen.sum()) + 1]
    return np.vstack([kept, np.zeros(2)])
