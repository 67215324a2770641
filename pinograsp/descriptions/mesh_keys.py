"""Errors about mesh files of a scene, told with the key that asks for the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import FileError
from .mesh_files import mesh_files
from .scene import Scene

NAMED = 3
"""Keys that a message names at most."""


@contextmanager
def mesh_keys(scene: Scene) -> Iterator[None]:
    """Have errors about mesh files of a scene name the scene file, and the keys that ask for the mesh.

    Args:
        scene: whose bodies and regions are used in the block.

    Raises:
        FileError: a mesh file of the scene cannot be used; `file` is that of the scene.
    """
    try:
        yield
    except FileError as error:
        keys = [key for key, mesh in mesh_files(scene) if mesh.file == error.file]
        if not keys:
            raise
        raise FileError(
            f"{error.file} {error.problem}", file=scene.source, key=", ".join(keys[:NAMED]), remedy=error.remedy
        ) from None
