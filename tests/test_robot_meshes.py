"""Mesh files of robots: units, axes, corners that are none, files that are none; and meshes of many triangles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import coal
import numpy as np
import pytest
import trimesh
import yaml
from conftest import TOY_ROBOT, TOY_URDF, Array
from scipy.spatial import ConvexHull

import pinograsp
from pinograsp import FileError, InputError
from pinograsp.collision.solids import link_bodies
from pinograsp.descriptions import load_robot_description
from pinograsp.geometry import covers
from pinograsp.geometry.convex_solid import convex_solid, solid_corners
from pinograsp.geometry.covers import cover
from pinograsp.geometry.few_corners import corners_around
from pinograsp.geometry.mesh_file import read_triangles
from pinograsp.onboarding.check import check_robot
from pinograsp.verification.coal_bodies import hull_solid
from pinograsp.verification.robot import VerifiedRobot

LEFT_BOX = '<origin xyz="0.005 0 0.02"/><geometry><box size="0.01 0.02 0.04"/></geometry>'


def toy(folder: Path, mesh: str, scale: str = "1 1 1") -> Path:
    """Write the toy with a mesh file as the left finger; return its robot file."""
    assert LEFT_BOX in TOY_URDF
    collision = f'<geometry><mesh filename="{mesh}" scale="{scale}"/></geometry>'
    (folder / "toy.urdf").write_text(TOY_URDF.replace(LEFT_BOX, collision))
    (folder / "robot.yaml").write_text(yaml.safe_dump(TOY_ROBOT))
    return folder / "robot.yaml"


def finger(scale: float = 1.0) -> Any:
    """Return the toy's left finger as a mesh."""
    return trimesh.creation.box(bounds=[[0.0, -0.01 * scale, 0.0], [0.01 * scale, 0.01 * scale, 0.04 * scale]])


def collada(mesh: Any, unit: str = "", axis: str = "Z_UP") -> str:
    """Return a mesh as a COLLADA file."""
    places = " ".join(repr(float(v)) for v in mesh.vertices.ravel())
    corners = " ".join(str(v) for v in mesh.faces.ravel())
    accessor = "".join(f'<param name="{name}" type="float"/>' for name in "XYZ")
    return (
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
        f"<asset>{unit}<up_axis>{axis}</up_axis></asset><library_geometries><geometry id='g'><mesh><source id='p'>"
        f"<float_array id='pa' count='{mesh.vertices.size}'>{places}</float_array><technique_common>"
        f"<accessor source='#pa' count='{len(mesh.vertices)}' stride='3'>{accessor}</accessor></technique_common>"
        "</source><vertices id='v'><input semantic='POSITION' source='#p'/></vertices>"
        f"<triangles count='{len(mesh.faces)}'><input semantic='VERTEX' source='#v' offset='0'/><p>{corners}</p>"
        "</triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='s'><node id='n'>"
        "<instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>"
        "<scene><instance_visual_scene url='#s'/></scene></COLLADA>"
    )


def bounds_of(file: Path) -> tuple[Array, Array]:
    """Return the bounds of the left finger as the planner and as the verification have it."""
    description = load_robot_description(file)
    mesh = VerifiedRobot(description).meshes["left"]
    kept = file.parent / "f.dae" if (file.parent / "f.dae").exists() else file.parent / "f.obj"
    ours = read_triangles(kept, np.ones(3)).reshape(-1, 3)
    return np.array([ours.min(axis=0), ours.max(axis=0)]), np.array(
        [mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)]
    )


@pytest.mark.parametrize(("metres", "name"), [(1.0, "meter"), (0.001, "millimeter"), (0.0254, "inch"), (0.01, "u")])
def test_the_unit_of_a_collada_file_counts(metres: float, name: str, tmp_path: Path) -> None:
    (tmp_path / "f.dae").write_text(collada(finger(1.0 / metres), f'<unit name="{name}" meter="{metres}"/>'))
    for bounds in bounds_of(toy(tmp_path, "f.dae")):
        np.testing.assert_allclose(bounds, [[0, -0.01, 0], [0.01, 0.01, 0.04]], atol=1e-8)
    assert not check_robot(tmp_path).wrong


def test_an_upward_axis_turns_nothing_and_is_told(tmp_path: Path) -> None:
    (tmp_path / "f.dae").write_text(collada(finger(), axis="Y_UP"))
    for bounds in bounds_of(toy(tmp_path, "f.dae")):
        np.testing.assert_allclose(bounds, [[0, -0.01, 0], [0.01, 0.01, 0.04]], atol=1e-8)
    found = [finding for finding in check_robot(tmp_path).findings if finding.level == "doubtful"]
    assert [finding.what for finding in found] == ["f.dae of link left says Y_UP"]


