"""Which triangles of a body have one side of it in front of them and another behind, all over.

The winding number is the same at both ends of a way that crosses no triangle. So it is the same all along the front of
a triangle, and all along its back, unless another triangle crosses it; then one look beside its middle tells of every
point that has its foot on it whether that is inside. What lies on a triangle, within `LAYER` of its plane, does not
cross it; what comes nearer to it from elsewhere than that counts as crossing. Where the surface has openings, the
winding number changes along the way by the solid angle of the openings over 4 pi: by less than a tenth at twice the
radius of a ball around one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..arrays import Array, Indices, Integers, Mask
from ..compiled import compiled

LAYER = 1e-7
"""Distance from a triangle within which other ones lie on it or touch it, m."""
_PARALLEL = 1e-9
"""Length of the cross product of directions below which it has none."""
_CLEAR = 2.0
"""Radius around an opening within which the winding number is asked, in parts of its own."""


def crossed(vertices: Array, faces: Integers) -> Mask:
    """Return which triangles others cross, or touch otherwise than in corners and edges that they share, shape (f,).

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    low, high = corners.min(axis=1), corners.max(axis=1)
    axis = int(np.ptp(vertices, axis=0).argmax())
    order = low[:, axis].argsort(kind="stable")
    found = np.zeros(len(faces), dtype=np.bool_)
    found[order] = _crossed(
        corners[order], normals[order], np.ascontiguousarray(faces[order]), low[order], high[order], axis
    )
    return found


@compiled
def _crossed(corners: Array, normals: Array, faces: Integers, low: Array, high: Array, axis: int) -> Mask:
    """Return which triangles others cross, of triangles in the order of the low ends of their boxes along an axis."""
    found = np.zeros(len(faces), dtype=np.bool_)
    for i in range(len(faces)):
        for j in range(i + 1, len(faces)):
            if low[j, axis] > high[i, axis] + LAYER:
                break
            if found[i] and found[j]:
                continue
            near = True
            for k in range(3):
                near &= low[i, k] <= high[j, k] + LAYER and low[j, k] <= high[i, k] + LAYER
            if not near:
                continue
            common, own, other = 0, 0, 0
            for a in range(3):
                for b in range(3):
                    if faces[i, a] == faces[j, b]:
                        common, own, other = common + 1, a, b
            if common == 0:
                if not _apart(corners[i], normals[i], corners[j], normals[j]):
                    found[i] |= not _on(corners[i], normals[i], corners[j])
                    found[j] |= not _on(corners[j], normals[j], corners[i])
            elif common == 1 and (
                _pierced(corners[i], normals[i], corners[j], other) or _pierced(corners[j], normals[j], corners[i], own)
            ):
                found[i] = found[j] = True
    return found


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
    if _parted(first, second, one) or _parted(first, second, other):
        return True
    for i in range(3):
        edge = first[(i + 1) % 3] - first[i]
        if _parted(first, second, _cross(one, edge)):
            return True
        if _parted(first, second, _cross(other, second[(i + 1) % 3] - second[i])):
            return True
        for j in range(3):
            if _parted(first, second, _cross(edge, second[(j + 1) % 3] - second[j])):
                return True
    return False


@compiled
def _cross(a: Array, b: Array) -> Array:
    """Return the direction across two, unit length; zero of parallel ones."""
    c = np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
    length = np.sqrt((c * c).sum())
    if length <= _PARALLEL * np.sqrt((a * a).sum() * (b * b).sum()):
        return np.zeros(3)
    return np.asarray(c / length)


@compiled
def _parted(first: Array, second: Array, along: Array) -> bool:
    """Whether two triangles are more than `LAYER` apart in a direction."""
    low, high, other_low, other_high = np.inf, -np.inf, np.inf, -np.inf
    for k in range(3):
        place = first[k, 0] * along[0] + first[k, 1] * along[1] + first[k, 2] * along[2]
        low, high = min(low, place), max(high, place)
        place = second[k, 0] * along[0] + second[k, 1] * along[1] + second[k, 2] * along[2]
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
    edge = np.stack((start, end, end))
    return not _apart(triangle, normal, edge, _cross(normal, end - start))


