"""The body that a described mesh stands for: triangles in metres, mended, with what is painted on them.

All of it follows from the bytes of the file and the description, and is kept in this process; the repair on the disk.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from ..arrays import Array, Integers, Mask
from ..descriptions.mesh_files import LARGEST, Unit, metres_in_unit
from ..descriptions.shapes import Mesh
from ..errors import FileError
from .mesh_content import MeshContent, Paint, read_content, require_near
from .mesh_parts import corners_of
from .no_body import NoBodyError
from .repair_cache import kept_repaired

SMALLEST = 0.002
"""A body that is smaller may have coordinates of another unit, m."""


@dataclass(frozen=True)
class ObjectMesh:
    """A body as triangles; frame of the shape."""

    vertices: Array
    """Shape (v, 3), m."""
    faces: Integers
    """Counter-clockwise seen from outside; closed but for slits and slivers; shape (f, 3)."""
    outer: Mask
    """Which triangles bound the body, and do not lie wholly inside it where parts overlap; shape (f,)."""
    paint: Paint
    """What is painted on the triangles."""
    findings: tuple[str, ...]
    """What was taken for granted or mended, in words."""

    @property
    def triangles(self) -> Array:
        """Shape (f, 3 corners, 3), m."""
        return np.asarray(self.vertices[self.faces])


def object_mesh(shape: Mesh) -> ObjectMesh:
    """Return the body of a described mesh.

    Raises:
        FileError: the file cannot be read, has changed since it was described, or encloses no body.
    """
    return _made(shape.file, shape.sha256, shape.scales, shape.unit, shape.largest_hole)


@lru_cache(maxsize=32)  # worker processes that are forked have it all
def _made(
    file: Path, sha256: str | None, scales: tuple[float, float, float], unit: Unit | None, largest_hole: float
) -> ObjectMesh:
    shape = Mesh(file=file, sha256=sha256, scale=scales, unit=unit, largest_hole=largest_hole)
    read = read_content(file, shape.content())
    scaled = read.vertices * scales
    used = scaled[corners_of(read.faces, len(scaled))]
    extent = float(np.ptp(used, axis=0).max())
    metres = metres_in_unit(unit, read.metres, extent)
    require_near(used * metres, file, "Check its numbers, `scale` and `unit`")
    try:
        body = kept_repaired(file.stem, scaled * metres, read.faces, largest_hole)
    except NoBodyError as error:
        raise FileError(error.problem, file=file, remedy=error.remedy) from None
    findings = (*_of_units(shape, read, extent, metres), *body.findings)
    return ObjectMesh(body.vertices, body.faces, body.outer, read.paint.taken(body.origin), findings)


def _of_units(shape: Mesh, read: MeshContent, extent: float, metres: float) -> Iterator[str]:
    """Say what was taken for the unit where nobody gives it."""
    size = f"{1e3 * extent * metres:.3g} mm large"
    if shape.unit is None and read.metres != 1.0:
        yield f"taken in units of {metres:g} m, as the file says: it is {size}"
    elif shape.unit is None and metres != 1.0:
        yield f"taken as millimetres: it is {size}, in metres it would be {extent:.3g} m"
    if extent * metres < SMALLEST:
        yield f"it is only {size}: is `unit` right?"
    if extent * metres > LARGEST:
        yield f"it is {size}, more than a hand holds: is `unit` right?"
