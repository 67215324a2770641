"""Convex covers of mesh files, kept in the user's cache folder.

A cover is found by the content of the mesh and by what decides how it is cut; where it is there, the mesh is not
even parsed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ..array_cache import kept
from ..arrays import Array
from ..descriptions.mesh_files import mesh_bytes
from ..disk import digest
from ..errors import InputError
from .covers import VERSION, cover
from .hulls import FlatError
from .mesh_file import read_triangles

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
        InputError: the mesh cannot be read or has no area.
    """
    content = mesh_bytes(mesh)
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
        FlatError: the mesh has no area.
    """
    key = digest(f"{VERSION} {pieces} {tolerance} ".encode() + triangles.tobytes())
    return _kept(name, key, lambda: tuple(cover(triangles, pieces, tolerance)))


@lru_cache(maxsize=256)  # worker processes that are forked have it all
def _cached(key: str, mesh: Path, scale: tuple[float, ...], pieces: int, tolerance: float) -> Pieces:
    def make() -> Pieces:
        try:
            return tuple(cover(read_triangles(mesh, scale), pieces, tolerance))
        except FlatError:
            raise InputError("the collision mesh has no area: all of it is on a line", file=mesh) from None

    return _kept(mesh.stem, key, make)


def _kept(name: str, key: str, make: Callable[[], Pieces]) -> Pieces:
    return kept("covers", f"{name}-{key[:32]}", make, _arrays_of, _pieces_of)


def _arrays_of(pieces: Pieces) -> dict[str, Any]:
    return {"vertices": np.concatenate(pieces), "ends": np.cumsum([len(piece) for piece in pieces])}


def _pieces_of(arrays: Mapping[str, Any]) -> Pieces:
    return tuple(np.split(arrays["vertices"].reshape(-1, 3), arrays["ends"][:-1]))