def barycentric(points: Array, a: Array, b: Array, c: Array) -> Array:
    """Return the shares of the corners of triangles in points of their planes, all of shape (n, 3)."""
    e, f, g = b - a, c - a, points - a
    ee, ef, ff = (e * e).sum(axis=1), (e * f).sum(axis=1), (f * f).sum(axis=1)
    eg, fg = (e * g).sum(axis=1), (f * g).sum(axis=1)
    area = ee * ff - ef * ef
    v, w = (ff * eg - ef * fg) / area, (ee * fg - ef * eg) / area
    return np.column_stack([1.0 - v - w, v, w])


def neighbours(faces: Integers) -> Indices:
    """Return the triangle at the edge opposite each corner; -1 where there is none or more than one, shape (f, 3)."""
    owner = np.tile(np.arange(len(faces)), 3)
    corner = np.repeat(np.arange(3), len(faces))
    edges = np.sort(np.concatenate([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]]), axis=1)
    order = np.lexsort(edges.T)
    found = edges[order]
    new = np.concatenate([[True], (found[1:] != found[:-1]).any(axis=1), [True]])
    starts = np.flatnonzero(new)
    pairs = starts[:-1][np.diff(starts) == 2]
    beside = np.full((len(faces), 3), -1, dtype=np.intp)
    for one, other in ((order[pairs], order[pairs + 1]), (order[pairs + 1], order[pairs])):
        beside[owner[one], corner[one]] = owner[other]
    return beside


def one_for_all(faces: Integers, beside: Indices, plain: Mask, sizes: Array) -> tuple[Indices, Indices]:
    """Return triangles that tell of all which side of them is inside: of plain ones that hang together, the largest.

    These face the same way, and have an edge in common which is that of no other one.

    Args:
        faces: shape (f, 3).
        beside: their neighbours, as of `neighbours`.
        plain: which are so, shape (f,).
        sizes: shape (f,).

    Returns:
        the triangles, shape (n,), and of each triangle the index of the one that tells of it, shape (f,).
    """
    one, corner = np.nonzero((beside >= 0) & plain[:, None] & plain[beside])
    other = beside[one, corner]
    along = faces[other] == faces[one, (corner + 1) % 3][:, None]
    against = np.roll(faces[other], 1, axis=1) == faces[one, (corner + 2) % 3][:, None]
    alike = (along & against).any(axis=1)  # each has the edge the other way round
    graph = coo_matrix((np.ones(int(alike.sum())), (one[alike], other[alike])), shape=(len(faces), len(faces)))
    _, group = connected_components(graph, directed=False)
    order = np.lexsort((sizes, group))
    last = np.append(group[order][1:] != group[order][:-1], True)
    return order[last], group


class Openings:
    """Balls around the openings of a surface, in which the winding number is asked for.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        alike, edge = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
        net = np.bincount(edge.ravel(), weights=np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0), minlength=len(alike))
        border = alike[net != 0.0]
        loops: list[Any] = trimesh.graph.connected_components(border, nodes=np.unique(border)) if len(border) else []
        boxes = [(vertices[loop].min(axis=0), vertices[loop].max(axis=0)) for loop in loops]
        self._balls = [(0.5 * (low + high), _CLEAR * 0.5 * float(np.linalg.norm(high - low))) for low, high in boxes]

    def near(self, points: Array, radii: Array | float = 0.0) -> Mask:
        """Return which points, shape (n, 3), or balls of some radii (m) around them, reach into one of the balls."""
        found = np.zeros(len(points), dtype=bool)
        for center, radius in self._balls:
            found |= ((points - center) ** 2).sum(axis=1) <= (radius + radii) ** 2
        return found
