"""What is painted on a mesh, read apart from the optimiser's reading: how deep points are in it, m.

The depth of a point is that of its foot, the place of the surface that is nearest to it: the distance of the foot to
the border of the paint, negative where the triangle of the foot is not painted.
"""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import igl
import numpy as np
import trimesh

from ..arrays import Array, Integers, Mask
from ..descriptions.mesh_damage import unreadable
from ..descriptions.mesh_files import metres_in_unit
from ..descriptions.regions import COLORS_ALIKE, Painted

ALIKE = 1e-6
"""Corners that are nearer than this part of the extent are one."""
EVERYWHERE = 1.0
"""Depth of all points where all triangles are painted, m; if none is, less that."""


@dataclass(frozen=True)
class Part:
    """Triangles of a mesh file that have the same material and the same groups, in its unit."""

    corners: Array
    """Shape (n, 3 corners, 3)."""
    colors: Array | None
    """Red, green and blue of the corners from 0 to 255, shape (n, 3 corners, 3); None: they have none."""
    material: str | None
    groups: frozenset[str]


@dataclass(frozen=True)
class PaintedTriangles:
    """A surface of which a part is painted."""

    vertices: Array
    """Shape (v, 3), m."""
    faces: Integers
    """Shape (f, 3)."""
    painted: Mask
    """Shape (f,)."""
    border: Integers
    """Edges between painted triangles and others, shape (e, 2)."""

    @cached_property
    def _trees(self) -> tuple[Any, Any]:
        surface, border = igl.AABB(), igl.AABB()
        surface.init(self.vertices, self.faces)
        if len(self.border):
            border.init(self.vertices, self.border)
        return surface, border

    def depths(self, points: Array) -> Array:
        """Return the depths of points, shape (n, 3), in the paint, shape (n,)."""
        surface, border = self._trees
        _, triangles, feet = surface.squared_distance(self.vertices, self.faces, np.ascontiguousarray(points))
        inside = self.painted[triangles]
        if not len(self.border):
            return np.where(inside, EVERYWHERE, -EVERYWHERE)
        squared, _, _ = border.squared_distance(self.vertices, self.border, feet)
        return np.asarray(np.where(inside, 1.0, -1.0) * np.sqrt(squared))


def painted_depths(region: Painted, points: Array) -> Array:
    """Return how deep points, shape (n, 3), are in a painted region, m, negative outside, shape (n,).

    Raises:
        FileError: the file cannot be read, or is not that which was described.
    """
    return _triangles(region.model_copy(update={"beyond": 0.0})).depths(points) + region.beyond


@lru_cache(maxsize=32)
def _triangles(region: Painted) -> PaintedTriangles:
    mesh = region.mesh
    if mesh is None:
        raise ValueError("the region names no file")
    content, kind = mesh.content(), mesh.file.suffix[1:].lower()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of parsers
            parts, stated = (_of_obj(content), 1.0) if kind == "obj" else _of_scene(content, kind)
    except Exception as error:  # parsers that are given any bytes raise errors of any class
        raise unreadable(content, mesh.file) from error
    corners = np.concatenate([part.corners for part in parts]) * mesh.scales
    extent = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    painted = np.concatenate([_is_painted(part, region) for part in parts])
    return _joined(corners * metres_in_unit(mesh.unit, stated, extent), painted)


def _is_painted(part: Part, region: Painted) -> Mask:
    count = len(part.corners)
    if region.material not in (None, part.material) or (region.group and region.group not in part.groups):
        return np.zeros(count, dtype=bool)
    if region.color is None:
        return np.ones(count, dtype=bool)
    if part.colors is None:
        return np.zeros(count, dtype=bool)
    alike = (np.abs(part.colors - region.color) <= COLORS_ALIKE).all(axis=2)
    return np.asarray(np.count_nonzero(alike, axis=1) >= 2)


