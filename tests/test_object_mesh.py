"""Mesh files as shapes: found, hashed, read, mended or refused with the reason."""

from __future__ import annotations

import json
import math
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import manifold3d
import meshes
import numpy as np
import pytest
import trimesh
from trimesh.transformations import rotation_matrix, translation_matrix

import pinograsp
from pinograsp.database.identity import Identity
from pinograsp.descriptions.bodies import Body, Object
from pinograsp.descriptions.mesh_files import CONTENT, metres_in_unit
from pinograsp.descriptions.shapes import Mesh
from pinograsp.disk import digest_of
from pinograsp.errors import FileError, InputError
from pinograsp.geometry import mesh_content
from pinograsp.geometry.filled import center_of_mass_world, filled
from pinograsp.geometry.mesh_repair import Repaired, repaired
from pinograsp.geometry.object_mesh import ObjectMesh, object_mesh
from pinograsp.geometry.repair_cache import kept_repaired
from pinograsp.problem.mesh_findings import mesh_findings
from pinograsp.results.provenance import file_hashes, provenance

SIZE = (0.06, 0.04, 0.02)
VOLUME = math.prod(SIZE)
BALL = trimesh.creation.icosphere(subdivisions=4, radius=0.03)


def box() -> Any:
    return trimesh.creation.box(extents=SIZE)


def bare(vertices: Any, faces: Any) -> Any:
    """Return a trimesh that nobody mends."""
    return trimesh.Trimesh(vertices, faces, process=False)


def put(folder: Path, name: str, mesh: Any) -> Path:
    file = folder / name
    mesh.export(file)
    return file


def read(file: Path, **keys: Any) -> ObjectMesh:
    return object_mesh(Mesh(file=file, **keys))


def volume(mesh: ObjectMesh) -> float:
    a, b, c = mesh.triangles.transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def is_closed(mesh: ObjectMesh) -> bool:
    """Return whether every edge is gone along as often one way as the other."""
    sides = mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    there, back = (np.unique(way, axis=0, return_counts=True) for way in (sides, sides[:, ::-1]))
    return all(np.array_equal(one, other) for one, other in zip(there, back, strict=True))


# ---- what is read


@pytest.mark.parametrize("kind", ["stl", "obj", "ply", "glb", "off", "dae"])
def test_every_kind_of_file_gives_the_same_body(kind: str, tmp_path: Path) -> None:
    file = put(tmp_path, f"box.{kind}", box())
    mesh = read(file)
    assert (len(mesh.vertices), len(mesh.faces)) == (8, 12)
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), SIZE, rtol=1e-6)
    assert volume(mesh) == pytest.approx(VOLUME, rel=1e-6)
    assert is_closed(mesh)
    assert mesh.outer.all()
    assert mesh.findings == ()


def test_suffixes_in_capitals(tmp_path: Path) -> None:
    file = put(tmp_path, "box.stl", box())
    assert len(read(file.rename(tmp_path / "BOX.STL")).faces) == 12


def test_scale_and_unit(tmp_path: Path) -> None:
    file = put(tmp_path, "box.stl", box())
    assert np.ptp(read(file, scale=2.0).vertices, axis=0) == pytest.approx([0.12, 0.08, 0.04])
    assert np.ptp(read(file, scale=[1, 2, 3]).vertices, axis=0) == pytest.approx([0.06, 0.08, 0.06])
    assert np.ptp(read(file, unit="in").vertices, axis=0) == pytest.approx(np.array(SIZE) * 0.0254)
    assert np.ptp(read(file, unit="cm", scale=100).vertices, axis=0) == pytest.approx(SIZE)


@pytest.mark.parametrize(
    ("scale", "key", "words"),
    [
        (-1, "shape.scale", "must be greater than 0 (given: -1)"),
        ([1, 1, -1], "shape.scale[2]", "must be greater than 0 (given: -1)"),
        ([1, 1], "shape.scale", "3 values are wanted (2 given)"),
        (np.zeros(3), "shape.scale[0]", "must be greater than 0 (given: 0.0)"),
        ("2", "shape.scale", "a number is wanted (given: '2')"),
    ],
)
def test_a_wrong_scale_is_told_as_it_was_meant(scale: Any, key: str, words: str, tmp_path: Path) -> None:
    file = put(tmp_path, "box.stl", box())
    with pytest.raises(InputError) as refused:
        Object(shape={"type": "mesh", "file": file, "scale": scale})  # type: ignore[arg-type]
    assert (refused.value.key, refused.value.problem) == (key, words)


