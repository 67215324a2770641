"""Convex covers of mesh files, kept in the user's cache folder.

A cover is found by the content of the mesh and by what decides how it is cut; where it is there, the mesh is not
even parsed. A damaged file of the cache is computed again, and a folder that cannot be written costs time only.
"""

from __future__ import annotations

import contextlib
import io
import zlib
from functools import lru_cache
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from ..arrays import Array
from ..disk import cache_folder, digest, write_whole
from ..errors import InputError
from .covers import VERSION, cover
from .hulls import FlatError
from .mesh_file import read_triangles, unreadable

Pieces = tuple[Array, ...]
"""Vertices of convex pieces, each of shape (k, 3), m."""


def mesh_cover(mesh: Path, scale: tuple[float, ...], pieces: int, tolerance: float) -> Pieces:
    """Return convex pieces that together contain a mesh.

    Args:
        mesh: STL, DAE or OBJ file.
        scale: along x, y and z.
        pieces: their largest number; 1 gives the convex hull.
        tolerance: how far a piece may stand off the mesh without being cut, m; see `cover`.

    Raises:
        InputError: the mesh cannot be read or has no volume.
    """
    try:
        content = mesh.read_bytes()
    except OSError as error:
        raise unreadable(mesh, error) from None
    settings = f"{VERSION} {mesh.suffix.lower()} {scale} {pieces} {tolerance}"
    key = digest(content + settings.encode())
    return _cached(key, mesh, scale, pieces, tolerance)


def body_cover(name: str, triangles: Array, pieces: int, tolerance: float) -> Pieces:
    """Return convex pieces that together contain a closed mesh that is read already; arguments as of `mesh_cover`.

    Args:
        name: of the file in the cache, besides the digest of the content.
        triangles: shape (n, 3, 3), m.
        pieces: their largest number.
        tolerance: m.

    Raises:
        FlatError: the mesh lies in one plane.
    """
    key = digest(f"{VERSION} {pieces} {tolerance} ".encode() + triangles.tobytes())
    file = cache_folder() / "covers" / f"{name}-{key[:32]}.npz"
    found = _load(file)
    if found is None:
        found = tuple(cover(triangles, pieces, tolerance))
        _save(file, found)
    return found


@lru_cache(maxsize=256)  # worker processes that are forked have it all
def _cached(key: str, mesh: Path, scale: tuple[float, ...], pieces: int, tolerance: float) -> Pieces:
    file = cache_folder() / "covers" / f"{mesh.stem}-{key[:32]}.npz"
    found = _load(file)
    if found is None:
        try:
            found = tuple(cover(read_triangles(mesh) * np.array(scale), pieces, tolerance))
        except FlatError:
            raise InputError("the collision mesh has no volume", file=mesh) from None
        _save(file, found)
    return found


def _load(file: Path) -> Pieces | None:
    """Return the content of a file, or None if it is not there or of no use."""
    try:
        with file.open("rb") as stream, np.load(stream) as data:
            return tuple(np.split(data["vertices"].reshape(-1, 3), data["ends"][:-1]))
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile, zlib.error):
        return None


def _save(file: Path, pieces: Pieces) -> None:
    """Write the whole file, or nothing where that is not possible."""
    stream = io.BytesIO()
    np.savez(stream, vertices=np.concatenate(pieces), ends=np.cumsum([len(piece) for piece in pieces]))
    with contextlib.suppress(InputError):
        write_whole(file, stream.getvalue())
