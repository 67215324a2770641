"""Triangle meshes of everyday things, made here: closed, outward, as vertices (m) and faces; and spoiled on purpose."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from conftest import Array
from numpy.typing import NDArray

Faces = NDArray[np.int64]


def cylinder(radius: float, low: float, high: float, at: Sequence[float] = (0.0, 0.0), sections: int = 96) -> Any:
    """Return a cylinder along z from one height to another."""
    mesh = trimesh.creation.cylinder(radius, high - low, sections=sections)
    return mesh.apply_translation([*at, 0.5 * (low + high)])


def box(low: Sequence[float], high: Sequence[float]) -> Any:
    """Return a box between two corners."""
    return trimesh.creation.box(bounds=[low, high])


def ball(radius: float, subdivisions: int = 4) -> Any:
    """Return a ball whose corners lie on the sphere."""
    return trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)


def mug() -> Any:
    """Return a mug of 80 mm with a handle and walls of 4 mm."""
    outside, hollow = cylinder(0.04, 0.0, 0.095), cylinder(0.036, 0.005, 0.2)
    ring = trimesh.creation.torus(0.027, 0.006, major_sections=64, minor_sections=32)
    ring.apply_transform(trimesh.transformations.rotation_matrix(0.5 * np.pi, [1, 0, 0]))
    ring.apply_translation([0.045, 0.0, 0.05])
    return outside.union(ring, engine="manifold").difference(hollow, engine="manifold")


def bracket() -> Any:
    """Return an angle of 5 mm sheet with two holes."""
    plates = box([0, -0.02, 0], [0.06, 0.02, 0.005]).union(box([0, -0.02, 0], [0.005, 0.02, 0.05]), engine="manifold")
    return plates.difference(cylinder(0.005, -0.01, 0.02, (0.04, 0.0)), engine="manifold")


def bottle() -> Any:
    """Return a bottle with a shoulder and a neck: a profile turned about z, 60 mm wide."""
    profile = [
        (0, 0),
        (0.028, 0),
        (0.03, 0.003),
        (0.03, 0.11),
        (0.026, 0.125),
        (0.013, 0.14),
        (0.012, 0.165),
        (0, 0.165),
    ]
    return trimesh.creation.revolve(np.array(profile, dtype=float), sections=96)


def hammer() -> Any:
    """Return a hammer: an oval handle of 200 mm and a head across it."""
    handle = cylinder(0.5, -0.12, 0.08)
    handle.vertices *= [0.03, 0.024, 1.0]
    head = trimesh.creation.cylinder(0.014, 0.09, sections=48)
    head.apply_transform(trimesh.transformations.rotation_matrix(0.5 * np.pi, [1, 0, 0]))
    head.apply_translation([0.0, 0.0, 0.075])
    return handle.union(head, engine="manifold")


THINGS = {"mug": mug, "bracket": bracket, "bottle": bottle, "hammer": hammer}
"""Makers of closed meshes as trimesh.Trimesh."""


def arrays(mesh: Any) -> tuple[Array, Faces]:
    """Return vertices (v, 3), m, and faces (f, 3) of a trimesh.Trimesh."""
    return np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64)


def written(mesh: Any, file: Path) -> Path:
    """Write a trimesh.Trimesh to a file, in the format of its suffix, and return the path."""
    mesh.export(file)
    return file