def test_millimetres_are_guessed_and_said(tmp_path: Path) -> None:
    large = box()
    large.apply_scale(1000.0)
    file = put(tmp_path, "box.stl", large)
    mesh = read(file)
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx(SIZE)
    assert mesh.findings == ("taken as millimetres: it is 60 mm large, in metres it would be 60 m",)
    assert read(file, unit="mm").findings == ()
    assert np.ptp(read(file, unit="m").vertices, axis=0) == pytest.approx(np.array(SIZE) * 1000)
    assert read(file, unit="mm", scale=0.001).findings == ("it is only 0.06 mm large: is `unit` right?",)


@pytest.mark.parametrize(
    ("given", "metres"),
    [((None, 1.0, 2.9), 1.0), ((None, 1.0, 3.1), 1e-3), ((None, 0.0254, 9.0), 0.0254), (("m", 0.0254, 9.0), 1.0)],
)
def test_rule_of_the_unit(given: Any, metres: float) -> None:
    assert metres_in_unit(*given) == metres


def test_unit_of_collada(tmp_path: Path) -> None:
    text = trimesh.exchange.dae.export_collada(box()).decode()
    assert text.count("<asset>") == 1
    file = tmp_path / "box.dae"
    file.write_text(text.replace("<asset>", '<asset><unit name="inch" meter="0.0254"/>'))
    mesh = read(file)
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx(np.array(SIZE) * 0.0254)
    assert mesh.findings[0] == "taken in units of 0.0254 m, as the file says: it is 1.52 mm large"
    assert np.ptp(read(file, unit="m").vertices, axis=0) == pytest.approx(SIZE)
    np.testing.assert_allclose(filled(Mesh(file=file)).centroid, 0.0, atol=1e-9)


