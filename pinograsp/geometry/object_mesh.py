"""The triangles of a described mesh, in metres."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh

from ..arrays import Array, Integers
from ..descriptions.mesh_files import metres_in_unit
from ..descriptions.shapes import Mesh
from ..disk import content_of, digest
from ..errors import FileError
from ..memo import remembered


@dataclass(frozen=True)
class ObjectMesh:
    """A body as triangles; frame of the shape."""

    vertices: Array
    """Shape (v, 3), m."""
    faces: Integers
    """Corners counter-clockwise seen from outside, shape (f, 3)."""
    findings: tuple[str, ...]
    """What was taken for granted or mended, in words."""

    @property
    def triangles(self) -> Array:
        """Shape (f, 3 corners, 3), m."""
        return np.asarray(self.vertices[self.faces])


@remembered
def object_mesh(shape: Mesh) -> ObjectMesh:
    """Return the triangles of a described mesh.

    Raises:
        FileError: the file cannot be read, has changed since it was described, or encloses no body.
    """
    content = content_of(shape.file)
    if digest(content) != shape.sha256:
        raise FileError("is not the file that the scene was made with", file=shape.file, remedy="Load the scene again")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene: Any = trimesh.load_scene(io.BytesIO(content), file_type=shape.file.suffix[1:].lower(), process=False)
            whole = scene.to_geometry()
            vertices, faces = np.array(whole.vertices, dtype=np.float64), np.array(whole.faces, dtype=np.int64)
    except Exception as error:  # of any kind, from a parser that is given any bytes
        raise FileError(f"the mesh cannot be read: {error}", file=shape.file) from None
    vertices = vertices * shape.scales
    vertices *= metres_in_unit(shape.unit, 1.0, float(np.ptp(vertices, axis=0).max()))
    vertices, inverse = np.unique(vertices, axis=0, return_inverse=True)
    faces = inverse.reshape(-1)[faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    a, b, c = vertices[faces].transpose(1, 0, 2)
    if np.einsum("ij,ij->i", a, np.cross(b, c)).sum() < 0.0:
        faces = faces[:, ::-1]
    return ObjectMesh(vertices, np.ascontiguousarray(faces), ())
