"""Triangle meshes: what they enclose, whether they overlap, and the meshes of links."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trimesh
from conftest import TOY_URDF, Array, RobotFactory

import pinograsp
from pinograsp.geometry.hulls import FlatError
from pinograsp.geometry.primitives import primitive_triangles
from pinograsp.geometry.triangle_mesh import TriangleMesh, winding_number
from pinograsp.kinematics.collision_elements import collision_elements, link_elements
from pinograsp.onboarding.link_meshes import link_meshes
from pinograsp.verification.kinematics import parsed
from pinograsp.verification.meshes import read_meshes


def box(*edges: float, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Array:
    return primitive_triangles("box", edges) + at


def shifted(x: float, y: float = 0.0, z: float = 0.0) -> Array:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


TURNED = trimesh.transformations.rotation_matrix(0.5 * np.pi, [0.0, 0.0, 1.0])


def test_what_a_bracket_encloses() -> None:
    """Its corner is in the hull and not in the bracket; a missing triangle far away does not spoil that."""
    bracket = np.concatenate([box(0.1, 0.02, 0.02), box(0.02, 0.08, 0.02, at=(-0.04, 0.049, 0.0))])
    points = np.array([[0.0, 0.0, 0.0], [-0.04, 0.05, 0.0], [0.0, 0.03, 0.0], [1.0, 0.0, 0.0]])
    mesh = TriangleMesh(bracket)
    assert mesh.surrounds(points).tolist() == [True, True, False, False]
    assert mesh.surrounds(points[2:]).tolist() == [False, False]
    assert mesh.closed
    assert len(mesh.members) == 2
    leaky = TriangleMesh(bracket[1:])
    assert not leaky.closed
    assert leaky.surrounds(points).tolist()[1:] == [True, False, False]
    assert winding_number(bracket, points[0]) == pytest.approx(1.0)
    assert winding_number(bracket[:, ::-1], points[0]) == pytest.approx(-1.0)


def test_a_flat_mesh_encloses_nothing_that_could_be_told() -> None:
    with pytest.raises(FlatError):
        TriangleMesh(box(0.1, 0.1, 0.1)[:1]).surrounds(np.zeros((1, 3)))


@pytest.mark.parametrize(
    ("pose", "distance", "overlaps"),
    [
        (shifted(0.16), 0.01, False),
        (shifted(0.14), None, True),
        (shifted(0.045), 0.005, True),  # wholly inside: surfaces apart
        (shifted(0.0, 0.16), 0.105, False),
        (shifted(0.0, 0.16) @ TURNED, 0.06, False),  # the long side of the small one is along y now
    ],
)
def test_two_meshes(pose: Array, distance: float | None, overlaps: bool) -> None:
    large, small = TriangleMesh(box(0.2, 0.1, 0.1)), TriangleMesh(box(0.1, 0.01, 0.01))
    found = large.surface.distance_to(small.surface, pose)
    back = small.surface.distance_to(large.surface, np.linalg.inv(pose))
    if distance is None:
        assert found <= 0.0
        assert back <= 0.0
    else:
        assert found == pytest.approx(distance, abs=1e-9)
        assert back == pytest.approx(distance, abs=1e-9)
    assert large.overlaps(small, pose) == overlaps
    assert small.overlaps(large, np.linalg.inv(pose)) == overlaps


@pytest.mark.parametrize(("kind", "size"), [("box", (0.1, 0.2, 0.3)), ("sphere", (0.1,)), ("cylinder", (0.1, 0.3))])
def test_primitives_stand_around_what_they_stand_for(kind: str, size: tuple[float, ...]) -> None:
    triangles = primitive_triangles(kind, size)
    assert TriangleMesh(triangles).closed
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    heights = (normals * triangles[:, 0]).sum(axis=1)
    assert heights.min() >= {"box": 0.05, "sphere": 0.1, "cylinder": 0.1}[kind] - 1e-12
    volume = {"box": 0.006, "sphere": 4e-3 * np.pi / 3, "cylinder": 3e-3 * np.pi}[kind]
    assert volume * (1.0 - 1e-9) <= trimesh.Trimesh(**trimesh.triangles.to_kwargs(triangles)).volume < 1.005 * volume


# ---- the meshes of links


@pytest.mark.parametrize("name", ["gen3_2f85", "panda", "xarm7_allegro"])
def test_meshes_of_links_are_those_of_the_verification(name: str) -> None:
    robot = pinograsp.load_robot(name)
    description = robot.description
    found = link_meshes(link_elements(robot.urdf.composed, description.urdf_file))
    expected = read_meshes(parsed(robot.urdf.composed, description.urdf_file), description)
    assert list(found) == list(expected)
    for link, mesh in expected.items():
        np.testing.assert_allclose(found[link].triangles, mesh.triangles, atol=1e-9)


def test_a_mirrored_mesh_keeps_its_outside(make_toy: RobotFactory, tmp_path: Path) -> None:
    file = tmp_path / "wedge.stl"
    wedge = trimesh.convex.convex_hull([[0, 0, 0], [0.01, 0, 0], [0, 0.02, 0], [0, 0, 0.04]])
    wedge.export(file)
    text = TOY_URDF.replace('<box size="0.01 0.02 0.04"/>', '<mesh filename="wedge.stl" scale="1 -1 1"/>', 1)
    robot = make_toy(text, meshes=(file,))
    mesh = link_meshes(link_elements(robot.urdf.composed, file))["left"]
    assert mesh.corners[:, 1].min() == pytest.approx(-0.02)
    inside = mesh.corners.mean(axis=0)
    assert winding_number(mesh.triangles, inside) == pytest.approx(1.0)


def test_elements_of_a_robot_are_those_of_its_links_in_joint_frames(gen3: pinograsp.Robot) -> None:
    elements = {id_of(e): e for e in link_elements(gen3.urdf.composed, gen3.description.urdf_file)}
    placed = collision_elements(gen3)
    assert len(placed) == len(elements) > 10
    poses = gen3.urdf.tree.poses({})
    data = gen3.model.createData()
    pin.forwardKinematics(gen3.model, data, np.zeros(gen3.model.nq))
    for element in placed:
        at = poses[element.link] @ elements[id_of(element)].origin
        np.testing.assert_allclose(data.oMi[element.joint].homogeneous @ element.placement, at, atol=1e-12)


def id_of(element: object) -> tuple[object, ...]:
    return (element.link, element.kind, element.size, element.mesh)  # type: ignore[attr-defined]
