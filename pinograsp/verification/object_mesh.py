"""The triangles of a described mesh, as trimesh reads them; read apart from `geometry.object_mesh`."""

from __future__ import annotations

import io
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from ..arrays import Array, Integers
from ..descriptions.mesh_damage import unreadable
from ..descriptions.mesh_files import metres_in_unit
from ..descriptions.obj_indices import counted_from_first
from ..descriptions.shapes import Mesh
from ..errors import FileError
from .mended import mended
from .triangle_body import TriangleBody


@lru_cache(maxsize=16)  # by content: what is described alike is read once
def object_mesh(shape: Mesh) -> TriangleBody:
    """Return the body of a described mesh.

    Raises:
        FileError: the file cannot be read, is not the one that was described, or encloses no body.
    """
    file = shape.file
    mesh, stated = _read(shape.content(), file)
    vertices = np.asarray(mesh.vertices, dtype=np.float64) * shape.scales
    vertices *= metres_in_unit(shape.unit, stated, float(np.ptp(vertices, axis=0).max()))
    vertices, faces = _without_flat(vertices, np.asarray(mesh.faces, dtype=np.int64))
    if not len(faces):
        raise FileError("has flat triangles only", file=file, remedy="Export the mesh again")
    faces = mended(vertices, faces, shape.largest_hole)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    volume = float(np.einsum("ij,ij->", a - vertices.mean(axis=0), np.cross(b - a, c - a)))
    if volume <= 1e-9 * float(np.prod(np.ptp(vertices, axis=0))):
        raise FileError("encloses no volume", file=file, remedy="Export it again as a body with an inside")
    return TriangleBody(*_used(vertices, faces))


def _read(content: bytes, file: Path) -> tuple[Any, float]:
    """Return the triangles of a file, with one vertex for all that meet at a point, and the metres in its unit."""
    try:
        with warnings.catch_warnings():  # of a mesh that was made elsewhere
            warnings.simplefilter("ignore")
            kind = file.suffix[1:].lower()
            # Not processed, which takes out corners that are no numbers.
            scene: Any = trimesh.load_scene(
                io.BytesIO(counted_from_first(content, kind)), file_type=kind, process=False
            )
            whole = scene.to_geometry()
            stated = 1.0 if scene.units is None else float(trimesh.units.unit_conversion(scene.units, "meters"))
            # Without texture and colours, which keep vertices apart that are one.
            mesh = trimesh.Trimesh(whole.vertices, whole.faces, process=False)
    except Exception as error:  # of any kind, from a parser that is given any bytes
        raise unreadable(content, file) from error
    if not len(mesh.faces) or not np.isfinite(mesh.vertices).all():
        raise FileError("has no triangles, or a corner that is no number", file=file, remedy="Export the mesh again")
    mesh.merge_vertices()
    return mesh, stated


def _without_flat(vertices: Array, faces: Integers) -> tuple[Array, Integers]:
    """Return the triangles without those that have no area, and the vertices that they use."""
    a, b, c = vertices[faces].transpose(1, 0, 2)
    return _used(vertices, faces[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0.0])


def _used(vertices: Array, faces: Integers) -> tuple[Array, Integers]:
    """Return the vertices that triangles use, and the triangles of these."""
    used, numbers = np.unique(faces, return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3).astype(np.int64)
