"""What mesh files of every kind hold: corners and triangles as they stand there, and what is painted on them."""

from __future__ import annotations

import io
import re
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from ..arrays import Array, Indices, Integers
from ..descriptions.mesh_damage import are_numbers, damage, off_rows, unreadable
from ..errors import FileError
from .obj_file import NONE, parse_obj
from .ply_colors import require_colors

MOST_BYTES = 200_000_000
"""Largest file that is read; text takes eight times its size in memory while it is read."""
MOST_TRIANGLES = 1_000_000
"""Most triangles of a file, of copies of its parts too."""
FARTHEST = 1e3
"""Distance of a corner from the origin of its file, m: no object or link is larger, and squares of it stay numbers."""


@dataclass(frozen=True)
class Paint:
    """What is painted on triangles, one entry a triangle."""

    groups: tuple[frozenset[str], ...] = ()
    """Names of objects, groups and parts that hold together."""
    group_of: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Index in `groups`, -1: none."""
    materials: tuple[str, ...] = ()
    """Names of the materials."""
    material_of: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Index in `materials`, -1: none."""
    colors: Array = field(default_factory=lambda: np.zeros((0, 3, 3)))
    """Red, green, blue at each corner, 0 to 255, not a number where there is none, shape (f, 3 corners, 3)."""
    sampled: bool = False
    """Whether colours are those of a texture."""

    def taken(self, faces: Indices) -> Paint:
        """Return the paint of some triangles; of an index -1 there is none."""
        bare = faces < 0
        return replace(
            self,
            group_of=np.where(bare, NONE, self.group_of[faces]),
            material_of=np.where(bare, NONE, self.material_of[faces]),
            colors=np.where(bare[:, None, None], np.nan, self.colors[faces]),
        )


@dataclass(frozen=True)
class MeshContent:
    """Triangles of a mesh file, parts placed as it places them, in its unit."""

    vertices: Array
    """Shape (v, 3)."""
    faces: Integers
    """Shape (f, 3)."""
    metres: float
    """In its unit, as the file says; 1 where it says nothing."""
    paint: Paint


def read_content(file: Path, content: bytes, most: int | None = None) -> MeshContent:
    """Return the triangles in the content of a mesh file.

    Args:
        file: its suffix tells the format.
        content: that it has.
        most: triangles that are taken, of copies of its parts too; by default `MOST_TRIANGLES`.

    Raises:
        FileError: it is too large or cannot be read, or a corner is no place.
    """
    if len(content) > MOST_BYTES:
        problem = f"has {len(content) / 1e6:.0f} MB; at most {MOST_BYTES / 1e6:.0f} MB are read"
        raise FileError(problem, file=file, remedy="Simplify the mesh")
    kind, most = file.suffix[1:].lower(), MOST_TRIANGLES if most is None else most
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the parsers, about what is judged here
            found = _of_obj(content) if kind == "obj" else _of_others(content, kind, most)
    except FileError as error:
        raise FileError(error.problem, file=file, remedy=error.remedy) from None
    except Exception as error:  # parsers that are given any bytes raise errors of any class
        raise unreadable(content, file) from error
    if not len(found.faces):
        cause = damage(content, kind)
        problem = "has no triangles" if cause is None else f"has no triangles: {cause}"
        raise FileError(problem, file=file, remedy="Is it of the kind that its suffix says?")
    return _required(found, file, most)


def require_near(corners: Array, file: Path, remedy: str) -> None:
    """Refuse corners that are farther from their origin than anything here is large.

    Args:
        corners: m, shape (..., 3).
        file: where they are from.
        remedy: what to look at.
    """
    if not (farthest := float(np.abs(corners).max())) <= FARTHEST:
        problem = f"has a corner that is {farthest:.3g} m from its origin, more than {FARTHEST:g} m"
        raise FileError(problem, file=file, remedy=remedy)


def _required(found: MeshContent, file: Path, most: int) -> MeshContent:
    """Refuse content that is no triangles."""
    _require_few(len(found.faces), most, file)
    corners = found.vertices[found.faces]  # every index was looked at
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if len(bad):
        problem = f"has corners that are not finite in {len(bad)} of its {len(corners)} triangles"
        problem += f"; the first is triangle {bad[0] + 1}, counted from 1"
        raise FileError(problem, file=file, remedy="Export it again, or remove them")
    return found


def _require_few(count: int, most: int, file: Path | None = None) -> None:
    if count > most:
        problem = f"has {count} triangles; at most {most} are taken"
        raise FileError(problem, file=file, remedy="Simplify the mesh: a tenth of a millimetre needs far fewer")


def _of_obj(content: bytes) -> MeshContent:
    read = parse_obj(content)
    colors = np.full((len(read.faces), 3, 3), np.nan) if read.colors is None else 255.0 * read.colors[read.faces]
    paint = Paint(read.groups, read.group_of, read.materials, read.material_of, colors)
    return MeshContent(read.vertices, read.faces, 1.0, paint)


