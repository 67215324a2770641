"""Membership of what is painted on a mesh: the distance to the border of the paint, negative where there is none.

A point stands for the place q of the surface that is nearest to it. With b the place of the border nearest to q,

    m = |q - b|  if the triangle of q is painted, else  -|q - b|,

which is zero along the border from both sides. Its gradient is +-(q - b) / |q - b| within the plane of the triangle; on
the border itself the direction across it, into the paint.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import igl
import numpy as np

from ..arrays import Array, Integers, Mask
from ..descriptions.mesh_files import Unit
from ..descriptions.regions import COLORS_ALIKE, Painted
from ..descriptions.shapes import Mesh
from ..errors import LISTED, FileError, InputError, close_names
from .mesh_content import Paint
from .object_mesh import ObjectMesh, object_mesh

ON_BORDER = 1e-9
"""A point that is nearer to the border is on it, m."""
EVERYWHERE = 1.0
"""Membership where there is no border, since all is painted, m."""


class PaintedSurface:
    """A surface of which a part is painted.

    Args:
        mesh: the surface.
        painted: of its triangles, shape (f,).
    """

    def __init__(self, mesh: ObjectMesh, painted: Mask) -> None:
        self._vertices, self._faces, self._painted = mesh.vertices, mesh.faces, painted
        a, b, c = mesh.triangles.transpose(1, 0, 2)
        across = np.cross(b - a, c - a)
        self._normals = across / np.linalg.norm(across, axis=1)[:, None]
        self._border, self._inward = _border(mesh, painted, self._normals)
        self._tree, self._border_tree = igl.AABB(), igl.AABB()
        self._tree.init(self._vertices, self._faces)
        if len(self._border):
            self._border_tree.init(self._vertices, self._border)

    def membership(self, points: Array) -> tuple[Array, Array]:
        """Return the membership of points, shape (n, 3), m, shape (n,), and its gradient, shape (n, 3)."""
        if not len(self._border):
            return np.full(len(points), EVERYWHERE), np.zeros((len(points), 3))
        _, triangle, places = self._tree.squared_distance(self._vertices, self._faces, np.ascontiguousarray(points))
        squared, edge, nearest = self._border_tree.squared_distance(self._vertices, self._border, places)
        distances = np.sqrt(squared)
        sign = np.where(self._painted[triangle], 1.0, -1.0)
        apart = sign[:, None] * (places - nearest) / np.maximum(distances, ON_BORDER)[:, None]
        slopes = np.where((distances > ON_BORDER)[:, None], apart, self._inward[edge])
        normals = self._normals[triangle]
        return sign * distances, slopes - (slopes * normals).sum(axis=1)[:, None] * normals


def _border(mesh: ObjectMesh, painted: Mask, normals: Array) -> tuple[Integers, Array]:
    """Return the edges between painted triangles and others, shape (e, 2), and unit vectors into the paint there."""
    sides = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    ordered = np.sort(sides, axis=1)
    keys, edge = np.unique(ordered[:, 0] * len(mesh.vertices) + ordered[:, 1], return_inverse=True)
    of_paint = np.repeat(painted, 3)
    both = (np.bincount(edge, of_paint) > 0) & (np.bincount(edge, ~of_paint) > 0)
    owner = np.zeros(len(keys), dtype=np.int64)
    owner[edge[of_paint]] = np.flatnonzero(of_paint)
    found = sides[owner[both]]
    along = mesh.vertices[found[:, 1]] - mesh.vertices[found[:, 0]]
    inward = np.cross(normals[owner[both] // 3], along)
    return np.ascontiguousarray(found), inward / np.linalg.norm(inward, axis=1)[:, None]


def painted_surface(region: Painted) -> PaintedSurface:
    """Return the surface that carries what is painted; the last ones are kept.

    Args:
        region: with its file.

    Raises:
        FileError: the file cannot be used, or nothing in it is painted so.
    """
    if region.mesh is None:
        raise InputError("names no file", key="file", remedy="Take the region of the task from `Scene.region_of`")
    mesh = region.mesh
    key = (mesh.file, mesh.sha256, mesh.scales, mesh.unit, mesh.largest_hole)
    return _made(*key, region.color, region.material, region.group)


@lru_cache(maxsize=32)
def _made(
    file: Path,
    sha256: str | None,
    scales: tuple[float, float, float],
    unit: Unit | None,
    largest_hole: float,
    color: tuple[int, int, int] | None,
    material: str | None,
    group: str | None,
) -> PaintedSurface:
    shape = Mesh(file=file, sha256=sha256, scale=scales, unit=unit, largest_hole=largest_hole)
    mesh = object_mesh(shape)
    region = Painted(file=file, sha256=sha256, color=color, material=material, group=group)
    painted = painted_triangles(mesh.paint, region)
    if not painted.any():
        raise FileError(
            f"has nothing that is painted with {region.words}", file=file, remedy=_known(mesh.paint, region)
        )
    return PaintedSurface(mesh, painted)


def painted_triangles(paint: Paint, region: Painted) -> Mask:
    """Return which triangles are painted as a region says, shape (f,)."""
    return np.asarray(np.logical_and.reduce(list(_chosen(paint, region).values())), dtype=bool)


def _chosen(paint: Paint, region: Painted) -> dict[str, Mask]:
    """Return which triangles each key of a region that is given chooses by itself, shape (f,)."""
    found = dict[str, Mask]()
    if region.color is not None:
        alike = np.abs(paint.colors - np.array(region.color)).max(axis=2) <= COLORS_ALIKE  # not where there is none
        found["color"] = alike.sum(axis=1) >= 2
    if region.material is not None:
        found["material"] = np.array([*(name == region.material for name in paint.materials), False])[paint.material_of]
    if region.group is not None:
        found["group"] = np.array([*(region.group in names for names in paint.groups), False])[paint.group_of]
    return found


def _known(paint: Paint, region: Painted) -> str:
    """Return a remedy that names what is painted."""
    there = {key: bool(chosen.any()) for key, chosen in _chosen(paint, region).items()}
    if all(there.values()):
        together, some = ("both", "either") if len(there) == 2 else ("all three", "one of them")
        return f"Each is there, but no triangle has {together}; an `any_of` of regions takes what has {some}"
    if not there.get("material", True):
        return _names("material", region.material, _materials(paint))
    if not there.get("group", True):
        names = {name for group in np.unique(paint.group_of[paint.group_of >= 0]) for name in paint.groups[group]}
        return _names("group", region.group, names)
    return _colors(paint)


def _names(kind: str, wanted: str | None, names: set[str]) -> str:
    return close_names(wanted, names, f"Its {kind}s") if names else f"It has no {kind}s"


def _materials(paint: Paint) -> set[str]:
    return {paint.materials[material] for material in np.unique(paint.material_of[paint.material_of >= 0])}


def _colors(paint: Paint) -> str:
    """Return a remedy that names colours of triangles, or what may be meant in their place."""
    colors, counts = np.unique(np.round(paint.colors[:, 0]), axis=0, return_counts=True)
    known = [color for color in colors[np.argsort(-counts)] if np.isfinite(color).all()][:4]
    if known:
        return "Its colours: " + ", ".join("#" + bytes(color.astype(np.uint8)).hex() for color in known)
    if materials := sorted(_materials(paint)):
        named = ", ".join(materials[:LISTED]) + (", ..." if len(materials) > LISTED else "")
        return f"No triangle has a colour of its own; what a material colours is chosen with `material`: {named}"
    return "No triangle has a colour; PLY files keep colours of faces"