def test_nodes_of_a_glb_are_placed(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    scene.add_geometry(box(), node_name="one")
    turned = translation_matrix([0.1, 0, 0]) @ rotation_matrix(1.0, [0, 0, 1])
    scene.add_geometry(box(), node_name="other", transform=turned)
    mesh = read(put(tmp_path, "two.glb", scene))
    assert volume(mesh) == pytest.approx(2 * VOLUME, rel=1e-6)
    reach = 0.1 + 0.03 * math.cos(1) + 0.02 * math.sin(1)
    assert mesh.vertices[:, 0].max() == pytest.approx(reach, rel=1e-6)
    np.testing.assert_allclose(filled(Mesh(file=tmp_path / "two.glb")).centroid, [0.05, 0, 0], atol=1e-8)


def test_obj_with_polygons_slashes_and_indices_that_count_back(tmp_path: Path) -> None:
    lines = [f"v {x} {y} {z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    lines += ["vt 0 0", "f 4/1 3/1 2/1 1/1", "f -4//1 -3//1 -2//1 \\", " -1//1", "f 1 2 6 5", "f 2 3 7 6", "f 3 4 8 7"]
    file = tmp_path / "box.obj"
    file.write_text("\n".join([*lines, "f 4 1 5 8"]))
    mesh = read(file)
    assert len(mesh.faces) == 12
    assert volume(mesh) == pytest.approx(1.0)


# ---- what is mended


def test_seams_are_merged(tmp_path: Path) -> None:
    corners = box().triangles.reshape(-1, 3) * (1 + 1e-9 * np.random.default_rng(0).normal(size=(36, 3)))
    mesh = read(put(tmp_path, "soup.ply", bare(corners, np.arange(36).reshape(-1, 3))))
    assert len(mesh.vertices) == 8
    assert is_closed(mesh)


def test_inside_out(tmp_path: Path) -> None:
    turned = box()
    turned.invert()
    mesh = read(put(tmp_path, "box.stl", turned))
    assert volume(mesh) == pytest.approx(VOLUME, rel=1e-6)
    assert mesh.findings == ("inside out: turned",)


def test_one_part_inside_out_but_cavities_stay(tmp_path: Path) -> None:
    inner = trimesh.creation.box(extents=np.array(SIZE) / 2)
    inner.invert()
    hollow = read(put(tmp_path, "hollow.stl", trimesh.util.concatenate([box(), inner])))
    assert volume(hollow) == pytest.approx(VOLUME * 7 / 8, rel=1e-6)
    assert hollow.findings == ()
    beside = box()
    beside.apply_translation([0.1, 0, 0])
    beside.invert()
    both = read(put(tmp_path, "both.stl", trimesh.util.concatenate([box(), beside])))
    assert volume(both) == pytest.approx(2 * VOLUME, rel=1e-6)
    assert both.findings == ("1 part of it is inside out: turned",)


@pytest.mark.parametrize("facing", ["-+", "-+-", "-+-+", "-++-", "+-", "+--", "+-+-", "+---"])
def test_hollow_bodies_inside_out(facing: str, tmp_path: Path) -> None:
    """What is solid and what is hollow follows from which of balls in balls face against those around them."""
    balls = [meshes.ball(radius) for radius in (0.03, 0.02, 0.01, 0.005)[: len(facing)]]
    sizes = [(-1) ** k * one.volume for k, one in enumerate(balls)]
    for one, way in zip(balls, facing, strict=True):
        if way == "-":
            one.invert()
    mesh = read(put(tmp_path, "balls.ply", trimesh.util.concatenate(balls)))
    assert volume(mesh) == pytest.approx(sum(sizes), rel=1e-5)
    turned = sum(way != right for way, right in zip(facing, "+-+-", strict=False))
    some = {0: (), 1: ("1 part of it is inside out: turned",), 2: ("2 parts of it are inside out: turned",)}
    assert mesh.findings == (("inside out: turned",) if turned == len(facing) else some[turned])


def test_parts_in_the_material_that_are_no_cavities(tmp_path: Path) -> None:
    """One that faces as what is around it, and one that reaches out of it."""
    one, inner, pin = box(), trimesh.creation.box(extents=np.array(SIZE) / 2), trimesh.creation.box([0.01, 0.01, 0.04])
    for part in (one, inner):
        part.invert()
    within = read(put(tmp_path, "within.ply", trimesh.util.concatenate([one, inner])))
    assert volume(within) == pytest.approx(VOLUME * 9 / 8, rel=1e-5)
    pin.apply_translation([0, 0, 0.005])
    out = read(put(tmp_path, "out.ply", trimesh.util.concatenate([one, pin])))
    assert volume(out) == pytest.approx(VOLUME + 4e-6, rel=1e-5)
    assert out.findings == ("1 part of it is inside out: turned",)


def test_a_cavity_across_two_parts_that_overlap(tmp_path: Path) -> None:
    """It lies in the material of both together, and in neither alone."""
    one, other, cavity = box(), box(), trimesh.creation.box(extents=[0.06, 0.02, 0.01])
    other.apply_translation([0.04, 0, 0])
    cavity.apply_translation([0.02, 0, 0])
    cavity.invert()
    mesh = read(put(tmp_path, "both.ply", trimesh.util.concatenate([one, other, cavity])))
    assert volume(mesh) == pytest.approx(2 * VOLUME - 12e-6, rel=1e-5)
    assert mesh.findings == ()


def test_triangles_that_face_the_other_way(tmp_path: Path) -> None:
    faces = box().faces.copy()
    faces[[1, 5, 7]] = faces[[1, 5, 7], ::-1]
    mesh = read(put(tmp_path, "box.stl", bare(box().vertices, faces)))
    assert volume(mesh) == pytest.approx(VOLUME, rel=1e-6)
    assert is_closed(mesh)
    assert mesh.findings == ("3 triangles against the direction of their neighbours turned",)


def test_doubled_triangles(tmp_path: Path) -> None:
    one = box()
    twice = bare(np.vstack([one.vertices] * 2), np.vstack([one.faces, one.faces + 8]))
    both_sides = bare(one.vertices, np.vstack([one.faces, one.faces[:, ::-1]]))
    for mesh in (read(put(tmp_path, "twice.stl", twice)), read(put(tmp_path, "sides.stl", both_sides))):
        assert len(mesh.faces) == 12
        assert volume(mesh) == pytest.approx(VOLUME, rel=1e-6)
        assert mesh.findings == ("12 doubled triangles left out",)
    one_more = bare(one.vertices, np.vstack([one.faces, one.faces[:1]]))
    assert read(put(tmp_path, "more.stl", one_more)).findings == ("1 doubled triangle left out",)


def _together(*parts: Any) -> Any:
    """Return parts in one mesh, doubled triangles too."""
    return bare(*trimesh.util.append_faces([part.vertices for part in parts], [part.faces for part in parts]))


@pytest.mark.parametrize(("copies", "left_out"), [((1, 1), 0), ((2, 1), 12), ((1, 2), 12), ((2, 2), 24), ((3, 1), 24)])
def test_copies_that_close_two_parts_stay(copies: tuple[int, int], left_out: int, tmp_path: Path) -> None:
    """A box in another whose end face is that of both: every edge is gone along as often one way as the other."""
    one, other = (trimesh.creation.box(extents=[length, 0.02, 0.02]) for length in (0.1, 0.05))
    other.apply_translation([0.025, 0, 0])
    mesh = read(put(tmp_path, "both.stl", _together(*[one] * copies[0], *[other] * copies[1])))
    assert mesh.findings == ((f"{left_out} doubled triangles left out",) if left_out else ())
    assert is_closed(mesh)
    assert len(mesh.faces) == 24
    assert volume(mesh) == pytest.approx(6e-5, rel=1e-6)


def test_a_part_that_is_seen_from_both_sides(tmp_path: Path) -> None:
    """Beside one that is seen from outside alone: a ball, one with a small hole, and an open sheet."""
    ball = meshes.ball(0.01)
    ball.apply_translation([0.1, 0, 0])
    for part, kept, rest in (
        (ball, len(ball.faces), ()),
        (bare(ball.vertices, ball.faces[1:]), len(ball.faces) + 2, ("1 hole of up to 1 mm closed",)),
        (bare(ball.vertices, ball.faces[ball.triangles_center[:, 2] > 0]), 0, ()),
    ):
        mesh = read(put(tmp_path, "both.ply", _together(box(), part, bare(part.vertices, part.faces[:, ::-1]))))
        assert len(mesh.faces) == 12 + kept
        assert volume(mesh) == pytest.approx(VOLUME + (ball.volume if kept else 0.0), rel=1e-4)
        doubled = len(part.faces) if kept else 2 * len(part.faces)
        assert mesh.findings == (f"{doubled} doubled triangles left out", *rest)


def test_triangles_without_area_are_dropped(tmp_path: Path) -> None:
    one = box()
    faces = np.vstack([one.faces, [[0, 0, 1], [2, 2, 2]]])
    mesh = read(put(tmp_path, "box.ply", bare(one.vertices, faces)))
    assert (len(mesh.faces), mesh.findings) == (12, ())


def test_small_holes_are_closed_and_said(tmp_path: Path) -> None:
    holed = bare(BALL.vertices, BALL.faces[1:])
    mesh = read(put(tmp_path, "ball.stl", holed), largest_hole=0.004)
    assert is_closed(mesh)
    assert volume(mesh) == pytest.approx(BALL.volume, rel=1e-4)
    low, high = BALL.triangles[0].min(axis=0), BALL.triangles[0].max(axis=0)
    size = 2e3 * np.linalg.norm(BALL.triangles[0] - 0.5 * (low + high), axis=1).max()
    assert mesh.findings == (f"1 hole of up to {size:.2g} mm closed",)
    assert np.isnan(mesh.paint.colors[-1]).all()


def test_larger_holes_are_refused_with_the_place(tmp_path: Path) -> None:
    top = BALL.triangles_center[:, 2] > 0.025
    with pytest.raises(FileError, match="is not closed: it has a hole of") as caught:
        read(put(tmp_path, "ball.stl", bare(BALL.vertices, BALL.faces[~top])))
    radius = math.sqrt(0.03**2 - 0.025**2)
    size, place = caught.value.problem.split(" mm around (")
    assert float(size.rsplit(" ", 1)[1]) == pytest.approx(2e3 * radius, rel=0.15)
    x, y, z = map(float, place.split(")")[0].split(","))
    assert (x, y, z) == pytest.approx((0, 0, 0.025), abs=1e-3)
    assert caught.value.file == tmp_path / "ball.stl"
    assert caught.value.remedy and "largest_hole" in caught.value.remedy


def test_a_long_slit_is_tolerated_by_its_width(tmp_path: Path) -> None:
    """The lid of a box stands off by half a millimetre: there are two borders of 72 mm, 0.5 mm from each other."""
    one = box()
    lid = one.face_normals[:, 2] > 0.5
    vertices = np.vstack([one.vertices, one.vertices + np.array([0, 0, 5e-4])])
    faces = np.where(lid[:, None], one.faces + 8, one.faces)
    file = put(tmp_path, "box.ply", bare(vertices, faces))
    mesh = read(file, largest_hole=0.001)
    assert mesh.findings == ("2 open seams narrower than 1 mm tolerated",)
    assert len(mesh.faces) == 12
    with pytest.raises(FileError, match=r"is not closed: it has a hole of 72\.1 mm around .* m, and 1 more"):
        read(file, largest_hole=0.0005)


def test_a_hole_with_a_ragged_border_is_no_slit(tmp_path: Path) -> None:
    """Its border turns by 60 and 120 degrees at every corner."""
    fine = trimesh.creation.icosphere(subdivisions=5, radius=0.03)
    hole = np.linalg.norm(fine.triangles_center - [0, 0, 0.03], axis=1) < 0.006
    with pytest.raises(FileError, match=r"is not closed"):
        read(put(tmp_path, "ball.ply", bare(fine.vertices, fine.faces[~hole])))


def test_open_ends_inside_other_parts_are_closed(tmp_path: Path) -> None:
    pin = trimesh.creation.cylinder(0.005, 0.06)
    open_below = bare(pin.vertices, pin.faces[pin.face_normals[:, 2] > -0.5])
    open_below.apply_translation([0, 0, 0.038])
    mesh = read(put(tmp_path, "pin.stl", trimesh.util.concatenate([box(), open_below])))
    assert mesh.findings == ("1 open end inside other parts closed",)
    buried = mesh.triangles[~mesh.outer]
    assert len(buried)
    assert np.abs(buried[:, :, 2]).max() < 0.0101
    assert mesh.outer[mesh.triangles.mean(axis=1)[:, 2] > 0.011].all()


def test_parts_that_overlap_are_one_body(tmp_path: Path) -> None:
    """The whole face that lies in the other part bounds nothing; what is half in it does."""
    pin = trimesh.creation.box(extents=[0.01, 0.01, 0.04])
    pin.apply_translation([0, 0, 0.02])
    mesh = read(put(tmp_path, "both.stl", trimesh.util.concatenate([box(), pin])))
    centers = mesh.triangles.mean(axis=1)
    bottom = (np.abs(mesh.triangles[:, :, 2]).max(axis=1) < 1e-9) & (np.abs(centers[:, 0]) < 0.005)
    assert bottom.sum() == 2
    assert not mesh.outer[bottom].any()
    assert mesh.outer[~bottom].all()


def test_body_of_a_boolean(tmp_path: Path) -> None:
    outer, inner = manifold3d.Manifold.cylinder(0.1, 0.04), manifold3d.Manifold.cylinder(0.1, 0.037)
    mug = (outer - inner.translate([0, 0, 0.004])).to_mesh()
    mesh = read(put(tmp_path, "mug.glb", bare(mug.vert_properties[:, :3], mug.tri_verts)))
    assert is_closed(mesh)
    assert volume(mesh) == pytest.approx(float((outer - inner.translate([0, 0, 0.004])).volume()), rel=1e-5)


# ---- what is refused

HOSTILE: dict[str, tuple[bytes, str]] = {
    "empty.stl": (b"", "is an empty file"),
    "empty.obj": (b"", "is an empty file"),
    "text.stl": (b"hello world\n" * 30, "has no triangles"),
    "text.ply": (b"hello world\n" * 30, "cannot be read as PLY"),
    "text.glb": (b"hello world\n" * 30, "cannot be read as GLB"),
    "text.dae": (b"hello world\n" * 30, "cannot be read as DAE"),
    "text.off": (b"hello world\n" * 30, "cannot be read as OFF"),
    "range.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", "face 1 has the vertex 7, of 3"),
    "zero.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "face 1 has the vertex 0, of 3"),
    "before.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "face 1 has the vertex -4, of 3"),
    "words.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf one two three\n", "cannot be read as OBJ"),
    "range.off": (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "cannot be read as OFF"),
    "nan.obj": (b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "has corners that are not finite in 1 of its 1 triangles"),
    "second.obj": (
        b"v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 2 3 4\nf 1 2 3\n",
        "has corners that are not finite in 1 of its 2 triangles; the first is triangle 2, counted from 1",
    ),
    "infinite.obj": (
        b"v 1e999 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        "has corners that are not finite in 1 of its 1 triangles",
    ),
    "cut.ply": (
        b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        b"element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        b"0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n",
        "is cut off: its header announces 8 lines of numbers, and 6 follow",
    ),
    "point.obj": (b"v 1 1 1\nf 1 1 1\n", "lies in one plane"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_content(name: str, tmp_path: Path) -> None:
    content, problem = HOSTILE[name]
    file = tmp_path / name
    file.write_bytes(content)
    with pytest.raises(FileError) as caught:
        read(file)
    assert problem in caught.value.problem
    assert caught.value.file == file
    assert caught.value.remedy


@pytest.mark.parametrize("suffix", ["stl", "obj", "glb", "dae", "off"])
def test_wrong_suffix(suffix: str, tmp_path: Path) -> None:
    file = put(tmp_path, "box.ply", box()).rename(tmp_path / f"box.{suffix}")
    with pytest.raises(FileError, match=r"has no triangles|cannot be read as") as caught:
        read(file)
    assert caught.value.remedy and "suffix" in caught.value.remedy


@pytest.mark.parametrize("cut", [0, 10, 100, 500, -1])
@pytest.mark.parametrize("kind", ["stl", "ply", "glb"])
def test_files_that_end_too_early(kind: str, cut: int, tmp_path: Path) -> None:
    file = put(tmp_path, f"ball.{kind}", BALL)
    file.write_bytes(file.read_bytes()[:cut])
    with pytest.raises(FileError):
        read(file)


def test_flat_and_crossing_surfaces(tmp_path: Path) -> None:
    square = bare([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2], [0, 2, 3]])
    with pytest.raises(FileError, match="lies in one plane and encloses no volume"):
        read(put(tmp_path, "flat.stl", square))
    # A prism over a figure of eight: one of its halves has the inner side out.
    eight = np.array([[-2, -1], [2, 1], [2, -1], [-2, 1]]) * 0.02
    corners = np.vstack([np.column_stack([eight, np.full(4, z)]) for z in (0, 0.02)])
    sides = [t for k in range(4) for t in ([k, (k + 1) % 4, k + 4], [(k + 1) % 4, (k + 1) % 4 + 4, k + 4])]
    caps = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]
    with pytest.raises(FileError, match="crosses itself: 36 % of its surface enclose nothing"):
        read(put(tmp_path, "eight.stl", bare(corners, np.array(sides + caps))))


