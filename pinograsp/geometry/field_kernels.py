"""Distance fields at points, compiled: splines, both fields, and the nearest of a set of points.

All in one file: what Numba keeps of a function is as old as the file of that function, and not of those that it calls.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled

if TYPE_CHECKING:
    from .distance_field import DistanceField
    from .field_bounds import Bounds
    from .lattice import Lattice
    from .point_trees import PointTrees

AROUND = 0.1
"""How far the coarse lattice reaches beyond the body, m."""
ABOVE = 0.7
"""Part of what it has above the distance that is wanted by which a distance may be too large: it does not count."""
LOOSE, LOOSER, LOOSEST = 0.1, 10.0, 0.4
"""Part of what it lacks to the distance that is wanted by which a distance may be too large, by how much this part
grows with what it lacks, 1/m, and the most of it: exact where it counts."""
_DEPTH = 64


@compiled
def _covers(lattice: Lattice, x: float, y: float, z: float) -> bool:
    """Return whether a point is at least one spacing within the outermost nodes."""
    origin, once, counts = lattice.origin, 1.0 / lattice.spacing, lattice.coefficients.shape
    u, v, w = (x - origin[0]) * once, (y - origin[1]) * once, (z - origin[2]) * once
    return bool(1.0 <= u <= counts[0] - 2 and 1.0 <= v <= counts[1] - 2 and 1.0 <= w <= counts[2] - 2)


@compiled
def _distance_beyond(lattice: Lattice, x: float, y: float, z: float) -> float:
    """Return how far a point is from what the lattice covers, m."""
    square = 0.0
    for axis in range(3):
        place = x if axis == 0 else (y if axis == 1 else z)
        low = lattice.origin[axis] + lattice.spacing
        high = lattice.origin[axis] + lattice.spacing * (lattice.coefficients.shape[axis] - 2)
        square += max(low - place, place - high, 0.0) ** 2
    return math.sqrt(square)


@compiled
def _cell(lattice: Lattice, axis: int, place: float) -> tuple[int, float]:
    """Return the first of the four nodes along an axis that count at a place, and its share of the middle step."""
    u = (place - lattice.origin[axis]) / lattice.spacing
    first = min(max(int(u) - 1, 0), lattice.coefficients.shape[axis] - 4)
    return first, u - first - 1.0


@compiled
def _weights(t: float) -> tuple[float, float, float, float]:
    s = 1.0 - t
    cube, other = t * t * t, s * s * s
    return other / 6.0, (4.0 - 6.0 * t * t + 3.0 * cube) / 6.0, (4.0 - 6.0 * s * s + 3.0 * other) / 6.0, cube / 6.0


@compiled
def _slopes(t: float) -> tuple[float, float, float, float]:
    s = 1.0 - t
    return -0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), 0.5 * s * (4.0 - 3.0 * s), 0.5 * t * t


@compiled
def _bends(t: float) -> tuple[float, float, float, float]:
    return 1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t


@compiled
def _value_at(lattice: Lattice, x: float, y: float, z: float) -> float:
    """Return the value at a point that the lattice covers."""
    (i, t), (j, u), (k, v) = _cell(lattice, 0, x), _cell(lattice, 1, y), _cell(lattice, 2, z)
    a, b, (c0, c1, c2, c3), nodes = _weights(t), _weights(u), _weights(v), lattice.coefficients
    total = 0.0
    for p in range(4):
        plane = 0.0
        for q in range(4):
            m, n = i + p, j + q
            row = c0 * nodes[m, n, k] + c1 * nodes[m, n, k + 1] + c2 * nodes[m, n, k + 2] + c3 * nodes[m, n, k + 3]
            plane += b[q] * row
        total += a[p] * plane
    return total


@compiled
def _derivatives_at(lattice: Lattice, x: float, y: float, z: float, gradient: Array, hessian: Array) -> float:
    """Return the value at a point that the lattice covers; write gradient (3,) and Hessian (3, 3)."""
    (i, t), (j, u), (k, v) = _cell(lattice, 0, x), _cell(lattice, 1, y), _cell(lattice, 2, z)
    a, da, dda = _weights(t), _slopes(t), _bends(t)
    b, db, ddb = _weights(u), _slopes(u), _bends(u)
    c, dc, ddc = _weights(v), _slopes(v), _bends(v)
    f = fx = fy = fz = fxx = fyy = fzz = fxy = fxz = fyz = 0.0
    for p in range(4):
        g = gy = gz = gyy = gzz = gyz = 0.0
        for q in range(4):
            row = lattice.coefficients[i + p, j + q, k : k + 4]
            r = c[0] * row[0] + c[1] * row[1] + c[2] * row[2] + c[3] * row[3]
            rz = dc[0] * row[0] + dc[1] * row[1] + dc[2] * row[2] + dc[3] * row[3]
            rzz = ddc[0] * row[0] + ddc[1] * row[1] + ddc[2] * row[2] + ddc[3] * row[3]
            g += b[q] * r
            gy += db[q] * r
            gyy += ddb[q] * r
            gz += b[q] * rz
            gyz += db[q] * rz
            gzz += b[q] * rzz
        f += a[p] * g
        fx += da[p] * g
        fxx += dda[p] * g
        fy += a[p] * gy
        fxy += da[p] * gy
        fyy += a[p] * gyy
        fz += a[p] * gz
        fxz += da[p] * gz
        fyz += a[p] * gyz
        fzz += a[p] * gzz
    once, twice = 1.0 / lattice.spacing, 1.0 / (lattice.spacing * lattice.spacing)
    gradient[0], gradient[1], gradient[2] = once * fx, once * fy, once * fz
    hessian[0, 0], hessian[1, 1], hessian[2, 2] = twice * fxx, twice * fyy, twice * fzz
    hessian[0, 1], hessian[0, 2], hessian[1, 2] = twice * fxy, twice * fxz, twice * fyz
    hessian[1, 0], hessian[2, 0], hessian[2, 1] = hessian[0, 1], hessian[0, 2], hessian[1, 2]
    return f


@compiled
def coarse_values(coarse: Lattice, origin: Array, h: float, counts: tuple[int, int, int]) -> Array:
    """Return the values of a spline at the nodes of a finer lattice: its first node, spacing, m, and their numbers."""
    values, nodes, (x, y, z) = np.empty(counts), coarse.coefficients, origin
    for i in range(counts[0]):
        first, t = _cell(coarse, 0, x + i * h)
        a, near = _weights(t), nodes[first : first + 4]
        plane = a[0] * near[0] + a[1] * near[1] + a[2] * near[2] + a[3] * near[3]
        for j in range(counts[1]):
            first, t = _cell(coarse, 1, y + j * h)
            b, rows = _weights(t), plane[first : first + 4]
            row = b[0] * rows[0] + b[1] * rows[1] + b[2] * rows[2] + b[3] * rows[3]
            for k in range(counts[2]):
                first, t = _cell(coarse, 2, z + k * h)
                c = _weights(t)
                values[i, j, k] = (
                    c[0] * row[first] + c[1] * row[first + 1] + c[2] * row[first + 2] + c[3] * row[first + 3]
                )
    return values


@compiled
def _bound_at(known: Bounds, x: float, y: float, z: float) -> float:
    """Return a lower bound of the distance of a point, m, at the price of four numbers that are read; far away, NaN."""
    once, counts = 1.0 / known.spacing, known.values.shape
    u, v, w = (x - known.origin[0]) * once, (y - known.origin[1]) * once, (z - known.origin[2]) * once
    i, j, k = int(u + 0.5), int(v + 0.5), int(w + 0.5)
    if u < -0.5 or v < -0.5 or w < -0.5 or i >= counts[0] or j >= counts[1] or k >= counts[2]:
        return math.nan
    here = known.values[i, j, k]
    return float(here[0] + known.spacing * (here[1] * (u - i) + here[2] * (v - j) + here[3] * (w - k)))


@compiled
def _bound_far_away(coarse: Lattice, error: float, x: float, y: float, z: float) -> float:
    """Return a lower bound of the distance of a point that is outside the body and not near its surface, m."""
    if _covers(coarse, x, y, z):
        return _value_at(coarse, x, y, z) - error
    return AROUND + _distance_beyond(coarse, x, y, z)


@compiled
def _derivatives(field: DistanceField, fine: Lattice, point: Array, gradient: Array, hessian: Array) -> float:
    """Return the value of a field at a point; write gradient and Hessian."""
    x, y, z = point[0], point[1], point[2]
    if _covers(fine, x, y, z):
        return _derivatives_at(fine, x, y, z, gradient, hessian)
    if _covers(field.coarse, x, y, z):
        return _derivatives_at(field.coarse, x, y, z, gradient, hessian)
    nearest, beyond = np.empty(3), _distance_beyond(field.coarse, x, y, z)
    for i in range(3):
        low = field.coarse.origin[i] + field.coarse.spacing
        high = field.coarse.origin[i] + field.coarse.spacing * (field.coarse.coefficients.shape[i] - 2)
        nearest[i] = min(max(point[i], low), high)
    value = _derivatives_at(field.coarse, nearest[0], nearest[1], nearest[2], gradient, hessian)
    for i in range(3):
        if point[i] != nearest[i]:  # d(q) does not change with this coordinate
            gradient[i] = (point[i] - nearest[i]) / beyond
            hessian[i, :] = 0.0
            hessian[:, i] = 0.0
    for i in range(3):
        for j in range(3):
            if point[i] != nearest[i] and point[j] != nearest[j]:
                hessian[i, j] = ((1.0 if i == j else 0.0) - gradient[i] * gradient[j]) / beyond
    return value + beyond


@compiled
def field_distances(field: DistanceField, points: Array) -> tuple[Array, Array, Array]:
    """Return d (n,), its gradient (n, 3) and Hessian (n, 3, 3) at points (n, 3), m."""
    n = len(points)
    values, gradients, hessians = np.empty(n), np.empty((n, 3)), np.empty((n, 3, 3))
    for i in range(n):
        values[i] = _derivatives(field, field.distance, points[i], gradients[i], hessians[i])
    return values, gradients, hessians


@compiled
def field_normals(field: DistanceField, points: Array) -> tuple[Array, Array]:
    """Return the footprint normals (n, 3) and their derivatives (n, 3, 3) at points (n, 3), m."""
    n = len(points)
    normals, derivatives = np.empty((n, 3)), np.empty((n, 3, 3))
    hessian = np.empty((3, 3))
    for i in range(n):
        normal = normals[i]
        _derivatives(field, field.smoothed, points[i], normal, hessian)
        length = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
        for a in range(3):
            normal[a] /= length
        for b in range(3):
            along = normal[0] * hessian[0, b] + normal[1] * hessian[1, b] + normal[2] * hessian[2, b]
            for a in range(3):
                derivatives[i, a, b] = (hessian[a, b] - normal[a] * along) / length
    return normals, derivatives


@compiled
def nearest_points(
    trees: PointTrees,
    field: DistanceField,
    known: Bounds,
    rotations: Array,
    translations: Array,
    least: Array,
    caps: Array,
) -> tuple[Indices, Array, Array, Array]:
    """Return which sets are nearer than their cap to a surface, with distances, points and gradients there.

    A distance may be too large, but no point of the set has one below `near_enough` of it.

    Args:
        trees: the sets.
        field: of the surface.
        known: bounds of the field.
        rotations: of the bodies' frames in that of the surface, shape (bodies, 3, 3).
        translations: of these, m, shape (bodies, 3).
        least: distances of each set that are wanted, m, shape (sets,).
        caps: distances of each set from which on they do not matter, less than `AROUND`, m, shape (sets,).

    Returns:
        Indices of sets, ascending, shape (k,); signed distances, m, shape (k,); points in the frame of the surface and
        gradients there, shapes (k, 3).
    """
    indices, values, count_found = np.empty(len(caps), dtype=np.intp), np.empty(len(caps)), 0
    nearest, gradients, hessian = np.empty((len(caps), 3)), np.empty((len(caps), 3)), np.empty((3, 3))
    waiting, bounds = np.empty(_DEPTH, dtype=np.intp), np.empty(_DEPTH)
    fine, coarse, error = field.distance, field.coarse, field.error  # all of it is slow to hand on
    balls, parts, points = trees.balls, trees.parts, trees.points
    for number in range(len(caps)):
        R, t, least_value = rotations[trees.bodies[number]], translations[trees.bodies[number]], caps[number]
        waiting[0], bounds[0] = trees.roots[number], -np.inf
        count, enough, place = 1, near_enough(least_value, least[number]), nearest[count_found]
        while count:
            count -= 1
            if bounds[count] >= enough:
                continue
            first, leaf = parts[waiting[count], 0], parts[waiting[count], 1]
            if leaf:
                for k in range(first, first + leaf):
                    x, y, z = _moved(R, t, points, k)
                    if _bound_at(known, x, y, z) >= enough or not _covers(coarse, x, y, z):
                        continue
                    value = _value_at(fine, x, y, z) if _covers(fine, x, y, z) else _value_at(coarse, x, y, z)
                    if value < least_value:
                        least_value, enough = value, near_enough(value, least[number])
                        place[0], place[1], place[2] = x, y, z
                continue
            second = first + 1
            x, y, z = _moved(R, t, balls, first)
            one = _bound_at(known, x, y, z)
            if math.isnan(one):
                one = _bound_far_away(coarse, error, x, y, z)
            one -= balls[first, 3]
            x, y, z = _moved(R, t, balls, second)
            other = _bound_at(known, x, y, z)
            if math.isnan(other):
                other = _bound_far_away(coarse, error, x, y, z)
            other -= balls[second, 3]
            if one < other:  # the nearer one is taken first: it comes last
                first, second, one, other = second, first, other, one
            waiting[count], bounds[count] = first, one
            waiting[count + 1], bounds[count + 1] = second, other
            count += 2
        if least_value < caps[number]:
            indices[count_found], values[count_found] = number, least_value
            _derivatives(field, fine, place, gradients[count_found], hessian)
            count_found += 1
    return indices[:count_found], values[:count_found], nearest[:count_found], gradients[:count_found]


@compiled
def near_enough(value: float, least: float) -> float:
    """Return the distance below which a point is still looked for where one at a distance `value` is known, m."""
    apart = value - least
    if apart > 0.0:
        return value - ABOVE * apart
    return value + apart * min(LOOSE - LOOSER * apart, LOOSEST)


@compiled
def _moved(R: Array, t: Array, places: Array, which: int) -> tuple[float, float, float]:
    """Return one of some places, shape (n, 3) or more, in the frame that R and t lead to."""
    a, b, c = places[which, 0], places[which, 1], places[which, 2]
    return (
        R[0, 0] * a + R[0, 1] * b + R[0, 2] * c + t[0],
        R[1, 0] * a + R[1, 1] * b + R[1, 2] * c + t[1],
        R[2, 0] * a + R[2, 1] * b + R[2, 2] * c + t[2],
    )