def _require_whole_stl(content: bytes, most: int) -> None:
    """Refuse an STL file that is cut off: its parser takes a binary one for text, and drops the last part of a text.

    In a binary one the number of triangles comes after 80 bytes, and 50 bytes for each. A number beyond `most` is that
    of another kind.
    """
    told, there = int.from_bytes(content[80:84], "little"), max(0, (len(content) - 84) // 50)
    if content.lstrip()[:5].lower() != b"solid":
        if there < told <= most:
            raise FileError(f"is cut off: {there} of {told} triangles are there", remedy="Copy or export it again")
    elif there != told:
        text = content.lower()
        if text.rfind(b"endsolid") < text.rfind(b"vertex"):
            raise FileError("is cut off: its last part has no endsolid", remedy="Copy or export it again")


def _require_whole_ply(content: bytes) -> None:
    """Refuse the text of a PLY file that ends before all that its header announces: parsers take what is there."""
    header, end, rest = content.partition(b"end_header")
    if end and re.search(rb"^format\s+ascii\b", header, re.MULTILINE):
        announced = sum(int(count) for count in re.findall(rb"^element\s+\S+\s+(\d+)", header, re.MULTILINE))
        lines = sum(1 for line in rest.splitlines() if line.strip())
        if lines < announced:
            problem = f"is cut off: its header announces {announced} lines of numbers, and {lines} follow"
            raise FileError(problem, remedy="Export it again")


def _require_whole_off(content: bytes) -> None:
    """Refuse an OFF file that ends before all that it announces: its parser takes the faces that are there."""
    rows = off_rows(content)
    if rows and are_numbers(rows[0].split(), 2, np.int64):
        corners, faces = (int(word) for word in rows[0].split()[:2])
        if len(rows) - 1 < corners + faces:
            problem = f"is cut off: it announces {corners} corners and {faces} faces, and {len(rows) - 1} lines follow"
            raise FileError(problem, remedy="Copy or export it again")


def _of_others(content: bytes, kind: str, most: int) -> MeshContent:
    if kind == "ply":
        _require_whole_ply(content)
        require_colors(content)
    elif kind == "off":
        _require_whole_off(content)
    elif kind == "stl":
        _require_whole_stl(content, most)
    # Bytes, so that nothing is read but what was hashed: no textures and buffers in other files.
    scene: Any = trimesh.load_scene(io.BytesIO(content), file_type=kind, process=False)
    placed = [
        (name, T, scene.geometry[geometry], geometry)
        for name in scene.graph.nodes_geometry
        for T, geometry in (scene.graph[name],)
        if isinstance(scene.geometry[geometry], trimesh.Trimesh)
    ]
    _require_few(sum(len(mesh.faces) for _, _, mesh, _ in placed), most)
    vertices, faces, colors, offset, sampled = [], [], [], 0, False
    materials: dict[str, int] = {}
    groups: dict[frozenset[str], int] = {}
    material_of, group_of = [], []
    for name, T, mesh, geometry in placed:
        own, corners = np.array(mesh.faces, dtype=np.int64), np.array(mesh.vertices, dtype=np.float64)
        if len(own) and not 0 <= own.min() <= own.max() < len(corners):
            problem = f"has a triangle with the vertex {max(own.max(), -own.min())}, of {len(corners)}"
            raise FileError(problem, remedy="Export it again")
        if np.linalg.det(T[:3, :3]) < 0.0:
            own = own[:, ::-1]
        vertices.append(corners @ T[:3, :3].T + T[:3, 3])
        faces.append(own + offset)
        offset += len(corners)
        painted, of_texture = _colors(mesh)
        colors.append(painted)
        sampled |= of_texture
        label = str(getattr(getattr(mesh.visual, "material", None), "name", None) or "")
        material_of.append(np.full(len(own), materials.setdefault(label, len(materials)) if label else NONE))
        names = frozenset({str(name), str(geometry)})
        group_of.append(np.full(len(own), groups.setdefault(names, len(groups))))
    if not placed:
        return MeshContent(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), 1.0, Paint())
    paint = Paint(
        tuple(groups),
        np.concatenate(group_of),
        tuple(materials),
        np.concatenate(material_of),
        np.concatenate(colors),
        sampled,
    )
    return MeshContent(np.concatenate(vertices), np.concatenate(faces), _stated(scene), paint)


def _stated(scene: Any) -> float:
    """Return the metres in the unit that the file states, as COLLADA does; 1 where it states none."""
    units = {str(mesh.metadata.get("units", "")) for mesh in scene.geometry.values()}
    found = {float(match[1]) for unit in units if (match := re.fullmatch(r"([0-9.eE+-]+) \* meters", unit))}
    metres = found.pop() if len(found) == 1 else 1.0
    if not 0.0 < metres < np.inf:
        raise FileError(f"states a unit of {metres:g} m", remedy="Export it again in metres")
    return metres


def _colors(mesh: Any) -> tuple[Array, bool]:
    """Return the colours at the corners of a part's triangles, and whether they are those of a texture."""
    visual, count = mesh.visual, len(mesh.faces)
    if visual.kind == "face":
        return np.repeat(visual.face_colors[:, None, :3].astype(np.float64), 3, axis=1), False
    if visual.kind == "vertex":
        return visual.vertex_colors[mesh.faces][:, :, :3].astype(np.float64), False
    image = None
    if visual.kind == "texture" and visual.uv is not None:
        material = visual.material
        image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if image is None:
        return np.full((count, 3, 3), np.nan), False
    middle = np.asarray(visual.uv)[mesh.faces].mean(axis=1)
    sampled = trimesh.visual.color.uv_to_color(middle, image)[:, None, :3]
    return np.repeat(sampled.astype(np.float64), 3, axis=1), True