def test_too_many_triangles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = put(tmp_path, "ball.stl", BALL)
    monkeypatch.setattr(mesh_content, "MOST_TRIANGLES", 5000)
    with pytest.raises(FileError, match="has 5120 triangles; at most 5000 are taken"):
        read(file)
    monkeypatch.setattr(mesh_content, "MOST_BYTES", 100_000)
    with pytest.raises(FileError, match=r"has 0 MB; at most 0 MB are read"):
        read(file, scale=2.0)


def test_copies_count_before_they_are_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = trimesh.Scene()
    scene.add_geometry(BALL, geom_name="ball", node_name="0")
    for k in range(1, 10):
        scene.graph.update(frame_to=str(k), geometry="ball", matrix=translation_matrix([k, 0, 0]))
    file = put(tmp_path, "balls.glb", scene)
    monkeypatch.setattr(mesh_content, "MOST_TRIANGLES", 20_000)
    with pytest.raises(FileError, match="has 51200 triangles"):
        read(file)


# ---- where files are


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"file: .*/none.stl cannot be read: no such file"):
        Mesh(file=tmp_path / "none.stl")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        Mesh(file=tmp_path / "folder.stl")
    with pytest.raises(InputError, match=r"is no mesh file that can be read. The suffix must be one of \.stl"):
        Mesh(file=tmp_path / "mesh.step")
    with pytest.raises(InputError, match=r"package://nobody/mesh.stl was not found. Looked in"):
        Mesh(file="package://nobody/mesh.stl")
    with pytest.raises(InputError, match="file: a text is wanted"):
        Mesh(file=3)
    for wrong in ({"scale": 0}, {"scale": [1, 2]}, {"unit": "ft"}, {"largest_hole": -1}, {"sha256": "ab"}):
        with pytest.raises(InputError, match=next(iter(wrong))):
            Mesh(file=put(tmp_path, "box.stl", box()), **wrong)


