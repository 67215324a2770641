"""A body that triangles enclose, convex or not: exact distances, footprint normals, clipped surfaces.

Written apart from `geometry`, which interpolates a lattice of distances. libigl finds nearest points on the original
triangles, and its winding number says which points are inside, whatever small holes there are.

**Footprint normal.** With d the signed distance and G the density of the normal distribution N(0, sigma^2 I), the
footprint normal at p (`descriptions.mesh_contact`) is the direction of the gradient of the convolution

    (d * G)(p) = integral of d(p + sigma z) phi(z) dz,      phi the density of N(0, I)

Shifting the integration variable, q = p + sigma z, puts p into phi alone, whose gradient is -z phi(z), so that

    grad (d * G)(p) = 1 / sigma  integral of d(p + sigma z) z phi(z) dz

The mean over a lattice of nodes z, body-centred cubic with cubes of edge 1, makes it

    n  is parallel to  sum over z of d(p + sigma z) z exp(-|z|^2 / 2),     |z| <= 4

which needs distances only, no derivative of them. A lattice sum errs by the waves in what is summed that look constant
on the lattice. The longest of them measure 1 / sqrt(2), and the kinks that a distance has at edges and in the middle of
walls hold little of them. The lattice is turned, to lie along no face of a body whose faces lie along its axes.

**Inside.** Large triangles are looked at in pieces (`pieces`). The piece that a point has its foot on, the nearest
point of all pieces, tells whether it is inside (`plain_faces`), in most places. Where it does not, as next to openings,
the winding number is asked for.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache, cached_property
from typing import Any

import igl
import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from ..array_cache import kept
from ..arrays import Array, Indices, Integers, Mask
from ..descriptions.mesh_contact import FACES, SIGMAS, THICK_SHARE
from ..disk import digest
from .coal_bodies import hull_corners, hull_solid, triangle_tree
from .filled import Filled, closed, counted_again, enclosed
from .free_balls import sides
from .looks import seen
from .openings import Openings
from .pieces import in_pieces
from .plain_faces import Sides, Triangles

REACH = 4.0
"""Of the lattice of the footprint normal, in sigma."""
TURN = (0.5, 0.3, 0.7)
"""Axis of the lattice's turn, times its angle, rad; no special one."""
VERSION = 7
"""Of what is kept of a body; to be raised with every change of how it is made."""
FINE = 5_000
"""Vertices of a mesh of which no hull is made."""
PIECE, PIECES = 0.005, 30
"""Longest edge of pieces, m; of a large body its extent divided by so much, if that is more."""


def _quadrature() -> tuple[Array, Array]:
    """Return the nodes z, shape (n, 3), and the weights times z, shape (n, 3)."""
    steps = np.arange(-math.ceil(REACH), math.ceil(REACH) + 1.0)
    cubes = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    nodes = np.concatenate([cubes, cubes + 0.5])
    nodes = Rotation.from_rotvec(TURN).apply(nodes[(nodes * nodes).sum(axis=1) <= REACH * REACH])
    return nodes, np.exp(-0.5 * (nodes * nodes).sum(axis=1))[:, None] * nodes


