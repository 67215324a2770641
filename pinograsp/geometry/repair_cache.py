"""Repaired meshes, kept in the user's cache folder: large ones take seconds, and every process asks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..array_cache import kept
from ..arrays import Array, Integers
from ..disk import digest
from .mesh_repair import Repaired, repaired

VERSION = 2
"""Of how meshes are repaired; to be raised with every change that gives others."""


def kept_repaired(name: str, vertices: Array, faces: Integers, largest_hole: float) -> Repaired:
    """Return `mesh_repair.repaired` of a mesh.

    Args:
        name: of the file in the cache, besides the digest of the content.
        vertices: shape (v, 3), finite, m.
        faces: shape (f, 3).
        largest_hole: diameter up to which holes are closed, m.

    Raises:
        NoBodyError: as `repaired`; that is not kept.
    """
    content = f"{VERSION} {largest_hole!r} {len(vertices)} ".encode() + vertices.tobytes() + faces.tobytes()
    return kept(
        "repaired",
        f"{name}-{digest(content)[:32]}",
        lambda: repaired(vertices, faces, largest_hole),
        _arrays_of,
        _repaired_of,
    )


def _arrays_of(body: Repaired) -> dict[str, Any]:
    return {
        "vertices": body.vertices,
        "faces": body.faces.astype(np.int32),
        "origin": body.origin.astype(np.int32),
        "outer": body.outer,
        "findings": np.array(body.findings, dtype=np.str_),
    }


def _repaired_of(arrays: Mapping[str, Any]) -> Repaired:
    return Repaired(
        arrays["vertices"],
        arrays["faces"].astype(np.int64),
        arrays["origin"].astype(np.int64),
        arrays["outer"],
        tuple(arrays["findings"].tolist()),
    )
