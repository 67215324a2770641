"""Triangles of the collision meshes of robots, read as those of objects are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..descriptions.mesh_files import FILE_TYPES, mesh_bytes
from ..errors import FileError, InputError
from .mesh_content import read_content, require_near

MOST_TRIANGLES = 4_000_000
"""Most triangles of a file."""


def read_triangles(mesh: Path, scale: Sequence[float] | Array) -> Array:
    """Return the triangles of a mesh file, placed as its scene places them and scaled, m, shape (n, 3, 3).

    A unit that the file states counts. An axis that points up does not: nothing is turned, as in RViz and MoveIt.

    Args:
        mesh: the file.
        scale: along each axis, shape (3,).

    Raises:
        FileError: the file cannot be read, is of an unknown kind, or has a corner that is no place or much too far
            away, or no triangles.
    """
    if mesh.suffix[1:].lower() not in FILE_TYPES:
        known = ", ".join(f".{name}" for name in FILE_TYPES)
        raise FileError("is no mesh file that can be read", file=mesh, remedy=f"The suffix must be one of {known}")
    read = read_content(mesh, mesh_bytes(mesh), MOST_TRIANGLES)
    with np.errstate(over="ignore"):  # infinite is too far, too
        triangles = np.asarray(read.vertices[read.faces] * (read.metres * np.asarray(scale)))
    require_near(triangles, mesh, "Check its numbers, and its `scale` in the URDF")
    return triangles


@contextmanager
def meshes_of(link: str) -> Iterator[None]:
    """Give errors about mesh files the name of the link that they are of."""
    try:
        yield
    except InputError as error:
        if error.key is not None:
            raise
        key = f"link {link}"
        raise type(error)(error.problem, file=error.file, line=error.line, key=key, remedy=error.remedy) from None
