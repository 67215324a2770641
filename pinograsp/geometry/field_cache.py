"""Distance fields of meshes, kept in the user's cache folder as covers are (see `cover_cache`)."""

from __future__ import annotations

import contextlib
import io
import zlib
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from ..arrays import Array, Integers
from ..disk import cache_folder, digest, write_whole
from ..errors import InputError
from .distance_field import VERSION, DistanceField, distance_field, footprint_sigma
from .exact_distance import ExactDistance
from .lattice import Lattice

LATTICES = ("distance", "smoothed", "coarse")


def mesh_field(name: str, vertices: Array, faces: Integers) -> DistanceField:
    """Return the fields of a closed mesh, with the Gaussian that its thickness allows.

    Args:
        name: of the file in the cache, besides the digest of the content.
        vertices: shape (v, 3), m.
        faces: corners counter-clockwise seen from outside, shape (f, 3).
    """
    key = digest(f"{VERSION} {len(vertices)} ".encode() + vertices.tobytes() + faces.tobytes())
    file = cache_folder() / "fields" / f"{name}-{key[:32]}.npz"
    found = _load(file)
    if found is None:
        sigma = footprint_sigma(ExactDistance(vertices, faces), vertices, faces)
        found = distance_field(vertices, faces, sigma)
        _save(file, found)
    return found


def _load(file: Path) -> DistanceField | None:
    """Return the content of a file, or None if it is not there or of no use."""
    try:
        with file.open("rb") as stream, np.load(stream) as data:
            distance, smoothed, coarse = (
                Lattice(data[name], data[f"{name}_origin"], float(data[f"{name}_spacing"])) for name in LATTICES
            )
            return DistanceField(distance, smoothed, coarse, float(data["error"]))
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile, zlib.error):
        return None


def _save(file: Path, field: DistanceField) -> None:
    """Write the whole file, or nothing where that is not possible."""
    content: dict[str, Any] = {"error": field.error}
    for name, lattice in zip(LATTICES, (field.distance, field.smoothed, field.coarse), strict=True):
        content |= {
            name: lattice.coefficients,
            f"{name}_origin": lattice.origin,
            f"{name}_spacing": lattice.spacing,
        }
    stream = io.BytesIO()
    np.savez(stream, **content)
    with contextlib.suppress(InputError):
        write_whole(file, stream.getvalue())