def test_meshes_of_wheels_are_found() -> None:
    address = "package://example-robot-data/robots/panda_description/meshes/collision/hand.stl"
    assert read_address(address).is_file()


def read_address(address: str) -> Path:
    return Mesh(file=address).file


TASK = {
    "object": "thing",
    "desired_contacts": [[0, 0.02, 0], [0, -0.02, 0]],
    "wrench": {"force": [0, 0, -1]},
    "contact": {"friction": 0.9, "min_normal_force": 0.001, "max_force": 5.0},
    "force_weight": 1.0,
}


def scene_with(shape: dict[str, Any]) -> dict[str, Any]:
    return {
        "format": 1,
        "name": "meshes",
        "enclosure": {"min": [-1, -1, -1], "max": [1, 1, 1]},
        "objects": {"thing": {"shape": shape}},
        "tasks": {"hold": TASK},
    }


def test_addresses_start_at_the_scene_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scenes").mkdir()
    (tmp_path / "meshes").mkdir()
    put(tmp_path, "meshes/box.stl", box())
    file = tmp_path / "scenes/meshes.yaml"
    file.write_text(json.dumps(scene_with({"type": "mesh", "file": "../meshes/box.stl"})))
    monkeypatch.chdir("/")
    shape = pinograsp.load_scene(file).objects["thing"].shape
    assert isinstance(shape, Mesh)
    assert shape.file == tmp_path / "meshes/box.stl"
    file.write_text(json.dumps(scene_with({"type": "mesh", "file": "box.stl"}), indent=1))
    with pytest.raises(InputError) as caught:
        pinograsp.load_scene(file)
    assert caught.value.key == "objects.thing.shape.file"
    assert caught.value.line
    assert "scenes/box.stl cannot be read" in caught.value.problem