@pytest.mark.parametrize(("factor", "unit"), [(1000.0, "mm"), (1 / 0.0254, "in"), (100.0, "cm")])
def test_a_link_that_is_longer_than_the_robot_is_doubtful(factor: float, unit: str, tmp_path: Path) -> None:
    """The finger of 40 mm, its mesh in another unit that nobody states."""
    finger(factor).export(tmp_path / "f.stl")
    found = [finding for finding in check_robot(toy(tmp_path, "f.stl")).findings if "link left is" in finding.what]
    assert [finding.level for finding in found] == ["doubtful"]
    assert f"in {unit}, 40 mm" in found[0].remedy


def test_indices_that_count_back_are_read_alike(tmp_path: Path) -> None:
    """Two boxes, one on the other, each with faces that count back from its own last vertex."""
    lines = []
    for low in (0.0, 0.02):
        box = trimesh.creation.box(bounds=[[0.0, -0.01, low], [0.01, 0.01, low + 0.02]])
        lines += [f"o part{low}", *(f"v {x} {y} {z}" for x, y, z in box.vertices)]
        lines += ["f " + " ".join(str(corner - len(box.vertices)) for corner in face) for face in box.faces]
    (tmp_path / "f.obj").write_text("\n".join(lines))
    file = toy(tmp_path, "f.obj")
    for bounds in bounds_of(file):
        np.testing.assert_allclose(bounds, [[0, -0.01, 0], [0.01, 0.01, 0.04]], atol=1e-12)
    mesh = VerifiedRobot(load_robot_description(file)).meshes["left"]
    a, b, c = mesh.triangles.transpose(1, 0, 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0 == pytest.approx(0.01 * 0.02 * 0.04)


BOX = "\n".join(
    [
        *(f"v {x} {y} {z}" for x, y, z in finger().vertices),
        *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in finger().faces),
    ]
)
SPOILED: dict[str, tuple[str, bytes, str]] = {
    "nan": ("f.obj", BOX.replace("v 0.0 -0.01 0.0", "v nan -0.01 0.0").encode(), "not finite"),
    "infinite": ("f.obj", BOX.replace("v 0.0 -0.01 0.0", "v 0.0 inf 0.0").encode(), "not finite"),
    "far": ("f.obj", BOX.replace("v 0.0 -0.01 0.0", "v 0.0 1e300 0.0").encode(), "1e+300 m from its origin"),
    "far enough to hide": (
        "f.obj",
        BOX.replace("v 0.0 -0.01 0.0", "v 0.0 2e3 0.0").encode(),
        "2e+03 m from its origin",
    ),
    "index": ("f.obj", f"{BOX}\nf 1 2 99999999\n".encode(), "99999999, of 8"),
    "back": ("f.obj", f"{BOX}\nf 1 2 -9\n".encode(), "-9, of 8"),
    "collada": ("f.dae", collada(finger())[:900].encode(), "cannot be read as DAE"),
    "no collada": ("f.dae", b"<robot/>", "f.dae"),
    "empty": ("f.stl", b"", "is an empty file"),
    "blank": ("f.obj", b" \n", "is an empty file"),
    "pointer": ("f.stl", b"version https://git-lfs.github.com/spec/v1\noid sha256:01\nsize 184\n", "Git LFS"),
    "points": ("f.obj", b"v 0 0 0\nv 1 0 0\n", "has no triangles"),
    "suffix": ("f.step", b"ISO-10303-21;", "is no mesh file that can be read"),
    "cut": ("f.stl", finger().export(file_type="stl")[:300], "f.stl"),
}


@pytest.mark.parametrize("case", SPOILED)
def test_a_file_that_holds_no_mesh_is_refused_with_the_link(case: str, tmp_path: Path) -> None:
    """By planner and verification, neither of which takes what is left of the mesh."""
    name, content, words = SPOILED[case]
    (tmp_path / name).write_bytes(content)
    file = toy(tmp_path, name)
    report = check_robot(file)
    assert report.wrong and len(report.findings) == 1
    what = report.findings[0].what
    assert words in what and str(tmp_path / name) in what and "link left" in what
    with pytest.raises(FileError, match=r"link left"):
        VerifiedRobot(load_robot_description(file))


# ---- hulls that Coal does not take


def turned(mesh: Any) -> Array:
    mesh.apply_transform(trimesh.transformations.rotation_matrix(0.7, [0.3, 0.5, 0.8]))
    return np.asarray(mesh.vertices)


ROUND = {
    "disc": lambda: trimesh.creation.cylinder(0.045, 0.26, sections=600),
    "thin disc": lambda: trimesh.creation.cylinder(0.045, 0.002, sections=700),
    "cone": lambda: trimesh.creation.cone(0.045, 0.26, sections=700),
    "pole": lambda: trimesh.creation.uv_sphere(radius=0.05, count=[5, 280]),
}


