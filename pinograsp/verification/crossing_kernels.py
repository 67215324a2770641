"""Compiled: triangles that cross each other, and ways that triangles leave free; called by `crossings`."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Indices, Integers, Mask
from ..compiled import compiled, compiled_for_threads

LAYER = 1e-7
"""Distance from a triangle within which other ones lie on it or touch it, m."""
_PARALLEL = 1e-9
"""Length of the cross product of directions below which it has none."""
_SHORT = 1e-12
"""Length of a way below which it has no direction, m."""


@compiled_for_threads
def pairs_that_cross(
    corners: Array,
    normals: Array,
    faces: Integers,
    looks: Array,
    within: float,
    low: Array,
    high: Array,
    size: int,
    start: int,
    end: int,
    close: Mask,
) -> Integers:
    """Return pairs of a triangle and one that crosses it, shape (n, 2), and note which looks others may be near to.

    Those from `start` to `end` are paired with all after them. Arguments are as of `crossings_of` and `boxes_around`;
    `close`, shape (f, 2), is where it is noted: no thread takes back what another one has written.
    """
    pairs, count = np.empty((1024, 2), dtype=np.int64), 0
    stack = np.empty(128, dtype=np.int64)
    for i in range(start, end):
        up = size + i
        while up > 1:  # all after it are below the right one of two, on the way up
            stack[0], waiting = up + 1, 1 - up % 2
            while waiting > 0:
                waiting -= 1
                node = stack[waiting]
                if not _meet(low, high, size + i, node):
                    continue
                if node < size:
                    stack[waiting], stack[waiting + 1] = 2 * node, 2 * node + 1
                    waiting += 2
                    continue
                j = node - size
                _note_near(corners, normals, looks, within, i, j, close)
                _note_near(corners, normals, looks, within, j, i, close)
                first, second = _crossing(corners, normals, faces, i, j)
                if count + 2 > len(pairs):
                    larger = np.empty((2 * len(pairs), 2), dtype=np.int64)
                    larger[:count] = pairs[:count]
                    pairs = larger
                if first:
                    pairs[count, 0], pairs[count, 1] = i, j
                    count += 1
                if second:
                    pairs[count, 0], pairs[count, 1] = j, i
                    count += 1
            up //= 2
    return pairs[:count]


@compiled
def boxes_around(corners: Array, reach: float) -> tuple[Array, Array, int]:
    """Return a tree of boxes around triangles: low and high ends, of node 2 k and 2 k + 1 in k, and the first leaf."""
    size = 1
    while size < len(corners):
        size *= 2
    low, high = np.full((2 * size, 3), np.inf), np.full((2 * size, 3), -np.inf)
    for i in range(len(corners)):
        for k in range(3):
            low[size + i, k] = min(corners[i, 0, k], corners[i, 1, k], corners[i, 2, k]) - 0.5 * reach
            high[size + i, k] = max(corners[i, 0, k], corners[i, 1, k], corners[i, 2, k]) + 0.5 * reach
    for node in range(size - 1, 0, -1):
        for k in range(3):
            low[node, k] = min(low[2 * node, k], low[2 * node + 1, k])
            high[node, k] = max(high[2 * node, k], high[2 * node + 1, k])
    return low, high, size


@compiled
def _meet(low: Array, high: Array, one: int, other: int) -> bool:
    found = True
    for k in range(3):
        found &= low[one, k] <= high[other, k] and low[other, k] <= high[one, k]
    return found


@compiled
def _note_near(corners: Array, normals: Array, looks: Array, within: float, i: int, j: int, close: Mask) -> None:
    """Note which looks at a triangle another one, which does not lie on it, may be near to."""
    for side in range(2):
        near = not close[i, side] and _may_be_near(corners, normals, j, looks, i, side, within)
        if near and not _on(corners[i], normals[i], corners[j]):
            close[i, side] = True


@compiled
def _may_be_near(corners: Array, normals: Array, j: int, looks: Array, i: int, side: int, within: float) -> bool:
    """Whether a look is within a distance of the plane of a triangle and of its box, and beyond none of its edges.

    It is asked so often that it takes numbers: to make parts of arrays would take longer than all the rest.
    """
    height = 0.0
    for k in range(3):
        height += normals[j, k] * (looks[i, side, k] - corners[j, 0, k])
    if abs(height) > within:
        return False
    for k in range(3):
        place = looks[i, side, k]
        if place < min(corners[j, 0, k], corners[j, 1, k], corners[j, 2, k]) - within:
            return False
        if place > max(corners[j, 0, k], corners[j, 1, k], corners[j, 2, k]) + within:
            return False
    x, y, z = normals[j, 0], normals[j, 1], normals[j, 2]
    for start in range(3):
        end = (start + 1) % 3
        a, b = corners[j, end, 0] - corners[j, start, 0], corners[j, end, 1] - corners[j, start, 1]
        c = corners[j, end, 2] - corners[j, start, 2]
        beyond = (b * z - c * y) * (looks[i, side, 0] - corners[j, start, 0])
        beyond += (c * x - a * z) * (looks[i, side, 1] - corners[j, start, 1])
        beyond += (a * y - b * x) * (looks[i, side, 2] - corners[j, start, 2])
        if beyond > 0.0 and beyond * beyond > within * within * (a * a + b * b + c * c):
            return False
    return True


@compiled
def _crossing(corners: Array, normals: Array, faces: Integers, i: int, j: int) -> tuple[bool, bool]:
    """Whether of two triangles the second one crosses the first one, and the first one the second one."""
    common, own, other = 0, 0, 0
    for a in range(3):
        for b in range(3):
            if faces[i, a] == faces[j, b]:
                common, own, other = common + 1, a, b
    if common == 0 and not _apart(corners[i], normals[i], corners[j], normals[j]):
        return not _on(corners[i], normals[i], corners[j]), not _on(corners[j], normals[j], corners[i])
    both = common == 1 and (
        _pierced(corners[i], normals[i], corners[j], other) or _pierced(corners[j], normals[j], corners[i], own)
    )
    return both, both


@compiled
def are_avoided(begins: Array, ends: Array, corners: Array, normals: Array, low: Array, high: Array, size: int) -> Mask:
    """Return which straight ways all triangles are more than `LAYER` apart from, shape (n,).

    Boxes are as of `boxes_around`, of a reach of twice `LAYER` or more.
    """
    found, stack = np.ones(len(begins), dtype=np.bool_), np.empty(128, dtype=np.int64)
    for k in range(len(begins)):
        stack[0], waiting = 1, 1
        while waiting > 0:
            waiting -= 1
            node, meets = stack[waiting], True
            for axis in range(3):
                meets &= low[node, axis] <= max(begins[k, axis], ends[k, axis])
                meets &= high[node, axis] >= min(begins[k, axis], ends[k, axis])
            if not meets:
                continue
            if node < size:
                stack[waiting], stack[waiting + 1] = 2 * node, 2 * node + 1
                waiting += 2
            elif not _avoided(corners[node - size], normals[node - size], begins[k], ends[k]):
                found[k] = False
                break
    return found


@compiled
def are_free(
    numbers: Indices, begins: Array, ends: Array, corners: Array, normals: Array, starts: Indices, others: Indices
) -> Mask:
    """Return which straight ways on triangles are clear of all that cross these, shape (n,)."""
    found = np.ones(len(numbers), dtype=np.bool_)
    for k in range(len(numbers)):
        for at in range(starts[numbers[k]], starts[numbers[k] + 1]):
            if not _avoided(corners[others[at]], normals[others[at]], begins[k], ends[k]):
                found[k] = False
                break
    return found


@compiled
def _avoided(triangle: Array, normal: Array, start: Array, end: Array) -> bool:
    """Whether a triangle and a straight way are more than `LAYER` apart."""
    way, across = np.empty((3, 3)), np.empty(3)
    for k in range(3):
        way[0, k], way[1, k], way[2, k] = start[k], end[k], end[k]
    a, b, c = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    x, y, z = normal[1] * c - normal[2] * b, normal[2] * a - normal[0] * c, normal[0] * b - normal[1] * a
    length = max(np.sqrt(x * x + y * y + z * z), _SHORT)
    across[0], across[1], across[2] = x / length, y / length, z / length
    return _apart(triangle, normal, way, across)


@compiled
def _on(triangle: Array, normal: Array, other: Array) -> bool:
    """Whether another triangle lies in the plane of a triangle."""
    farthest = 0.0
    for k in range(3):
        farthest = max(farthest, abs(_height(triangle, normal, other[k])))
    return farthest <= LAYER


@compiled
def _height(triangle: Array, normal: Array, point: Array) -> float:
    height = 0.0
    for k in range(3):
        height += normal[k] * (point[k] - triangle[0, k])
    return height


@compiled
def _apart(first: Array, one: Array, second: Array, other: Array) -> bool:
    """Whether a plane has two triangles on its sides, `LAYER` apart, given their unit normals.

    It is asked of planes along one of them, along an edge of each, and across one of them along an edge of its own.
    """
    if _parted(first, second, one[0], one[1], one[2]) or _parted(first, second, other[0], other[1], other[2]):
        return True
    for i in range(3):
        a, b, c = _edge(first, i)
        d, e, f = _edge(second, i)
        if _parted_across(first, second, one[0], one[1], one[2], a, b, c):
            return True
        if _parted_across(first, second, other[0], other[1], other[2], d, e, f):
            return True
    for i in range(3):
        a, b, c = _edge(first, i)
        for j in range(3):
            d, e, f = _edge(second, j)
            if _parted_across(first, second, a, b, c, d, e, f):
                return True
    return False


@compiled
def _edge(triangle: Array, number: int) -> tuple[float, float, float]:
    start, end = number, (number + 1) % 3
    return (
        triangle[end, 0] - triangle[start, 0],
        triangle[end, 1] - triangle[start, 1],
        triangle[end, 2] - triangle[start, 2],
    )


@compiled
def _parted_across(first: Array, second: Array, a: float, b: float, c: float, d: float, e: float, f: float) -> bool:
    """Whether two triangles are more than `LAYER` apart in the direction across two that are not parallel."""
    x, y, z = b * f - c * e, c * d - a * f, a * e - b * d
    length = np.sqrt(x * x + y * y + z * z)
    if length <= _PARALLEL * np.sqrt((a * a + b * b + c * c) * (d * d + e * e + f * f)):
        return False
    return _parted(first, second, x / length, y / length, z / length)


@compiled
def _parted(first: Array, second: Array, x: float, y: float, z: float) -> bool:
    """Whether two triangles are more than `LAYER` apart in a direction of unit length."""
    low, high, other_low, other_high = np.inf, -np.inf, np.inf, -np.inf
    for k in range(3):
        place = first[k, 0] * x + first[k, 1] * y + first[k, 2] * z
        low, high = min(low, place), max(high, place)
        place = second[k, 0] * x + second[k, 1] * y + second[k, 2] * z
        other_low, other_high = min(other_low, place), max(other_high, place)
    return low > other_high + LAYER or other_low > high + LAYER


@compiled
def _pierced(triangle: Array, normal: Array, other: Array, common: int) -> bool:
    """Whether a triangle is met by the edge, opposite a common corner, of another one that does not lie on it.

    What comes within `LAYER` of it meets it: on which side of it an end that touches it is, is a matter of rounding.
    """
    start, end = other[(common + 1) % 3], other[(common + 2) % 3]
    first, second = _height(triangle, normal, start), _height(triangle, normal, end)
    if min(abs(first), abs(second)) > LAYER and first * second > 0.0:
        return False
    if max(abs(first), abs(second)) <= LAYER:
        return False
    return not _avoided(triangle, normal, start, end)
