"""On which side of triangles a body is."""

from __future__ import annotations

import igl
import numpy as np
import pytest
import trimesh
from meshes import ball, box

from pinograsp.arrays import Array, Indices, Mask
from pinograsp.geometry.mesh_sides import OFF, OuterSides
from pinograsp.verification.crossings import crossings_of
from pinograsp.verification.looks import ALONE, linked, one_for_all
from pinograsp.verification.plain_faces import Triangles


def _sides(mesh: trimesh.Trimesh) -> OuterSides:
    return OuterSides(np.array(mesh.vertices), np.array(mesh.faces))


@pytest.mark.parametrize("at", [0.03, 0.05, 0.2])
def test_balls_that_overlap_or_do_not(at: float) -> None:
    """Triangles are inner if all of them is in the other ball, and outer if a corner is outside of it."""
    one, other = ball(0.03), ball(0.03)
    other.apply_translation([at, 0.0, 0.0])
    both = trimesh.util.concatenate([one, other])
    centers = np.repeat([[at, 0.0, 0.0], [0.0, 0.0, 0.0]], len(one.faces), axis=0)
    sides = _sides(both)
    distances = np.linalg.norm(both.vertices[both.faces] - centers[:, None], axis=2)
    sag = 1e-4  # of the triangles below the sphere
    assert sides.outer()[(distances > 0.03 + sag).any(axis=1)].all()
    assert not sides.outer()[(distances < 0.03 - sag).all(axis=1)].any()
    beside = both.triangles_center + OFF * np.ptp(both.vertices, axis=0).max() * both.face_normals
    exact = igl.winding_number(np.array(both.vertices), np.array(both.faces), beside)
    np.testing.assert_allclose(sides.windings, exact, atol=0.01)


@pytest.mark.parametrize("gap", [0.0, 1e-9])
def test_faces_that_touch_bound_nothing(gap: float) -> None:
    """Two boxes on one another, up to the rounding of their file, are one body: 4 of 24 triangles are inner."""
    both = trimesh.util.concatenate([box([0, 0, 0], [1, 1, 1]), box([0, 0, 1 + gap], [1, 1, 2])])
    outer = _sides(both).outer()
    level = (np.abs(both.vertices[both.faces][:, :, 2] - 1.0) < 1e-6).all(axis=1)
    assert level.sum() == 4
    np.testing.assert_array_equal(outer, ~level)


def test_needles_beside_one_another() -> None:
    """A rod of 2,000 needles in a ball: all of it is inner, and all of the ball is outer."""
    rod = trimesh.creation.cylinder(0.002, 0.04, sections=500)
    both = trimesh.util.concatenate([rod, ball(0.03)])
    np.testing.assert_array_equal(_sides(both).outer(), np.arange(len(both.faces)) >= len(rod.faces))


def test_one_piece_tells_of_those_that_hang_together() -> None:
    """Two balls, a triangle of one turned round: that one, and each of the rest, is told of by one of its own."""
    one, other = ball(0.03), ball(0.03)
    other.apply_translation([0.1, 0.0, 0.0])
    both = trimesh.util.concatenate([one, other])
    faces = np.array(both.faces)
    faces[7] = faces[7, ::-1]
    sizes = both.area_faces
    told, teller = tellers(Triangles(np.array(both.vertices), faces), np.ones(len(faces), dtype=bool), sizes)
    rest, last = np.delete(np.arange(len(one.faces)), 7), np.arange(len(one.faces), len(faces))
    assert len(told) == 3
    for group in (rest, last, np.array([7])):
        (number,) = np.unique(teller[group])
        assert told[number] in group
        assert sizes[told[number]] == sizes[group].max()


def test_what_is_not_clear_tells_of_itself_alone() -> None:
    mesh = ball(0.03, subdivisions=1)
    clear = np.ones(len(mesh.faces), dtype=bool)
    clear[[3, 4]] = False
    told, teller = tellers(Triangles(np.array(mesh.vertices), np.array(mesh.faces)), clear, mesh.area_faces)
    assert told[teller[3]] == 3
    assert told[teller[4]] == 4
    assert len(np.unique(teller[clear])) < 4


def tellers(of: Triangles, clear: Mask, sizes: Array) -> tuple[Indices, Indices]:
    crossings = crossings_of(of.vertices, of.faces, of.normals, of.middles[:, None].repeat(2, axis=1), ALONE)[0]
    return one_for_all(of.beside, linked(of, crossings, clear, of.middles), sizes)
