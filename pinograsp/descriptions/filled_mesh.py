"""The centre of mass and the volume of a body that is given as triangles.

Descriptions stand below the geometry: triangles are taken as they stand in the file, before `geometry.mesh_repair`
mends them.
"""

from __future__ import annotations

import io
import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import trimesh

from ..errors import FileError
from .mesh_damage import unreadable
from .mesh_files import metres_in_unit
from .obj_indices import counted_from_first

if TYPE_CHECKING:
    from .shapes import Mesh


class Filled(NamedTuple):
    """A body filled evenly, in its own frame."""

    centroid: tuple[float, float, float]
    """Centre of mass, m."""
    volume: float
    """m^3."""


def filled(mesh: Mesh) -> Filled:
    """Return the centre of mass and the volume of a body filled evenly.

    The centre is the mean of the centres of the tetrahedra between triangles and a point in their middle, weighed with
    signed volumes: where parts overlap, what they share counts twice.

    Raises:
        FileError: the file cannot be read, is not that which was described, or encloses nothing.
    """
    content, kind = mesh.content(), mesh.file.suffix[1:].lower()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of parsers, about what the geometry judges
            scene: Any = trimesh.load_scene(
                io.BytesIO(counted_from_first(content, kind)), file_type=kind, process=False, skip_materials=True
            )
            whole = scene.to_geometry()
            corners = np.array(whole.vertices, dtype=np.float64)[np.array(whole.faces)] * mesh.scales
        stated = _stated(str(whole.metadata.get("units", "")))
    except Exception as error:  # parsers that are given any bytes raise errors of any class
        raise unreadable(content, mesh.file) from error
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    middle = 0.5 * (low + high)
    a, b, c = (corners - middle).transpose(1, 0, 2)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    if not abs(volumes.sum()) > 1e-9 * float(np.prod(high - low)):
        remedy = "Give `center_of_mass` of the object"
        raise FileError("encloses no volume, so that it has no centre of mass", file=mesh.file, remedy=remedy)
    center = middle + 0.25 * (volumes @ (a + b + c)) / volumes.sum()
    metres = metres_in_unit(mesh.unit, stated, float((high - low).max()))
    x, y, z = (metres * center).tolist()
    return Filled((x, y, z), metres**3 * abs(float(volumes.sum())))


def _stated(units: str) -> float:
    """Return the metres in the unit of a file, as trimesh says it of COLLADA; 1 where it says nothing else."""
    number, _, rest = units.partition(" * ")
    return float(number) if rest == "meters" else 1.0
