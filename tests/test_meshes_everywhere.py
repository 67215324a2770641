"""Mesh objects in every room besides contact and verification: hold test, assessment, results, notebooks, progress."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import meshes
import numpy as np
import pytest
import trimesh
from places import changed

import pinograsp
from pinograsp import Compound, Cone, HoldOptions, Mesh, Progress, TaskError
from pinograsp.assessment.closing import moved
from pinograsp.assessment.judge import Judge
from pinograsp.assessment.margins import margin_of
from pinograsp.cli.hold import _lines
from pinograsp.descriptions import Scene
from pinograsp.errors import FileError
from pinograsp.geometry.convex_solid import convex_solid
from pinograsp.geometry.filled import filled
from pinograsp.geometry.hulls import Hull
from pinograsp.geometry.shapes import surface_of
from pinograsp.hold.object_pieces import Standoff
from pinograsp.hold.objects import object_body
from pinograsp.kinematics.robot import Robot
from pinograsp.problem import check_placement

RADIUS = 0.0373


def mesh_shape(mesh: Any, folder: Path, name: str = "body.ply") -> dict[str, Any]:
    return {"type": "mesh", "file": str(meshes.written(mesh, folder / name)), "unit": "m"}


def with_object(scene: Scene, shape: dict[str, Any]) -> Scene:
    points = ((0.0, RADIUS, 0.0), (0.0, -RADIUS, 0.0))
    return changed(changed(scene, "objects", shape=shape), "tasks", desired_contacts=points)


@pytest.fixture(scope="module")
def ball(glovebox: Scene, tmp_path_factory: pytest.TempPathFactory) -> Scene:
    """The shipped scene with a mesh of its ball."""
    return with_object(glovebox, mesh_shape(meshes.ball(RADIUS, 5), tmp_path_factory.mktemp("ball")))


@pytest.fixture(scope="module")
def stages() -> list[Progress]:
    return []


@pytest.fixture(scope="module")
def result(gen3: Robot, ball: Scene, stages: list[Progress]) -> pinograsp.Result:
    return pinograsp.plan(gen3, ball, "sphere", starts=2, workers=1, progress=stages.append)


# ---- results


def test_a_result_is_verified_from_its_file(result: pinograsp.Result, tmp_path: Path) -> None:
    """What it says is what follows from the triangles, not from the lattice of the solver."""
    assert result.verified == 2
    pinograsp.write_json(result, tmp_path / "result.json")
    assert pinograsp.verify(pinograsp.read_json(tmp_path / "result.json")) == ()


def test_preparation_of_meshes_is_said(result: pinograsp.Result, stages: list[Progress]) -> None:
    assert stages[0] == Progress("meshes", 0, 1)


@pytest.mark.parametrize("gone", [True, False])
def test_a_mesh_that_is_gone_or_another_is_named(result: pinograsp.Result, tmp_path: Path, gone: bool) -> None:
    file = meshes.written(meshes.ball(RADIUS, 2), tmp_path / "ball.ply")
    scene = with_object(result.setup.scene, {"type": "mesh", "file": str(file), "unit": "m"})
    setup = replace(result.setup, scene=scene)
    grasp = replace(result.grasps[0], setup=setup)
    if gone:
        file.unlink()
        words = "cannot be read: no such file"
    else:
        meshes.written(meshes.ball(0.03, 2), file)
        words = "is not the file that the scene was made with"
    for use in (
        lambda: pinograsp.visualization.write_html(grasp, tmp_path / "page.html"),
        lambda: pinograsp.hold_test(grasp, workers=1),
        lambda: pinograsp.assess(grasp, samples=1, workers=1),
        lambda: pinograsp.verify(replace(result, setup=setup)),
    ):
        with pytest.raises(FileError, match=words) as caught:
            use()
        assert caught.value.key == "objects.sphere.shape.file"
        assert caught.value.problem.startswith(f"{file} ")


def test_what_notebooks_show(result: pinograsp.Result, ball: Scene, tmp_path: Path) -> None:
    assert "mesh body.ply" in ball._repr_html_()
    pinograsp.visualization.write_html(result, tmp_path / "page.html")
    assert (tmp_path / "page.html").stat().st_size > 1e6


# ---- hold test


def test_a_mesh_is_held_and_dropped_as_the_ball_is(result: pinograsp.Result) -> None:
    pytest.importorskip("mujoco")
    (outcome,) = pinograsp.hold_test(result, 1, workers=1, options=HoldOptions(controls=True, spin=0.0))
    assert outcome.held
    assert outcome.controls == {"no squeeze": False, "no friction": False}
    assert outcome.force_error < 0.02
    assert outcome.standoff < 2e-4


def test_inertia_and_volume(tmp_path: Path) -> None:
    """Of a box off its frame's origin; of a truncated cone as of its triangles."""
    away = trimesh.creation.box((0.02, 0.03, 0.05)).apply_translation((0.1, 0.02, -0.03))
    box = Mesh(**mesh_shape(away, tmp_path, "box.stl"))
    assert filled(box).volume == pytest.approx(3e-5, rel=1e-5)
    expected = np.diag([0.03**2 + 0.05**2, 0.02**2 + 0.05**2, 0.02**2 + 0.03**2]) / 12.0
    np.testing.assert_allclose(object_body("it", box).inertia, expected, atol=1e-9)
    both = Compound(parts=({"shape": box}, {"shape": box, "pose": {"position": (-0.2, 0.0, 0.0)}}))
    assert filled(both).volume == pytest.approx(6e-5, rel=1e-5)
    np.testing.assert_allclose(filled(both).centroid, (0.0, 0.02, -0.03), atol=1e-7)
    apart = expected + np.diag([0.0, 0.01, 0.01])
    np.testing.assert_allclose(object_body("it", both).inertia, apart, atol=1e-7)
    cone = Cone(bottom_radius=0.03, top_radius=0.01, height=0.05)
    fine = trimesh.creation.revolve([(0, -0.025), (0.03, -0.025), (0.01, 0.025), (0, 0.025)], sections=400)
    meshed = Mesh(**mesh_shape(fine, tmp_path, "cone.ply"))
    np.testing.assert_allclose(object_body("it", cone).inertia, object_body("it", meshed).inertia, rtol=1e-3, atol=1e-9)