@pytest.mark.parametrize("name", ROUND)
def test_corners_with_hundreds_of_neighbours(name: str) -> None:
    """Coal refuses the hull; both solids contain it, the planner's with at most 0.5 % more volume."""
    points = turned(ROUND[name]())
    cloud = coal.StdVec_Vec3s()
    cloud.extend(list(points))
    with pytest.raises(RuntimeError):
        coal.Convex.convexHull(cloud, True, "Qt")
    hull = ConvexHull(points)
    for solid, most in ((convex_solid(points), 1.005), (hull_solid(points[hull.vertices]), 1.06)):
        around = ConvexHull(np.array(solid.points()))
        assert (points @ around.equations[:, :3].T + around.equations[:, 3]).max() < 1e-12
        assert 1.0 <= around.volume / hull.volume < most


def test_what_coal_takes_stays_as_it_is() -> None:
    points = turned(trimesh.creation.icosphere(3, radius=0.05))
    np.testing.assert_array_equal(solid_corners(points), points)


def test_a_polyhedron_of_few_corners_around_many_points() -> None:
    """Of a box nothing is added; a ball grows by less than the squared distance between directions."""
    box = turned(trimesh.creation.box((0.1, 0.2, 0.05)).subdivide().subdivide())
    assert ConvexHull(corners_around(box, 64)).volume == pytest.approx(0.1 * 0.2 * 0.05, rel=1e-6)
    ball = turned(trimesh.creation.icosphere(5, radius=0.05))
    corners = corners_around(ball, 128)
    assert np.linalg.norm(corners, axis=1).max() < 0.05 * 1.04
    assert len(corners) < len(ball) / 5


def test_a_cover_of_a_fine_mesh_has_few_corners(monkeypatch: pytest.MonkeyPatch) -> None:
    """Limits lowered, so that a mesh of 9,600 triangles is a large one: pieces contain it, and Coal takes them."""
    monkeypatch.setattr(covers, "_MANY", 10_000)
    monkeypatch.setattr(covers, "MOST_CORNERS", 200)
    mesh = trimesh.creation.torus(0.08, 0.02, major_sections=120, minor_sections=40)
    triangles = np.asarray(mesh.triangles)
    pieces = cover(triangles, 6, 0.002)
    assert len(pieces) == 6 and max(map(len, pieces)) < 3000
    outside = np.full(len(mesh.vertices), np.inf)
    for piece in pieces:
        around = ConvexHull(np.array(convex_solid(piece).points()))
        outside = np.minimum(outside, (mesh.vertices @ around.equations[:, :3].T + around.equations[:, 3]).max(axis=1))
    assert outside.max() < 1e-12


def test_a_robot_with_a_fine_disc_plans(tmp_path: Path) -> None:
    """From the URDF to the check, with a link of 600 sides, which stands off by little."""
    disc = trimesh.creation.cylinder(0.02, 0.04, sections=600)
    disc.apply_translation([0.02, 0.0, 0.02])
    disc.export(tmp_path / "f.stl")
    report = check_robot(toy(tmp_path, "f.stl"))
    assert not report.wrong
    left = next(link for link in report.links if link.link == "left")
    assert (left.pieces, left.closed) == (1, True) and left.most < 1e-4
    assert pinograsp.load_robot(tmp_path).urdf.links == ("base", "arm", "left", "right")


def test_a_sheet_is_in_the_way_on_both_of_its_sides(tmp_path: Path) -> None:
    """A flat mesh encloses nothing, but what is to keep clear of it has the same distance for both readers."""
    sheet = trimesh.Trimesh(
        [[0.0, -0.01, 0.0], [0.0, 0.01, 0.0], [0.0, 0.01, 0.04], [0.0, -0.01, 0.04]], [[0, 1, 2], [0, 2, 3]]
    )
    sheet.export(tmp_path / "sheet.stl")
    robot = pinograsp.load_robot(toy(tmp_path, "sheet.stl"))
    body = next(body for body in link_bodies(robot) if body.name == "left")
    [solid] = body.solids
    mesh = VerifiedRobot(robot.description).meshes["left"]
    assert not mesh.surrounds(np.array([[0.0, 0.0, 0.02]]))
    ball = coal.Sphere(0.005)
    ball.computeLocalAABB()
    for x in (-0.02, -0.006, 0.006, 0.02):
        T = coal.Transform3s(np.eye(3), np.array([x, 0.0, 0.02]))
        for shape, excess in ((solid.shape, 1e-6), (mesh.solid, 1e-9)):
            found = coal.distance(ball, T, shape, coal.Transform3s(), coal.DistanceRequest(), coal.DistanceResult())
            assert found == pytest.approx(abs(x) - 0.005, abs=excess)
    (tmp_path / "line.obj").write_text("v 0 0 0\nv 0 0 0.04\nv 0 0 0.02\nf 1 2 3\n")
    with pytest.raises(InputError, match="no area"):
        link_bodies(pinograsp.load_robot(toy(tmp_path, "line.obj")))
