"""OBJ files: corners and faces in their order, with the names of materials, objects and groups.

Corners are numbered by their places alone, so that seams of textures and normals part nothing.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Integers
from ..descriptions.mesh_damage import are_numbers, quoted
from ..errors import FileError

_BEHIND_SLASH = re.compile(r"/\S*")
NONE = -1
"""Index of the label of a face that has none."""


@dataclass(frozen=True)
class ObjContent:
    """What is read of an OBJ file, in its own unit."""

    vertices: Array
    """Shape (v, 3)."""
    faces: Integers
    """Polygons as fans of triangles, shape (f, 3)."""
    materials: tuple[str, ...]
    """Names after `usemtl`."""
    material_of: Integers
    """Index in `materials` of every face, shape (f,)."""
    groups: tuple[frozenset[str], ...]
    """Names after `o` and `g` that hold together."""
    group_of: Integers
    """Index in `groups` of every face, shape (f,)."""
    colors: Array | None
    """Of the vertices, each from 0 to 1, shape (v, 3); None if not all have one."""


def parse_obj(content: bytes) -> ObjContent:
    """Return the content of an OBJ file.

    Raises:
        FileError: it is none; it names no file.
    """
    corners: list[str] = []
    polygons: list[str] = []
    starts: list[int] = []  # vertices before each polygon, from which negative indices count back
    labels: list[tuple[int, int]] = []
    materials: dict[str, int] = {}
    groups: dict[frozenset[str], int] = {}
    thing, members, label = "", frozenset[str](), (NONE, NONE)
    for line in content.decode("utf-8", "replace").replace("\\\r\n", " ").replace("\\\n", " ").splitlines():
        word, _, rest = line.strip().partition(" ")
        match word:
            case "v":
                corners.append(rest)
            case "f":
                polygons.append(rest)
                starts.append(len(corners))
                labels.append(label)
            case "usemtl":
                label = (materials.setdefault(rest.strip(), len(materials)), label[1])
            case "o" | "g":
                if word == "o":
                    thing, members = rest.strip(), frozenset()
                else:
                    members = frozenset(rest.split())
                label = (label[0], groups.setdefault(members | ({thing} - {""}), len(groups)))
    vertices, colors = _vertices(corners)
    faces, polygon_of = _faces(polygons, np.array(starts, dtype=np.int64), len(corners))
    of_faces = np.array(labels, dtype=np.int64).reshape(-1, 2)[polygon_of]
    return ObjContent(vertices, faces, tuple(materials), of_faces[:, 0], tuple(groups), of_faces[:, 1], colors)


def _vertices(corners: list[str]) -> tuple[Array, Array | None]:
    """Return the places of the corners and, where each has them, their colours."""
    rows = [corner.split() for corner in corners]
    try:
        vertices = np.array([row[:3] for row in rows], dtype=np.float64).reshape(len(rows), 3)
    except ValueError:
        number = next(number for number, row in enumerate(rows) if not are_numbers(row, 3))
        raise _refused(f"vertex {number + 1} is not three numbers: {quoted(corners[number])}") from None
    if not rows or not all(are_numbers(row[3:6], 3) for row in rows):
        return vertices, None
    colors = np.array([row[3:6] for row in rows], dtype=np.float64)
    beyond = np.flatnonzero(~((colors >= 0.0) & (colors <= 1.0)).all(axis=1))
    if len(beyond):
        number = int(beyond[0])
        told = ", ".join(f"{value:g}" for value in colors[number])
        problem = f"has the colour ({told}) at vertex {number + 1}"
        raise FileError(problem, remedy="Colours of OBJ files go from 0 to 1; export it again, or without colours")
    return vertices, colors


def _faces(polygons: list[str], starts: Integers, count: int) -> tuple[Integers, Integers]:
    """Return polygons as triangles, and the index of the polygon of each."""
    rows = [_BEHIND_SLASH.sub("", polygon).split() for polygon in polygons]
    sizes = np.array([len(row) for row in rows], dtype=np.int64)
    if (sizes < 3).any():
        number = int(np.argmin(sizes))
        raise _refused(f"face {number + 1} has fewer than three corners: {quoted(polygons[number])}")
    try:
        written = np.array([corner for row in rows for corner in row], dtype=np.int64)
    except (ValueError, OverflowError):
        number = next(number for number, row in enumerate(rows) if not are_numbers(row, len(row), np.int64))
        raise _refused(f"face {number + 1} is not numbers of vertices: {quoted(polygons[number])}") from None
    indices = np.where(written > 0, written - 1, written + np.repeat(starts, sizes))
    wrong = np.flatnonzero((written == 0) | (indices < 0) | (indices >= count))
    if len(wrong):
        number = int(np.searchsorted(np.cumsum(sizes), wrong[0], side="right"))
        raise _refused(f"face {number + 1} has the vertex {written[wrong[0]]}, of {count}")
    firsts = np.cumsum(sizes) - sizes
    polygon_of = np.repeat(np.arange(len(sizes)), sizes - 2)
    steps = np.arange(len(polygon_of)) - np.repeat(np.cumsum(sizes - 2) - (sizes - 2), sizes - 2)
    first = firsts[polygon_of]
    return indices[np.stack([first, first + steps + 1, first + steps + 2], axis=1)], polygon_of


def _refused(why: str) -> FileError:
    return FileError(f"cannot be read as OBJ: {why}", remedy="Export it again")