def _joined(corners: Array, painted: Mask) -> PaintedTriangles:
    """Return triangles that share their corners, without those that have no area."""
    flat = corners.reshape(-1, 3)
    step = ALIKE * float(np.ptp(flat, axis=0).max())
    _, first, index = np.unique(np.round(flat / step), axis=0, return_index=True, return_inverse=True)
    faces = index.reshape(-1, 3).astype(np.int64)
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    faces, painted = faces[whole], painted[whole]
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    marks = np.tile(painted, 3)
    order = np.lexsort([edges[:, 1], edges[:, 0]])
    edges, marks = edges[order], marks[order]
    starts = np.flatnonzero(np.any(np.diff(edges, axis=0, prepend=-1), axis=1))
    some, all_ = np.logical_or.reduceat(marks, starts), np.logical_and.reduceat(marks, starts)
    return PaintedTriangles(flat[first], faces, painted, np.ascontiguousarray(edges[starts[some & ~all_]]))


def _of_scene(content: bytes, kind: str) -> tuple[list[Part], float]:
    scene: Any = trimesh.load_scene(io.BytesIO(content), file_type=kind, process=False)
    stated = 1.0 if scene.units is None else float(trimesh.units.unit_conversion(scene.units, "meters"))
    parts = []
    for node in scene.graph.nodes_geometry:
        T, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if not isinstance(mesh, trimesh.Trimesh):
            continue
        corners = trimesh.transform_points(mesh.triangles.reshape(-1, 3), T).reshape(-1, 3, 3)
        name = getattr(getattr(mesh.visual, "material", None), "name", None)
        parts.append(Part(corners, _colors(mesh), name, frozenset({str(node), str(geometry)})))
    return parts, stated


def _colors(mesh: Any) -> Array | None:
    visual = mesh.visual
    if visual.kind == "face":
        return np.asarray(np.stack([visual.face_colors[:, :3]] * 3, axis=1), dtype=np.float64)
    if visual.kind == "vertex":
        return np.asarray(visual.vertex_colors[:, :3][mesh.faces], dtype=np.float64)
    if visual.kind != "texture" or visual.uv is None:
        return None
    texture = getattr(visual.material, "image", None) or getattr(visual.material, "baseColorTexture", None)
    if texture is None:
        return None
    middle = np.mean([np.asarray(visual.uv)[corner] for corner in mesh.faces.T], axis=0)
    found = np.asarray(trimesh.visual.color.uv_to_color(middle, texture), dtype=np.float64)[:, :3]
    return np.stack([found] * 3, axis=1)


def _of_obj(content: bytes) -> list[Part]:
    """Return the triangles of an OBJ file, those of the same labels together."""
    rows: list[list[float]] = []
    material: str | None = None
    thing, groups = frozenset[str](), frozenset[str]()
    found: dict[tuple[str | None, frozenset[str]], list[list[int]]] = {}
    for line in content.decode("utf-8", "replace").replace("\\\r\n", " ").replace("\\\n", " ").splitlines():
        words = line.split() or [""]
        rest = " ".join(words[1:])
        if words[0] == "v":
            rows.append([float(word) for word in words[1:7]])
        elif words[0] == "usemtl":
            material = rest
        elif words[0] == "o":
            thing, groups = frozenset({rest}), frozenset()
        elif words[0] == "g":
            groups = frozenset(words[1:])
        elif words[0] == "f":
            numbers = [int(word.split("/")[0]) for word in words[1:]]
            polygon = [number - 1 if number > 0 else len(rows) + number for number in numbers]
            triangles = found.setdefault((material, thing | groups), [])
            triangles += [[polygon[0], *pair] for pair in pairwise(polygon[1:])]
    places = np.array([row[:3] for row in rows])
    colors = 255.0 * np.array([row[3:] for row in rows]) if all(len(row) == 6 for row in rows) else None
    return [
        Part(places[triangles], None if colors is None else colors[triangles], *labels)
        for labels, triangles in found.items()
    ]
