"""Triangles as they come are made into a body by the check: exact volumes, insides, and the optimiser's body beside."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshes
import numpy as np
import pytest
import trimesh

from pinograsp.descriptions.shapes import Mesh
from pinograsp.errors import FileError
from pinograsp.geometry import object_mesh as optimiser
from pinograsp.geometry.winding import Winding
from pinograsp.verification.mended import mended
from pinograsp.verification.object_mesh import object_mesh
from pinograsp.verification.triangle_body import TriangleBody

CUBE = meshes.box([0, 0, 0], [0.04, 0.04, 0.04])
BESIDE = meshes.box([0.06, 0, 0], [0.09, 0.03, 0.03])
ACROSS = meshes.box([0.03, 0.01, 0.01], [0.06, 0.02, 0.02])
WITHIN = meshes.box([0.01, 0.01, 0.01], [0.03, 0.03, 0.03])
LONG = meshes.box([0, 0, 0], [0.08, 0.04, 0.04])
ALL = CUBE.volume + BESIDE.volume
POINTS = np.random.default_rng(0).uniform([-0.01, -0.01, -0.01], [0.1, 0.05, 0.05], (3000, 3))


def inverted(mesh: Any) -> Any:
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


def together(*parts: Any) -> Any:
    return trimesh.Trimesh(
        *trimesh.util.append_faces([part.vertices for part in parts], [part.faces for part in parts]), process=False
    )


def turned(mesh: Any, which: Any) -> Any:
    faces = mesh.faces.copy()
    faces[which] = faces[which, ::-1]
    return trimesh.Trimesh(mesh.vertices, faces, process=False)


def less(mesh: Any, which: Any) -> Any:
    return trimesh.Trimesh(mesh.vertices, np.delete(mesh.faces, which, axis=0), process=False)


def inside(*parts: Any) -> Any:
    """Return which points are in any of some boxes."""
    return np.any([((part.bounds[0] < POINTS) & (part.bounds[1] > POINTS)).all(axis=1) for part in parts], axis=0)


def read(folder: Path, mesh: Any) -> TriangleBody:
    mesh.export(folder / "it.ply")
    return object_mesh(Mesh(file=folder / "it.ply", unit="m"))


HOLLOW = CUBE.volume - WITHIN.volume, lambda: inside(CUBE) & ~inside(WITHIN)
BOTH = ALL, lambda: inside(CUBE, BESIDE)
ONE = CUBE.volume, lambda: inside(CUBE)
OVERLAP = CUBE.volume + ACROSS.volume * 2 / 3, lambda: inside(CUBE, ACROSS)

KINDS: dict[str, tuple[Any, tuple[float, Callable[[], Any]]]] = {
    "a part inside out": (together(CUBE, inverted(BESIDE)), BOTH),
    "all inside out": (together(inverted(CUBE), inverted(BESIDE)), BOTH),
    "twice": (together(CUBE, CUBE, BESIDE), BOTH),
    "three times one triangle": (together(CUBE, less(CUBE, slice(1, None)), less(CUBE, slice(1, None))), ONE),
    "from both sides": (together(CUBE, inverted(CUBE)), ONE),
    "every second triangle": (turned(CUBE, slice(None, None, 2)), ONE),
    "hollow": (together(CUBE, inverted(WITHIN)), HOLLOW),
    "overlapping": (together(CUBE, ACROSS), OVERLAP),
    "a part within that faces alike": (together(CUBE, WITHIN), ONE),
    "one of two from both sides": (together(CUBE, BESIDE, inverted(BESIDE)), BOTH),
    "a part inside out that overlaps": (together(CUBE, inverted(ACROSS)), OVERLAP),
    "hollow, inside out": (together(inverted(CUBE), WITHIN), HOLLOW),
    "a face of both": (together(LONG, CUBE, CUBE), (LONG.volume, lambda: inside(LONG))),
    "a sheet from both sides": (
        together(CUBE, less(BESIDE, slice(0, 2)), inverted(less(BESIDE, slice(0, 2)))),
        ONE,
    ),
}
CHECK_ALONE: dict[str, tuple[Any, tuple[float, Callable[[], Any]]]] = {
    "touching at an edge, one inside out": (
        together(CUBE, inverted(meshes.box([0.04, 0.04, 0], [0.05, 0.05, 0.04]))),
        (CUBE.volume + 4e-6, lambda: inside(CUBE, meshes.box([0.04, 0.04, 0], [0.05, 0.05, 0.04]))),
    ),
}


@pytest.mark.parametrize("kind", [*KINDS, *CHECK_ALONE])
def test_what_is_enclosed_is_the_body(kind: str, tmp_path: Path) -> None:
    mesh, (volume, within) = {**KINDS, **CHECK_ALONE}[kind]
    body = read(tmp_path, mesh)
    assert body.filled.volume == pytest.approx(volume, rel=3e-3)
    np.testing.assert_array_equal(body.contains(POINTS), within())
    np.testing.assert_array_equal(body.distances(POINTS) < 0.0, within())


@pytest.mark.parametrize("kind", KINDS)
def test_both_sides_agree(kind: str, tmp_path: Path) -> None:
    mesh, _ = KINDS[kind]
    body = read(tmp_path, mesh)
    other = optimiser.object_mesh(Mesh(file=tmp_path / "it.ply", unit="m"))
    np.testing.assert_array_equal(Winding(other.vertices, other.faces).numbers(POINTS) > 0.5, body.contains(POINTS))


@pytest.mark.parametrize("facing", ["++++", "-+-+", "-++-", "+-+-", "+---", "+--+", "----", "+--", "-+", "+-"])
def test_balls_in_balls(facing: str) -> None:
    """What faces against a solid ball around it is hollow; what is in a hollow is solid."""
    balls = [meshes.ball(radius, 3) for radius in (0.03, 0.02, 0.01, 0.005)[: len(facing)]]
    parts = [one if way == "+" else inverted(one) for one, way in zip(balls, facing, strict=True)]
    mesh = together(*parts)
    faces = mended(mesh.vertices, mesh.faces, 0.002)
    a, b, c = mesh.vertices[faces].reshape(len(balls), -1, 3, 3).transpose(2, 0, 1, 3)
    signs = np.sign(np.einsum("pij,pij->p", a, np.cross(b, c)))
    assert signs.tolist() == ([1.0] * len(balls) if len(set(facing)) == 1 else [1.0, -1.0, 1.0, -1.0][: len(balls)])


def test_a_cavity_across_two_parts() -> None:
    """It is in the material of both together, and in neither alone."""
    other = meshes.box([0.03, 0, 0], [0.08, 0.04, 0.04])
    mesh = together(CUBE, other, inverted(meshes.box([0.01, 0.01, 0.01], [0.07, 0.02, 0.02])))
    np.testing.assert_array_equal(mended(mesh.vertices, mesh.faces, 0.002), mesh.faces)


def test_a_sheet_encloses_nothing(tmp_path: Path) -> None:
    sheet = trimesh.Trimesh([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2], [0, 2, 3]])
    with pytest.raises(FileError, match=r"it\.ply: encloses no volume\. Export it again as a body with an inside"):
        read(tmp_path, together(sheet, inverted(sheet)))