def test_how_far_pieces_stand_off() -> None:
    """One hull over an angle of 5 mm sheet, and one hull for each of its two plates."""
    angle = meshes.box([0, 0, 0], [0.04, 0.02, 0.005]).union(
        meshes.box([0, 0, 0], [0.005, 0.02, 0.04]), engine="manifold"
    )
    vertices, faces = meshes.arrays(angle)
    standoff = Standoff(vertices[faces], [vertices])
    outside, inside = np.array([0.02, 0.01, 0.0]), np.array([0.02, 0.01, 0.005])
    assert standoff.at(outside, np.array([0.0, 0.0, -1.0]), 0.001) == pytest.approx(0.0, abs=1e-9)
    # The hull ends at x + z = 45 mm; of what is looked at around x = 20 mm, x = 10 mm is farthest from there.
    assert standoff.at(inside, np.array([0.0, 0.0, 1.0]), 0.001) == pytest.approx(0.030, abs=1e-3)
    exact = Standoff(vertices[faces], [vertices[vertices[:, 2] < 0.006], vertices[vertices[:, 0] < 0.006]])
    assert exact.at(inside, np.array([0.0, 0.0, 1.0]), 0.001) < 1e-9


def test_pieces_that_stand_off_are_told(result: pinograsp.Result) -> None:
    pytest.importorskip("mujoco")
    (outcome,) = pinograsp.hold_test(result, 1, workers=1, options=HoldOptions(acceleration=0.0, spin=0.0))
    said = "grasp 1: the convex pieces that stand for the object are 1.2 mm off it where pads touch"
    assert any(line.startswith(said) for line in _lines([replace(outcome, standoff=0.0012)], HoldOptions()))
    assert not any("pieces" in line for line in _lines([outcome], HoldOptions()))


# ---- assessment


def test_margins_are_those_of_the_ball(result: pinograsp.Result, glovebox: Scene, gen3: Robot) -> None:
    """The same grasp of the shape and of its mesh; a mesh is touched by an area, so centres of mass may be farther."""
    found = pinograsp.plan(gen3, glovebox, "sphere", starts=1, workers=1).best
    assert found is not None
    scene = glovebox.with_object("sphere", result.setup.scene.objects["sphere"])
    on_shape, on_mesh = Judge(found), Judge(replace(found, setup=replace(found.required_setup, scene=scene)))
    for kind in ("position", "friction", "weight"):
        one, other = margin_of(on_shape, kind), margin_of(on_mesh, kind)
        assert other.size == pytest.approx(one.size, rel=0.03), kind
    errors = (np.array([0.002, -0.001, 0.002]), np.array([0.02, 0.03, -0.02]))
    poses = [
        judge.closing.closed(found.q_arm, moved(judge.T_world_object, *errors)[0]).T_world_object[:3, 3]
        for judge in (on_shape, on_mesh)
    ]
    np.testing.assert_allclose(poses[0], poses[1], atol=5e-5)


# ---- bodies in the way


def test_a_compound_with_a_mesh_is_an_obstacle_and_no_object(glovebox: Scene, tmp_path: Path) -> None:
    fine = mesh_shape(meshes.cylinder(0.033, -0.035, 0.035, sections=400), tmp_path)
    lid = {"shape": {"type": "sphere", "radius": 0.015}, "pose": {"position": (0.0, 0.0, 0.045)}}
    shape = {"type": "compound", "parts": ({"shape": fine}, lid)}
    with pytest.raises(TaskError, match="a compound with a mesh cannot be grasped") as caught:
        check_placement(changed(glovebox, "objects", shape=shape), "sphere")
    assert caught.value.key == "objects.sphere.shape"
    content = glovebox.model_dump() | {"obstacles": {"can": {"shape": shape, "pose": {"position": (0.6, -0.3, 0.0)}}}}
    check_placement(Scene.model_validate(content), "sphere")
    assert len(surface_of(Scene.model_validate(content).obstacles["can"].shape).solids()) > 1


@pytest.mark.parametrize("tip", [False, True])
def test_hulls_with_a_corner_of_many_neighbours(tip: bool) -> None:
    """The flat end of a fine cylinder, and the tip of a fine cone: what Coal gets holds all of it, and little more."""
    angles = np.linspace(0.0, 2.0 * np.pi, 1000, endpoint=False)
    circle = np.column_stack([0.03 * np.cos(angles), 0.03 * np.sin(angles), np.zeros(1000)])
    top = np.array([0.0, 0.0, 0.05])
    points = np.vstack([circle, top if tip else circle + top])
    hull = Hull(np.array(convex_solid(points).points()))
    assert hull.outside(points).max() < 1e-9
    assert Hull(points).outside(hull.vertices).max() < 1e-4
