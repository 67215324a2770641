"""A body that triangles enclose, convex or not: exact distances, footprint normals, clipped surfaces.

Written apart from `geometry`, which interpolates a lattice of distances. libigl finds nearest points on the original
triangles, and its winding number says which points are inside, whatever small holes there are.

**Footprint normal.** With d the signed distance and G the density of the normal distribution N(0, sigma^2 I), the
footprint normal at p (`descriptions.mesh_contact`) is the direction of the gradient of the convolution

    (d * G)(p) = integral of d(p + sigma z) phi(z) dz,      phi the density of N(0, I)

Shifting the integration variable, q = p + sigma z, puts p into phi alone, whose gradient is -z phi(z), so that

    grad (d * G)(p) = 1 / sigma  integral of d(p + sigma z) z phi(z) dz

Gauss-Hermite quadrature along each axis, with nodes x_i and weights w_i of the weight exp(-x^2 / 2), makes it

    n  is parallel to  sum over i, j, k of w_i w_j w_k d(p + sigma z) z,     z = (x_i, x_j, x_k)

which needs distances only, no derivative of them, and is exact for polynomials d of degree 14 along each axis.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import igl
import numpy as np
import trimesh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from ..arrays import Array, Indices, Integers, Mask
from ..descriptions.mesh_contact import FACES, SIGMAS, THICK_SHARE
from .coal_bodies import hull_corners, hull_solid, triangle_tree

NODES = 8
"""Of the quadrature along each axis."""
FINE = 5_000
"""Vertices of a mesh of which no hull is made."""
NEIGHBOURS = 9
"""Of points, itself among them, that are looked at to find what no triangle parts."""
BESIDE = 1e-6
"""How far beside a triangle it is asked whether there is an outside, m."""
PLACES = 6
"""Along an edge, at which it is asked where a triangle has none at its middle."""


def _quadrature() -> tuple[Array, Array]:
    """Return the nodes z, shape (n, 3), and the weights times z, shape (n, 3)."""
    x, w = np.polynomial.hermite_e.hermegauss(NODES)
    nodes = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    weights = np.stack(np.meshgrid(w, w, w, indexing="ij"), axis=-1).reshape(-1, 3).prod(axis=1)
    return nodes, weights[:, None] * nodes


def _places() -> Array:
    """Return shares of the corners of a triangle, its middle first, shape (n, 3)."""
    grid = [(i, j, PLACES - 1 - i - j) for i in range(PLACES) for j in range(PLACES - i)]
    shares = (np.array(grid) + 0.1) / (PLACES - 1 + 0.3)
    return np.vstack([np.full(3, 1.0 / 3.0), shares])


_NODES, _WEIGHTED = _quadrature()
_PLACES = _places()


class TriangleBody:
    """A body as triangles; all in the frame of these, m.

    Args:
        vertices: shape (v, 3); one vertex for all triangles that meet there.
        faces: shape (f, 3); corners counter-clockwise seen from outside.
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        self.vertices = np.ascontiguousarray(vertices, dtype=np.float64)
        self._around = np.ascontiguousarray(faces, dtype=np.int64)
        self.middle = 0.5 * (self.vertices.min(axis=0) + self.vertices.max(axis=0))
        """Of the bounding box, shape (3,)."""
        self._winding = igl.FastWindingNumberBVH()
        self._winding.init(self.vertices, self._around)
        self.faces = np.ascontiguousarray(self._around[self._bounding()])
        """Without those that lie wholly inside, where parts overlap, shape (f, 3)."""
        self._skin = _aabb(self.vertices, self.faces)
        self._all = self._skin if len(self.faces) == len(self._around) else _aabb(self.vertices, self._around)

    def contains(self, points: Array) -> Mask:
        """Whether points, shape (n, 3), are inside: their winding number is above a half."""
        return np.asarray(self._winding.winding_number(np.ascontiguousarray(points)) > 0.5)

    def distances(self, points: Array) -> Array:
        """Signed distances of points, shape (n, 3), negative inside, shape (n,).

        From outside all triangles count; from inside, those that bound the body.
        """
        found: Array = np.sqrt(self._all.squared_distance(self.vertices, self._around, points)[0])
        inside = self._inside(points, found)
        if self._skin is self._all:
            found[inside] *= -1.0
        else:
            found[inside] = -np.sqrt(self._skin.squared_distance(self.vertices, self.faces, points[inside])[0])
        return found

    def _inside(self, points: Array, apart: Array) -> Mask:
        """Whether points are inside: `contains`, asked for one of all those that no triangle parts.

        No triangle enters the ball around a point with its distance as the radius. So none crosses the way between two
        points that are less apart than the sum of their distances.

        Args:
            points: shape (n, 3).
            apart: distance of each to the nearest triangle, shape (n,).
        """
        shape = (len(points), min(NEIGHBOURS, len(points)))
        ways, others = (part.reshape(shape) for part in KDTree(points).query(points, k=shape[1]))
        one, which = np.nonzero(ways < apart[:, None] + apart[others])
        joined = coo_array((np.ones(len(one)), (one, others[one, which])), shape=(len(points), len(points)))
        count, group = connected_components(joined, directed=False)
        asked = np.empty(count, dtype=np.intp)
        order = np.argsort(apart)
        asked[group[order]] = order  # the last one of each group, which is farthest from all triangles
        return np.asarray(self.contains(points[asked])[group])

    def outward(self, point: Array) -> Array:
        """Footprint normal at a point, unit length, outward, shape (3,); not a number where it has no direction."""
        slope = self.distances(point + self.sigma * _NODES) @ _WEIGHTED
        length = float(np.linalg.norm(slope))
        return np.asarray(slope / length) if length > 0.0 else np.full(3, np.nan)

    def _bounding(self) -> Mask:
        """Return which triangles have an outside next to them, on one of their sides at one of many places."""
        corners = self.vertices[self._around]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        step = BESIDE * across / np.linalg.norm(across, axis=1)[:, None]
        bounding = np.zeros(len(corners), dtype=bool)
        for shares in _PLACES:
            for side in (1.0, -1.0):
                rest = np.flatnonzero(~bounding)
                bounding[rest] = ~self.contains(shares @ corners[rest] + side * step[rest])
        return bounding

    @cached_property
    def centroid(self) -> Array:
        """Centre of mass of the body filled evenly, shape (3,): of tetrahedra from the middle, with signed volumes."""
        a, b, c = (self.vertices - self.middle)[self._around].transpose(1, 0, 2)
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
        return np.asarray(self.middle + 0.25 * volumes @ (a + b + c) / volumes.sum())

    @cached_property
    def sigma(self) -> float:
        """Of the footprint normal, m: the largest than which the body is thick enough (`descriptions.mesh_contact`)."""
        chosen = self.vertices[self._around[:: -(-len(self._around) // FACES)]]
        across = np.cross(chosen[:, 1] - chosen[:, 0], chosen[:, 2] - chosen[:, 0])
        areas = np.linalg.norm(across, axis=1)
        centroids, normals = chosen.mean(axis=1), across / areas[:, None]
        for sigma in SIGMAS:
            thick = self.contains(centroids - sigma * normals) & self.contains(centroids - 2.0 * sigma * normals)
            if areas[thick].sum() >= THICK_SHARE * areas.sum():
                return sigma
        return SIGMAS[-1]

    @cached_property
    def solid(self) -> Any:
        """Coal's tree of the triangles."""
        return triangle_tree(self.vertices, self._around)

    @cached_property
    def hull(self) -> Any | None:
        """Coal's convex hull, or what is a little larger; None of what is flat, or fine: its tree is as quick."""
        return hull_solid(hull_corners(self.vertices)) if len(self.vertices) <= FINE else None

    @cached_property
    def members(self) -> Array:
        """One vertex of every connected part, shape (parts, 3)."""
        edges = np.concatenate([self.faces[:, :2], self.faces[:, 1:]])
        groups = trimesh.graph.connected_components(edges, nodes=np.unique(self.faces))
        return np.array([self.vertices[group[0]] for group in groups])

    def clipped(self, normals: Array, offsets: Array) -> tuple[Array, Indices]:
        """Return what of the surface is in a convex region, as triangles.

        Args:
            normals: outward normals n of the region, shape (m, 3).
            offsets: d, inside n . p <= d, shape (m,).

        Returns:
            triangles, shape (n, 3 corners, 3), and the number of the face that each belongs to, shape (n,).
        """
        outside = np.zeros(len(self.vertices), dtype=np.uint64)
        for k, (normal, offset) in enumerate(zip(normals, offsets, strict=True)):
            outside |= (self.vertices @ normal > offset).astype(np.uint64) << np.uint64(k)
        a, b, c = outside[self.faces].T
        numbers = np.flatnonzero((a & b & c) == 0)
        triangles = self.vertices[self.faces[numbers]]
        for normal, offset in zip(normals, offsets, strict=True):
            triangles, kept = _cut(triangles, normal, float(offset))
            numbers = numbers[kept]
        return triangles, numbers


def _aabb(vertices: Array, faces: Integers) -> Any:
    tree = igl.AABB()
    tree.init(vertices, faces)
    return tree


def _cut(triangles: Array, normal: Array, offset: float) -> tuple[Array, Indices]:
    """Return what of triangles is in a half-space, as triangles, and of which one each is a part."""
    heights = triangles @ normal - offset
    inside = heights <= 0.0
    count = inside.sum(axis=1)
    found, owners = [triangles[count == 3]], [np.flatnonzero(count == 3)]
    for many in (1, 2):  # corners inside; the odd one out comes first
        chosen = np.flatnonzero(count == many)
        odd = (inside if many == 1 else ~inside)[chosen].argmax(axis=1)
        order = (odd[:, None] + np.arange(3)) % 3
        (a, b, c) = np.take_along_axis(triangles[chosen], order[:, :, None], axis=1).transpose(1, 0, 2)
        (ha, hb, hc) = np.take_along_axis(heights[chosen], order, axis=1).T
        ab = a + (ha / (ha - hb))[:, None] * (b - a)
        ac = a + (ha / (ha - hc))[:, None] * (c - a)
        parts = [(a, ab, ac)] if many == 1 else [(ab, b, c), (ab, c, ac)]
        found += [np.stack(part, axis=1) for part in parts]
        owners += [chosen] * len(parts)
    return np.concatenate(found), np.concatenate(owners)
