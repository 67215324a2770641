"""Boxes, spheres and cylinders as triangles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh

from ..arrays import Array

_SECTIONS = 128


def primitive_triangles(kind: str, size: tuple[float, ...]) -> Array:
    """Return the triangles of a primitive about its origin, shape (n, 3, 3), m; none is inside a curved surface.

    Args:
        kind: box, sphere or cylinder (along z).
        size: edges; radius; radius and length, m.
    """
    return np.asarray(_MAKERS[kind](*size).triangles, dtype=np.float64)


def _box(*edges: float) -> trimesh.Trimesh:
    return trimesh.creation.box(extents=edges)


def _sphere(radius: float) -> trimesh.Trimesh:
    mesh = trimesh.creation.icosphere(subdivisions=4)
    inscribed = np.einsum("ij,ij->i", mesh.face_normals, mesh.triangles_center).min()
    return mesh.apply_scale(radius / inscribed)


def _cylinder(radius: float, length: float) -> trimesh.Trimesh:
    return trimesh.creation.cylinder(radius / np.cos(np.pi / _SECTIONS), length, sections=_SECTIONS)


_MAKERS: dict[str, Callable[..., trimesh.Trimesh]] = {"box": _box, "sphere": _sphere, "cylinder": _cylinder}