# ---- content


def test_content_counts_in_hashes(tmp_path: Path, gen3: Any) -> None:
    mesh = put(tmp_path, "box.stl", box())
    file = tmp_path / "meshes.yaml"
    file.write_text(json.dumps(scene_with({"type": "mesh", "file": "box.stl"})))
    scene = pinograsp.load_scene(file)
    shape = scene.objects["thing"].shape
    assert isinstance(shape, Mesh) and shape.sha256 == digest_of(mesh)
    stated = provenance(gen3.description, scene, gen3.files)["sha256"]
    assert stated["objects.thing.shape.file"] == digest_of(mesh)
    assert stated == file_hashes(gen3.description, scene)
    assert type(scene).from_dict(scene.to_dict()) == scene == pickle.loads(pickle.dumps(scene))
    assert scene.digest != digest_of(file)
    put(tmp_path, "box.stl", trimesh.creation.box(extents=[0.06, 0.04, 0.03]))
    assert file_hashes(gen3.description, scene) != stated
    again = pinograsp.load_scene(file)
    assert again.digest != scene.digest
    assert again != scene
    with pytest.raises(FileError, match="is not the file that the scene was made with"):
        object_mesh(shape.model_copy(update={"scale": 1.5}))
    assert np.ptp(read(mesh).vertices, axis=0)[2] == pytest.approx(0.03)