_NODES, _WEIGHTED = _quadrature()


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
        longest = max(PIECE, float(np.ptp(self.vertices, axis=0).max()) / PIECES)
        vertices, pieces, owners = in_pieces(self.vertices, self._around, longest)
        self._whole = _Tree(vertices, pieces)
        self._winding = igl.FastWindingNumberBVH()
        self._winding.init(vertices, pieces)
        self._openings, triangles = Openings(self.vertices, self._around), Triangles(vertices, pieces)

        def look() -> Mapping[str, Any]:
            return seen(triangles, self._openings, lambda points: self._whole.nearest(points)[0], self.contains)

        self._sides = Sides(triangles, self._openings, kept("bodies", self._key(), look, dict, dict))
        bounding = self._sides.bounding
        self.faces = np.ascontiguousarray(self._around[np.unique(owners[bounding])])
        """Without those that lie wholly inside, where parts overlap, shape (f, 3)."""
        self._skin = self._whole if bounding.all() else _Tree(vertices, np.ascontiguousarray(pieces[bounding]))

    def _key(self) -> str:
        content = self.vertices.tobytes() + self._around.tobytes()
        return digest(b"%d %d " % (VERSION, len(self.vertices)) + content)[:32]

    def contains(self, points: Array) -> Mask:
        """Whether points, shape (n, 3), are inside: their winding number is above a half."""
        return np.asarray(self._winding.winding_number(np.ascontiguousarray(points)) > 0.5)

    def distances(self, points: Array, below: float = math.inf) -> Array:
        """Signed distances of points, shape (n, 3), negative inside, shape (n,).

        From outside all triangles count; from inside, those that bound the body. Points that cannot be so deep inside
        that their distance is less than `below` (m) may come as if they were outside.
        """
        points = np.ascontiguousarray(points)
        found, numbers, feet = self._whole.nearest(points)
        inside = np.zeros(len(points), dtype=bool)
        deep = np.flatnonzero((-found < below) | ~self._sides.bounding[numbers])
        told, side = self._sides.told(points[deep], numbers[deep], feet[deep])
        inside[deep] = sides(points[deep], found[deep], told, side, self._openings, self.contains)
        found[inside] *= -1.0
        hidden = inside & ~self._sides.bounding[numbers]
        found[hidden] = -self._skin.nearest(points[hidden])[0]
        return found

    def _inside(self, points: Array, numbers: Indices, feet: Array) -> Mask:
        """Whether points are inside, given the pieces that are nearest to them and their feet on these."""
        told, inside = self._sides.told(points, numbers, feet)
        inside[~told] = self.contains(points[~told])
        return inside

    def outward(self, point: Array) -> Array:
        """Footprint normal at a point, unit length, outward, shape (3,); not a number where it has no direction."""
        slope = self.distances(point + self.sigma * _NODES) @ _WEIGHTED
        length = float(np.linalg.norm(slope))
        return np.asarray(slope / length) if length > 0.0 else np.full(3, np.nan)

    @cached_property
    def filled(self) -> Filled:
        """Integrals over the body, openings closed; what parts share counts once."""
        vertices, faces = closed(self.vertices, self._around)
        whole = enclosed(vertices, faces)
        if self._sides.bounding.all():
            return whole
        winding = igl.FastWindingNumberBVH()
        winding.init(vertices, faces)
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return whole.less(counted_again(lambda points: np.rint(winding.winding_number(points)), low, high))

    @cached_property
    def sigma(self) -> float:
        """Of the footprint normal, m: the largest than which the body is thick enough (`descriptions.mesh_contact`)."""
        return kept(
            "bodies", f"{self._key()}-sigma", self._sigma, lambda found: {"sigma": found}, lambda of: float(of["sigma"])
        )

    def _sigma(self) -> float:
        chosen = self.vertices[self._around[:: -(-len(self._around) // FACES)]]
        across = np.cross(chosen[:, 1] - chosen[:, 0], chosen[:, 2] - chosen[:, 0])
        areas = np.linalg.norm(across, axis=1)
        centroids, normals = chosen.mean(axis=1), across / areas[:, None]

        @cache  # the depths of one sigma are those of others, too
        def thick(depth: float) -> Mask:
            points = centroids - depth * normals
            return self._inside(points, *self._whole.nearest(points)[1:])

        def enough(found: Mask) -> bool:
            return bool(areas[found].sum() >= THICK_SHARE * areas.sum())

        for sigma in SIGMAS:
            if enough(thick(sigma)) and enough(thick(sigma) & thick(2.0 * sigma)):
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


class _Tree:
    """Tree of triangles.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
    """

    def __init__(self, vertices: Array, faces: Integers) -> None:
        self.vertices, self.faces = vertices, faces
        self._tree = igl.AABB()
        self._tree.init(vertices, faces)

    def nearest(self, points: Array) -> tuple[Array, Indices, Array]:
        """Return distances of points, shape (n, 3), to the nearest triangle, m, its number, and the feet on it."""
        squares, numbers, feet = self._tree.squared_distance(self.vertices, self.faces, np.ascontiguousarray(points))
        return np.sqrt(squares), numbers, feet


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
