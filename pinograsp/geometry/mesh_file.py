"""Triangles of the collision meshes of robots (STL, DAE, OBJ); those of objects are read by `mesh_content`."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import trimesh

from ..arrays import Array
from ..errors import FileError


def read_triangles(mesh: Path) -> Array:
    """Return the triangles of a mesh file, placed as its scene places them, in metres, shape (n, 3, 3).

    Raises:
        FileError: the file cannot be read.
    """
    try:
        with warnings.catch_warnings():  # reading DAE uses what NumPy 2.5 deprecates
            warnings.simplefilter("ignore", DeprecationWarning)
            whole = trimesh.load_scene(mesh).to_geometry()
        return np.asarray(np.array(whole.vertices, dtype=np.float64)[np.array(whole.faces)])
    except (OSError, ValueError, TypeError, KeyError, AttributeError, ImportError) as error:
        raise unreadable(mesh, error) from None


def unreadable(mesh: Path, error: Exception) -> FileError:
    """Return the error about a mesh file that cannot be read."""
    return FileError(f"the collision mesh cannot be read: {error}", file=mesh)