def test_where_a_mesh_is_does_not_count_in_the_database(tmp_path: Path, gen3: Any) -> None:
    scene = pinograsp.load_scene("glovebox")
    one = put(tmp_path, "one.stl", box())
    (tmp_path / "other.stl").write_bytes(one.read_bytes())
    other = Mesh(file=tmp_path / "other.stl")
    made = [scene.with_obstacle("rack", Body(shape=shape)) for shape in (Mesh(file=one), other)]
    margins = scene.task("sphere").margin
    assert Identity.of(gen3, made[0], margins).digest == Identity.of(gen3, made[1], margins).digest
    assert made[0].digest == made[1].digest
    turned = box()
    turned.apply_translation([0, 0, 0.001])
    third = scene.with_obstacle("rack", Body(shape=Mesh(file=put(tmp_path, "one.stl", turned))))
    assert Identity.of(gen3, third, margins).digest != Identity.of(gen3, made[0], margins).digest
    assert "one" not in json.dumps(third.model_dump(mode="json", context=CONTENT, include={"obstacles"}))


def test_another_file_has_another_content(tmp_path: Path) -> None:
    shape = Mesh(file=put(tmp_path, "box.stl", box()))
    other = shape.model_copy(update={"file": put(tmp_path, "ball.stl", BALL)})
    assert other.sha256 == digest_of(tmp_path / "ball.stl")


def test_findings_are_told(tmp_path: Path) -> None:
    large = box()
    large.apply_scale(1000.0)
    content = scene_with({"type": "mesh", "file": str(put(tmp_path, "box.stl", large))})
    scene = pinograsp.Scene.from_dict(content)
    assert "mesh box.stl" in scene._repr_html_()
    said = list(mesh_findings(scene, scene.task("hold")))
    assert said == ["mesh of 'thing': taken as millimetres: it is 60 mm large, in metres it would be 60 m"]


def test_centre_of_mass(tmp_path: Path) -> None:
    moved = box()
    moved.apply_translation([0.1, 0.01, -0.005])
    moved.invert()
    body = Object(shape=Mesh(file=put(tmp_path, "box.stl", moved)), pose={"position": [0, 0, 1]})
    np.testing.assert_allclose(center_of_mass_world(body), [0.1, 0.01, 0.995], atol=1e-8)
    cone = trimesh.creation.cone(0.02, 0.08)
    np.testing.assert_allclose(filled(Mesh(file=put(tmp_path, "cone.ply", cone))).centroid, [0, 0, 0.02], atol=1e-4)


def test_scenes_without_meshes_read_no_mesh_library() -> None:
    code = "import sys, pinograsp; pinograsp.load_scene('glovebox'); assert 'trimesh' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ)


@pytest.mark.parametrize("far", [2e3, 1e300])
def test_a_corner_too_far_away_is_refused(far: float, tmp_path: Path) -> None:
    mesh = box()
    vertices = mesh.vertices.copy()
    vertices[0, 0] = far
    content = "\n".join(f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist())
    content += "\n" + "\n".join("f " + " ".join(map(str, face)) for face in (mesh.faces + 1).tolist())
    (tmp_path / "far.obj").write_text(content)
    with pytest.raises(
        FileError,
        match=f"has a corner that is .*{far:.3g}".replace("+", r"\+") + " m from its origin, more than 1000 m",
    ):
        read(tmp_path / "far.obj", unit="m")


def test_what_was_repaired_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By content and by the size of holes: it is made once, and again where its file is damaged."""
    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path))
    made: list[float] = []

    def counted(*mesh: Any) -> Repaired:
        made.append(mesh[2])
        return repaired(*mesh)

    monkeypatch.setattr("pinograsp.geometry.repair_cache.repaired", counted)
    vertices, faces = meshes.arrays(meshes.ball(0.02, 2))
    faces = np.concatenate([faces[1:], faces[5:6]])  # a hole, and a doubled triangle
    first, second = (kept_repaired("ball", vertices, faces, 0.01) for _ in range(2))
    assert made == [0.01]
    assert first.findings == second.findings
    assert len(first.findings) == 2
    for name in ("vertices", "faces", "origin", "outer"):
        one, other = getattr(first, name), getattr(second, name)
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other)
    kept_repaired("ball", vertices, faces, 0.02)
    kept_repaired("ball", 2.0 * vertices, faces, 0.02)
    assert made == [0.01, 0.02, 0.02]
    for file in (tmp_path / "repaired").iterdir():
        file.write_bytes(file.read_bytes()[:500])
    kept_repaired("ball", vertices, faces, 0.01)
    assert len(made) == 4
