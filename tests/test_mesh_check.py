"""The independent check of grasps on meshes: what holds on a ball, a can and a box holds on their triangles."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import igl
import numpy as np
import pytest
import trimesh
from meshes import arrays, bracket, mug
from numpy.typing import NDArray
from pydantic import TypeAdapter
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist
from test_verification import ROOM, Case, names, scene_with

from pinograsp.descriptions import Scene, load_robot_description
from pinograsp.descriptions.bodies import Body
from pinograsp.descriptions.hand import HardFinger, PadDescription
from pinograsp.descriptions.patches import Patch
from pinograsp.descriptions.regions import Near
from pinograsp.descriptions.shapes import Compound, Mesh
from pinograsp.errors import FileError
from pinograsp.verification import Certificate
from pinograsp.verification.check import Verifier
from pinograsp.verification.claim import Claim
from pinograsp.verification.crossing_kernels import LAYER
from pinograsp.verification.crossings import Crossings, crossings_of
from pinograsp.verification.forces import balance_figures
from pinograsp.verification.free_balls import sides
from pinograsp.verification.meshes import _link_mesh
from pinograsp.verification.object_mesh import object_mesh
from pinograsp.verification.openings import DOUBT, Openings, distance_of_ways
from pinograsp.verification.outlines import half_sides, points_of, rubber_at
from pinograsp.verification.patches import heights, nearest_on_patch
from pinograsp.verification.pieces import in_pieces
from pinograsp.verification.plain_faces import Triangles
from pinograsp.verification.region_depth import least_depth
from pinograsp.verification.rubber import PadLink
from pinograsp.verification.shapes import PlacedShape
from pinograsp.verification.triangle_body import TriangleBody

Array = NDArray[np.float64]
PALM = "robotiq_85_base_link"


@pytest.fixture(scope="module")
def case() -> Case:
    robot = load_robot_description("gen3_2f85")
    return Case(robot, Verifier(robot, scene_with(enclosure=ROOM), "sphere"))


Check = Callable[..., Certificate]


@pytest.fixture
def check(case: Case, tmp_path: Path) -> Check:
    """Check the grasp of the case with the object replaced.

    The object's frame is at the middle between the pads: x along the jaw, towards the first pad's outward normal, y
    along the x axis of the pads (38 mm of rubber), z along their y axis (20 mm of rubber).
    """
    third = np.cross(case.jaw, case.across)
    R = np.column_stack([case.jaw, case.across, third])
    rpy = [math.atan2(R[2, 1], R[2, 2]), math.asin(-R[2, 0]), math.atan2(R[1, 0], R[0, 0])]
    pose = {"position": case.center.tolist(), "rpy": rpy}

    def checked(shape: Any, **task: Any) -> Certificate:
        verifier = Verifier(case.robot, scene(shape, **task), "sphere")
        certificate = verifier.certify(case.claim)
        # Pair by pair it is the same.
        pairs = verifier.clearances(case.claim.joints)
        for name in ("object clearance", "pad clearance"):
            assert min(pair.distance for pair in pairs if pair.name == name) == certificate[name].value
        return certificate

    def scene(shape: Any, **task: Any) -> Scene:
        if not isinstance(shape, dict):
            shape.export(tmp_path / "object.ply")
            shape = {"type": "mesh", "file": str(tmp_path / "object.ply")}
        given = case.scene(**task).model_dump()
        given["objects"]["sphere"] = {"shape": shape, "pose": pose, "center_of_mass": [0, 0, 0]}
        return Scene.model_validate(given)

    return checked


def turned(mesh: Any, angle: float, axis: list[float]) -> Any:
    return mesh.copy().apply_transform(trimesh.transformations.rotation_matrix(angle, axis))


def block(case: Case, tilt: float = 0.0, axis: tuple[float, float, float] = (0.0, 0.0, 1.0)) -> Any:
    """Return a box, tilted about an axis, whose faces go through the contact points; divided into small triangles."""
    box = trimesh.creation.box(extents=[2 * case.radius * math.cos(tilt), 0.038, 0.06]).subdivide_to_size(0.006)
    box.merge_vertices()
    return turned(box, tilt, list(axis))


def bumped(case: Case, height: float, radius: float = 0.004) -> Any:
    """Return the box with a round bump that stands so far out of the side of the first contact, 8 mm off it."""
    ball = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    ball.apply_translation([-case.radius + radius - height, 0.008, 0.0])
    return block(case).union(ball, engine="manifold")


# ---- bodies of triangles


def body_of(mesh: Any) -> TriangleBody:
    return TriangleBody(*arrays(mesh))


def test_the_footprint_normal_is_the_mean_over_facets() -> None:
    """A can of 48 sides: facets are up to 3.75 degrees off the round side, footprint normals at most 0.2."""
    can = body_of(trimesh.creation.cylinder(0.03, 0.1, sections=48))
    assert can.sigma == 0.002
    angles = np.random.default_rng(0).uniform(-math.pi, math.pi, 20)
    for angle in angles:
        radial = np.array([math.cos(angle), math.sin(angle), 0.0])
        normal = can.outward(0.02995 * radial)
        assert math.acos(min(1.0, normal @ radial)) < math.radians(0.2)
        assert abs(normal[2]) < 5e-4


def test_the_footprint_normal_is_the_gradient_of_the_smoothed_distance() -> None:
    """Against differences of the mean of the distance at 16,000 points of the normal distribution, on a bent sheet."""
    body = body_of(bracket())
    point, rng = np.array([0.012, 0.004, 0.0055]), np.random.default_rng(0)
    cloud = body.sigma * rng.normal(size=(8_000, 3))
    cloud = np.concatenate([cloud, -cloud])
    step = 1e-3 * np.eye(3)
    slope = [body.distances(point + d + cloud).mean() - body.distances(point - d + cloud).mean() for d in step]
    slope = np.array(slope) / np.linalg.norm(slope)
    assert math.acos(min(1.0, body.outward(point) @ slope)) < math.radians(0.5)


def test_points_before_and_behind_a_facet_are_told_apart() -> None:
    """They are as far from each other as their distances add up to, which rounding makes a little less, or more."""
    box, rng = trimesh.creation.box(extents=[0.029, 0.03, 0.06]), np.random.default_rng(0)
    T = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3])
    body = body_of(box.apply_transform(T))
    for _ in range(200):
        heights = np.array([-0.0015, -0.0005, 0.0005, 0.0015]) + rng.uniform(-4e-7, 4e-7)
        points = np.column_stack([0.0145 + heights, *np.tile(rng.uniform(-0.01, 0.01, 2), (4, 1)).T])
        np.testing.assert_array_equal(body.distances(points @ T[:3, :3].T) < 0.0, heights < 0.0)


@pytest.mark.parametrize("kind", ["parts that cross", "a hole", "a mug", "two sides of one sheet"])
def test_points_are_inside_where_the_surface_goes_around_them(kind: str) -> None:
    if kind == "parts that cross":
        other = trimesh.creation.box(extents=[0.02, 0.05, 0.013])
        mesh = trimesh.util.concatenate(
            [trimesh.creation.icosphere(subdivisions=2, radius=0.02), turned(other, 0.4, [1, 2, 3])]
        )
    elif kind == "a hole":
        mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.02)
        mesh.update_faces(np.linalg.norm(mesh.triangles_center - [0.0, 0.0, 0.02], axis=1) > 0.006)
    elif kind == "a mug":
        mesh = mug()
    else:
        mesh = trimesh.util.concatenate([trimesh.creation.box(extents=[0.04, 0.04, 0.02])] * 2)
        mesh.vertices[:8] += [0.0, 0.0, 0.02]
    body, rng = body_of(mesh), np.random.default_rng(0)
    places = body.vertices[body.faces[rng.integers(len(body.faces), size=4000)]]
    points = np.einsum("nk,nki->ni", rng.dirichlet([1, 1, 1], 4000), places)
    points += rng.choice([1e-5, 1e-3, 5e-3], size=(4000, 1)) * rng.normal(size=(4000, 3))
    apart = body.distances(points)
    told = np.abs(apart) > 1e-8
    np.testing.assert_array_equal((apart < 0.0)[told], body.contains(points)[told])


def crossings(vertices: Any, faces: Any) -> Crossings:
    of = Triangles(vertices, faces)
    return crossings_of(vertices, faces, of.normals, of.middles[:, None].repeat(2, axis=1), 1e-6)[0]


def crossed(vertices: Any, faces: Any) -> NDArray[np.bool_]:
    return crossings(vertices, faces).crossed


def test_triangles_that_others_cross_are_found() -> None:
    box = trimesh.creation.box(extents=[1.0, 1.0, 1.0])
    assert not crossed(*arrays(box)).any()
    spike = trimesh.creation.cone(radius=0.05, height=0.4, sections=5)
    spike.apply_translation([0.2, 0.1, 0.4])
    found = crossed(*arrays(trimesh.util.concatenate([box, spike])))
    top = box.triangles_center[:, 2] > 0.49
    assert found[:12][top].sum() == 1  # of the two triangles of the top
    assert not found[:12][~top].any()
    assert found[12:].any()
    # A fan around one corner, one of whose triangles was folded through another.
    fan = np.array(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.6, 0.2, -0.5], [0.2, 0.3, 0.5], [-1, 0, 0], [0, -1, 0]], dtype=float
    )
    np.testing.assert_array_equal(crossed(fan, np.array([[0, 1, 2], [0, 3, 4], [0, 5, 6]])), [True, True, False])


@pytest.mark.parametrize("rounding", [0.0, 1e-12, -1e-12])
def test_what_touches_a_triangle_crosses_it_though_it_has_a_corner_of_it(rounding: float) -> None:
    """One that stands on it, on its edge, or across it, up to rounding; not one that stands beside it."""
    flat, up = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [0.3, 0.3, 1.0]
    feet = [([0.3, 0.3], True), ([0.4, 0.0], True), ([0.6, 0.6], True), ([0.4, -1e-5], False), ([-0.3, 0.2], False)]
    for foot, touches in feet:
        vertices = np.array([*flat, [*foot, rounding], up])
        assert crossed(vertices, np.array([[0, 1, 2], [0, 3, 4]])).tolist() == [touches] * 2


def test_one_answer_tells_of_all_points_whose_balls_overlap() -> None:
    """Points in and around a ball, none of them told: of 4,000 few are asked; near a large hole most."""
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.02)
    points = 0.002 * np.stack(np.meshgrid(*[np.arange(-8, 9)] * 3), axis=-1).reshape(-1, 3)
    radii = np.abs(np.linalg.norm(points, axis=1) - 0.02)
    points, none = points[radii > 0.0012], np.zeros(np.count_nonzero(radii > 0.0012), dtype=bool)
    inside = np.linalg.norm(points, axis=1) < 0.02
    radii = np.abs(trimesh.proximity.signed_distance(mesh, points))
    asked: list[int] = []

    def contains(some: NDArray[np.float64]) -> NDArray[np.bool_]:
        asked.append(len(some))
        return np.linalg.norm(some, axis=1) < 0.02

    closed = Openings(*arrays(mesh))
    np.testing.assert_array_equal(sides(points, radii, none, none, closed, contains), inside)
    assert 2 <= asked[0] <= 10
    mesh.update_faces(mesh.triangles_center[:, 2] < 0.0)
    np.testing.assert_array_equal(sides(points, radii, none, none, Openings(*arrays(mesh)), contains), inside)
    assert asked[1] > 1000


def test_distances_that_do_not_count_are_not_told_too_small() -> None:
    """Two balls that overlap, so that some triangles are inside: what is below a limit is as it is without one."""
    parts = [trimesh.creation.icosphere(subdivisions=3, radius=0.02) for _ in range(2)]
    body = body_of(trimesh.util.concatenate([parts[0], parts[1].apply_translation([0.015, 0.0, 0.0])]))
    points = np.random.default_rng(0).uniform([-0.025, -0.025, -0.025], [0.04, 0.025, 0.025], (3000, 3))
    exact = body.distances(points)
    for below in (-0.01, -0.001, 0.0, 0.002):
        found = body.distances(points, below)
        np.testing.assert_array_equal(np.minimum(found, below), np.minimum(exact, below))


def test_ways_on_a_triangle_are_free_but_for_what_crosses_it() -> None:
    """A blade across a triangle, from x = 0.5 on: ways in front of it, beside it, and through it."""
    flat, blade = [[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0.5, 1, -1], [9, 1, -1], [0.5, 1, 5]]
    of = crossings(np.array(flat + blade, dtype=float), np.array([[0, 1, 2], [3, 4, 5]]))
    ends = np.array([[[1, 0.9, 0], [2, 0.1, 0]], [[0.4, 0.5, 0], [0.4, 2, 0]], [[0.6, 0.5, 0], [0.6, 2, 0]]])
    np.testing.assert_array_equal(of.free(np.zeros(3, dtype=np.intp), ends[:, 0], ends[:, 1]), [True, True, False])
    assert of.others.tolist() == [1, 0]


def test_winding_numbers_are_doubtful_near_openings_and_between_several() -> None:
    """A round opening of radius 1 is a quarter of all that is seen at 2 / sqrt(3) radii; two add up."""
    ring = np.exp(2j * math.pi * np.arange(60) / 60)
    rim = np.column_stack([ring.real, ring.imag, np.zeros(60)])
    dome = np.column_stack([np.arange(60), np.roll(np.arange(60), -1), np.full(60, 60)])
    one = np.vstack([rim, [0, 0, -1]])
    heights, none = ways_at(np.array([[0, 0, 1.1], [0, 0, 1.2]])), np.zeros(2)
    assert Openings(one, dome).near(heights, none).tolist() == [True, False]
    assert Openings(one, dome).near(heights, none + 0.1).tolist() == [True, True]
    past = np.array([[[-9, 0, 1.1], [9, 0, 1.1]], [[-9, 0, 1.2], [9, 0, 1.2]], [[2, 0, 1.1], [9, 0, 1.1]]])
    assert Openings(one, dome).near(past, np.zeros(3)).tolist() == [True, False, False]
    other = one * [1, 1, -1] + [0, 0, 2.4]
    both = Openings(np.vstack([one, other]), np.vstack([dome, dome[:, ::-1] + 61]))
    assert both.near(ways_at(np.array([[0, 0, 1.2], [0, 0, -3.0]])), none).tolist() == [True, False]


def ways_at(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ways that begin and end at points."""
    return np.stack([points, points], axis=1)


def test_next_to_a_slit_winding_numbers_are_sure() -> None:
    """A block whose top is cut along 1 m, the lips bent 1 mm apart.

    Its 0.5e-3 m^2 are at most a quarter of all that is seen from 12.6 mm. In the ball around the slit, and along it,
    all ways are sure that are not nearer than that.
    """
    plate = np.array([[-0.5, 0, 0], [0.5, 0, 0], [0, 0.0005, 0], [0, -0.0005, 0], [0, 1, 0], [0, -1, 0]])
    plate = np.vstack([plate, [0, 0, -0.3]])
    sides_below = [[0, 4, 6], [4, 1, 6], [1, 5, 6], [5, 0, 6]]
    faces = np.array([[0, 2, 4], [2, 1, 4], [0, 5, 3], [3, 5, 1], *sides_below])
    openings, rng = Openings(plate, faces), np.random.default_rng(0)
    assert openings.near(ways_at(np.array([[0, 0, 0.0135], [0, 0, 0.01]])), np.zeros(2)).tolist() == [False, True]
    along = np.array([[[-0.4, 0, 0.02], [0.4, 0, 0.02]], [[-0.4, 0, 0.02], [0.4, 0, 0.001]]])
    assert openings.near(along, np.zeros(2)).tolist() == [False, True]
    assert openings.near(along, np.full(2, 0.009)).tolist() == [True, True]
    points = rng.uniform(-0.3, 0.3, (3000, 3)) * [1, 0.1, 0.1]
    numbers = igl.winding_number(plate, faces, points)
    sure = ~openings.near(ways_at(points), np.zeros(len(points)))
    assert sure.sum() > 1000
    assert np.abs(numbers - np.round(numbers))[sure].max() < DOUBT
    # A way into the slit is not.
    assert openings.near(np.array([[[0.1, 0, 0.3], [0.1, 0, 0]]]), np.zeros(1)).all()


def test_distances_of_ways_from_rods_are_the_least_of_all_their_points() -> None:
    """Against many points of each, ways that are parallel, that meet, and that are points among them."""
    rng = np.random.default_rng(0)
    ways = rng.normal(size=(60, 2, 2, 3))
    ways[:10, 1] = ways[:10, 0] + rng.normal(size=(10, 1, 3))
    ways[10:20, 0, 1] = ways[10:20, 0, 0]
    ways[20:25, 1, 1] = ways[20:25, 1, 0]
    ways[25:30, 1, 0] = ways[25:30, 0].mean(axis=1)
    shares = np.linspace(0.0, 1.0, 401)[:, None]
    for (start, end), (begin, finish) in ways:
        apart = cdist(start + shares * (end - start), begin + shares * (finish - begin)).min()
        assert apart - 0.02 <= distance_of_ways(start, end, begin, finish) <= apart + 1e-12


def test_ways_clear_of_all_triangles_are_found() -> None:
    """Of a box: ways outside, inside, through a side, along one at half and at twice the layer, and through an edge."""
    box = trimesh.creation.box(extents=[1.0, 1.0, 1.0])
    of = Triangles(*arrays(box))
    _, around, _ = crossings_of(of.vertices, of.faces, of.normals, of.middles[:, None].repeat(2, axis=1), 1e-6)
    ways = [[[-1, 0, 0.6], [1, 0, 0.6]], [[-0.4, 0, 0], [0.4, 0.3, 0.4]], [[0, 0.1, 0], [0, 0.1, 2]]]
    ways += [[[-0.4, 0.1, 0.5 + h], [0.4, 0.1, 0.5 + h]] for h in (0.5 * LAYER, 2.0 * LAYER)]
    ways += [[[0.3, 0, 0.6], [0.6, 0, 0.3]]]
    begins, ends = np.array(ways).transpose(1, 0, 2)
    assert around.avoided(begins, ends).tolist() == [True, True, False, False, True, False]


def test_what_lies_on_triangles_does_not_cross_them() -> None:
    """A triangle on another one, one that stands on both, and a block that stands on a plate, or all but does."""
    T = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3])
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.1, 0], [0.9, 0.6, 0], [0.2, 0.7, 0]], dtype=float)
    upright = np.array([[0.2, 0.2, 5e-8], [0.4, 0.3, 5e-8], [0.3, 0.3, 1.0]])
    vertices = np.vstack([flat, upright]) @ T[:3, :3].T
    faces = np.arange(9).reshape(3, 3)
    assert not crossed(vertices, faces[:2]).any()
    assert crossed(vertices, faces).all()
    sheet = trimesh.creation.box(extents=[0.02, 0.02, 0.01])
    for gap in (0.0, 1e-10):
        block = trimesh.creation.box(extents=[0.004, 0.004, 0.01]).apply_translation([0.002, 0.003, 0.01 + gap])
        stack = turned(trimesh.util.concatenate([sheet, block]), 0.7, [1, 2, 3])
        body, rng = body_of(stack), np.random.default_rng(0)
        points = np.column_stack([rng.uniform(-0.01, 0.01, (2000, 2)), rng.uniform(0.0045, 0.0055, 2000)])
        inside = (points[:, 2] < 0.005) | (np.abs(points[:, :2] - [0.002, 0.003]) < 0.002).all(axis=1)
        np.testing.assert_array_equal(body.distances(points @ T[:3, :3].T) < 0.0, inside)


def test_pieces_share_edges_as_triangles_do() -> None:
    """A needle and a plate: no long edge, the same area, no gap, and every piece on its own triangle."""
    mesh = trimesh.creation.box(extents=[0.1, 0.03, 0.001])
    vertices, faces = arrays(mesh)
    corners, pieces, owners = in_pieces(vertices, faces, 0.005)
    found = trimesh.Trimesh(corners, pieces, process=False)
    assert found.is_watertight
    assert found.edges_unique_length.max() <= 0.005
    assert found.volume == pytest.approx(mesh.volume, rel=1e-12)
    np.testing.assert_allclose(found.face_normals, mesh.face_normals[owners], atol=1e-9)
    np.testing.assert_allclose(np.bincount(owners, found.area_faces), mesh.area_faces, rtol=1e-12)
    np.testing.assert_array_equal(in_pieces(vertices, faces, 1.0)[1], faces)


@pytest.mark.parametrize(("thickness", "sigma"), [(0.005, 0.002), (0.0035, 0.0015), (0.0025, 0.001), (0.0008, 0.0005)])
def test_the_footprint_is_narrower_where_the_body_is_thin(thickness: float, sigma: float) -> None:
    plate = body_of(trimesh.creation.box(extents=[0.08, 0.06, thickness]).subdivide_to_size(0.003))
    assert plate.sigma == sigma
    np.testing.assert_allclose(plate.outward(np.array([0.01, 0.0, 0.5 * thickness])), [0, 0, 1], atol=3e-3)


def test_a_small_hole_keeps_the_sign() -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.03)
    ball.update_faces(np.linalg.norm(ball.triangles_center - [0.0, 0.0, 0.03], axis=1) > 0.002)
    assert not ball.is_watertight
    body, points = body_of(ball), np.random.default_rng(1).normal(size=(2000, 3))
    radii = np.random.default_rng(2).uniform(0.01, 0.06, 2000)
    points *= (radii / np.linalg.norm(points, axis=1))[:, None]
    away = np.abs(radii - 0.03) > 0.002
    np.testing.assert_array_equal(body.contains(points)[away], (radii < 0.03)[away])
    assert np.abs(body.distances(points) - (radii - 0.03))[away].max() < 0.002


def test_what_is_clipped_is_the_surface_inside() -> None:
    ball = body_of(trimesh.creation.icosphere(subdivisions=5, radius=0.03))
    triangles, faces = ball.clipped(np.vstack([np.eye(3), -np.eye(3)]), np.array([0.01, 0.01, 1, 0.01, 0.01, -0.02]))
    assert np.abs(triangles[:, :, :2]).max() <= 0.01 + 1e-12
    assert triangles[:, :, 2].min() >= 0.02
    assert np.abs(ball.distances(triangles.mean(axis=1))).max() < 1e-12
    areas = 0.5 * np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    # The part of a sphere above a square: the integral of r / sqrt(r^2 - x^2 - y^2).
    x = (np.arange(400) + 0.5) / 400 * 0.02 - 0.01
    exact = (0.03 / np.sqrt(0.03**2 - x[:, None] ** 2 - x**2)).mean() * 4e-4
    assert areas.sum() == pytest.approx(exact, rel=2e-3)
    assert len(faces) == len(triangles)


def test_depth_in_a_region_of_triangles_is_that_of_the_worst() -> None:
    """Around two balls, which are no convex set: a triangle between them is outside in its middle."""
    region = Near(points=[(-0.01, 0, 0), (0.01, 0, 0)], radius=0.01)
    inside = np.array([[-0.01, 0, 0], [-0.012, 0, 0], [-0.01, 0.002, 0]])
    across = np.array([[-0.01, 0, 0], [0.01, 0, 0], [0.0, 0.01, 0.0]])
    assert least_depth(region, inside[None]) == pytest.approx(0.008, abs=1e-6)
    assert least_depth(region, np.stack([inside, across])) == pytest.approx(0.01 * (1 - math.sqrt(2)), abs=1e-6)


@pytest.mark.parametrize("count", [1, 30, 100, 300])
def test_triangles_that_face_against_their_neighbours_are_turned(count: int, tmp_path: Path) -> None:
    """Some of a ball beside a box that has a hollow: the ball is mended, the hollow stays."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.025)
    hollow = trimesh.creation.box((0.01, 0.01, 0.01))
    hollow.invert()
    box = trimesh.util.concatenate([trimesh.creation.box((0.02, 0.02, 0.02)), hollow])
    box.apply_translation((0.05, 0.0, 0.0))
    whole = trimesh.util.concatenate([ball, box])
    spoiled = whole.copy()
    spoiled.faces[:count] = spoiled.faces[:count, ::-1]
    bodies = []
    for name, mesh in (("whole", whole), ("spoiled", spoiled)):
        mesh.export(tmp_path / f"{name}.stl")
        bodies.append(object_mesh(Mesh(file=tmp_path / f"{name}.stl")))
    points = np.random.default_rng(0).uniform((-0.03, -0.03, -0.03), (0.07, 0.03, 0.03), (500, 3))
    right, found = (body.distances(points) for body in bodies)
    assert right.min() < -0.01 and bodies[0].distances(np.array([[0.05, 0.0, 0.0]]))[0] == pytest.approx(0.005)
    np.testing.assert_allclose(found, right, atol=1e-9)


def test_triangles_inside_where_parts_overlap_do_not_count() -> None:
    """Two boxes that overlap, as they are drawn: distances are those of the one body that they make."""
    parts = [trimesh.creation.box(bounds=[[0, 0, 0], [0.06, 0.04, 0.04]]).subdivide_to_size(0.004)]
    parts.append(parts[0].copy().apply_translation([0.03, 0.0, 0.0]))
    body = body_of(trimesh.util.concatenate(parts))
    assert len(body.faces) < 2 * len(parts[0].faces)
    points = np.random.default_rng(0).uniform([0.002, 0.002, 0.002], [0.088, 0.038, 0.038], (200, 3))
    depths = np.min([points, [0.09, 0.04, 0.04] - points], axis=(0, 2))
    np.testing.assert_allclose(body.distances(points), -depths, atol=1e-9)


# ---- rubber of pads that are not flat


def patch(**keys: Any) -> Any:
    frame = {"origin": [0.01, 0.0, 0.0], "normal": [0, 0, 1], "x_axis": [1, 0, 0]}
    return TypeAdapter(Patch).validate_python(frame | keys)


PIPE = patch(type="cylinder", radius=0.01, u=[-0.012, 0.01], v=[-1.0, 0.8])
TIP = patch(type="sphere", radius=0.01, u=[-1.0, 1.0], v=[-0.5, 0.7])
FLAT = patch(type="plane", u=[-0.012, 0.01], v=[-0.004, 0.006])
LINE = patch(type="line", u=[-0.012, 0.01], width=0.0)


@pytest.mark.parametrize(
    ("pad", "point", "low", "high"),
    [
        (FLAT, [0.0, 0.0, 0.0], [-0.012, -0.004], [0.01, 0.006]),
        (LINE, [0.0, 0.0, 0.0], [-0.012, 0.0], [0.01, 0.0]),
        # sqrt(2 * 10 mm * 0.2 mm) = 2 mm round the pipe, and 1 mm where its patch ends so near.
        (PIPE, [0.0, 0.0, 0.01], [-0.012, -0.002], [0.01, 0.002]),
        (PIPE, [0.0, 0.01 * math.sin(0.7), 0.01 * math.cos(0.7)], [-0.012, -0.002], [0.01, 0.001]),
        (TIP, [0.0, 0.0, 0.01], [-0.002, -0.002], [0.002, 0.002]),
        (TIP, [0.0, 0.01 * math.sin(-0.4), 0.01 * math.cos(-0.4)], [-0.002, -0.001], [0.002, 0.002]),
    ],
)
def test_where_rubber_touches(pad: Any, point: list[float], low: list[float], high: list[float]) -> None:
    rubber = rubber_at(pad, np.array(point), 2e-4)
    curved = hasattr(pad, "radius")
    factor = math.sqrt(math.cos(0.4)) if pad is TIP and point[1] else 1.0  # along a smaller circle
    np.testing.assert_allclose(rubber.low, np.array(low) * [factor if pad is TIP else 1.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(rubber.high, np.array(high) * [factor if pad is TIP else 1.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(rubber.rotation.T @ rubber.rotation, np.eye(3), atol=1e-12)
    assert np.linalg.det(rubber.rotation) == pytest.approx(1.0)
    if curved:
        axis = np.array([0.0, 1.0, 1.0]) if pad is PIPE else np.ones(3)
        np.testing.assert_allclose(rubber.rotation[:, 2], np.array(point) * axis / 0.01, atol=1e-12)


def test_half_sides_and_points_of_pads() -> None:
    np.testing.assert_allclose(half_sides(FLAT), [0.011, 0.005])
    np.testing.assert_allclose(half_sides(LINE), [0.011, 0.001])
    np.testing.assert_allclose(half_sides(PIPE), [0.011, 0.01])
    np.testing.assert_allclose(half_sides(TIP), [0.01, 0.01])
    for pad in (FLAT, LINE, PIPE, TIP):
        points = points_of(pad, 0.5e-3)
        assert max(nearest_on_patch(pad, point)[0] for point in points) < 1e-12
        np.testing.assert_allclose(heights(pad, points @ pad.rotation.T + pad.origin), 0.0, atol=1e-12)
        apart = cKDTree(points).query(points, k=2)[0][:, 1]
        assert apart.max() < 0.5e-3 * 1.001


def test_rubber_and_backing_of_a_round_tip() -> None:
    """A ball of 10 mm on a stem: rubber to 2 mm below the surface of the ball, the stem behind it does not yield."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.01).apply_translation([0.01, 0.0, 0.0])
    stem = trimesh.creation.box(extents=[0.004, 0.004, 0.03]).apply_translation([0.01, 0.0, -0.018])
    pad = PadDescription(name="tip", link="tip", patch=TIP, contact=HardFinger())
    link = PadLink.of(_link_mesh("tip", [ball, stem]), (pad,))
    assert link.lid is None
    assert link.backing is not None
    inside = np.linalg.norm(link.backing.vertices - [0.01, 0.0, 0.0], axis=1)
    assert inside.max() < 0.008 + 1e-9
    [skin] = link.skins
    assert np.abs(np.linalg.norm(skin.fine - [0.01, 0.0, 0.0], axis=1) - 0.01).max() < 2e-3
    plane = skin.least(lambda points, _: 0.0098 - points[:, 2])
    assert plane == pytest.approx(-2e-4, abs=1e-6)


# ---- files


def test_files_of_every_format_are_the_same_body(tmp_path: Path) -> None:
    mesh = bracket()
    bodies = []
    for suffix in ("stl", "obj", "ply", "off", "glb"):
        mesh.export(tmp_path / f"bracket.{suffix}")
        bodies.append(object_mesh(Mesh(file=tmp_path / f"bracket.{suffix}")))
    points = np.random.default_rng(0).uniform(-0.05, 0.1, (200, 3))
    for body in bodies:
        np.testing.assert_allclose(body.distances(points), bodies[0].distances(points), atol=1e-7)
        assert len(body.members) == 1


def test_scale_unit_and_orientation(tmp_path: Path) -> None:
    inverted = bracket()
    inverted.invert()
    inverted.apply_scale(1000.0).export(tmp_path / "mm.stl")
    bracket().export(tmp_path / "m.stl")
    metres = object_mesh(Mesh(file=tmp_path / "m.stl"))
    points = np.random.default_rng(0).uniform(-0.05, 0.1, (200, 3))
    for body in (
        object_mesh(Mesh(file=tmp_path / "mm.stl")),
        object_mesh(Mesh(file=tmp_path / "mm.stl", unit="cm", scale=0.1)),
    ):
        np.testing.assert_allclose(body.distances(points), metres.distances(points), atol=1e-7)
    tall = object_mesh(Mesh(file=tmp_path / "m.stl", scale=(1.0, 1.0, 2.0)))
    assert tall.vertices[:, 2].max() == pytest.approx(0.1)
    assert object_mesh(Mesh(file=tmp_path / "m.stl")) is metres


def test_files_that_are_no_bodies(tmp_path: Path) -> None:
    file = tmp_path / "it.stl"
    mug().export(file)
    shape = Mesh(file=file)
    file.write_bytes(file.read_bytes()[:-1] + b"x")
    with pytest.raises(FileError, match="is not the file that the scene was made with"):
        object_mesh(shape)
    (tmp_path / "empty.obj").write_text("v 0 0 0\n")
    with pytest.raises(FileError, match=r"empty\.obj"):
        object_mesh(Mesh(file=tmp_path / "empty.obj"))
    (tmp_path / "flat.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n")
    with pytest.raises(FileError, match="has flat triangles only"):
        object_mesh(Mesh(file=tmp_path / "flat.off"))


# ---- grasps that hold


def primitives(case: Case) -> dict[str, tuple[dict[str, Any], Any]]:
    """Return shapes between the pads, and the same as fine meshes."""
    radius = case.radius
    can = {"type": "cylinder", "radius": radius, "height": 0.06}
    return {
        "sphere": ({"type": "sphere", "radius": radius}, trimesh.creation.icosphere(subdivisions=5, radius=radius)),
        "box": ({"type": "box", "size": [2 * radius, 0.038, 0.06]}, block(case)),
        "cylinder": (can, trimesh.creation.cylinder(radius, 0.06, sections=360).subdivide_to_size(0.01)),
    }


@pytest.mark.parametrize("kind", ["sphere", "box", "cylinder"])
def test_a_fine_mesh_has_the_figures_of_the_primitive(case: Case, check: Check, kind: str) -> None:
    shape, mesh = primitives(case)[kind]
    exact, found = check(shape), check(mesh)
    assert exact.verified, exact.refuted_by
    assert found.verified, found.refuted_by
    assert {figure.name for figure in exact.figures} - {figure.name for figure in found.figures} <= {"surface edge"}
    for figure in found.figures:
        other = exact[figure.name]
        tolerance = {"m": 1.5e-5, "rad": 2e-3, "N": 2e-3, "m/s^2": 1e-3}.get(figure.unit, 1e-4)
        # A touched spot of 20 um depth, where the primitive has a point: it resists a little turning.
        rel = {"Q_force": 0.06, "Q_torque": 0.25}.get(figure.name, 1e-3)
        assert figure.value == pytest.approx(other.value, abs=tolerance, rel=rel), figure.name
    assert found["pad tangency"].limit == pytest.approx(math.atan(0.1) + math.radians(0.5), abs=0.05)


def test_the_centre_of_mass_of_a_mesh_is_computed(case: Case, tmp_path: Path) -> None:
    """Where the scene gives none, by the check itself: of a ball with a lump at its side that of both."""
    lump = trimesh.creation.box(extents=[0.02, 0.02, 0.02]).apply_translation([0.0, 0.0, 0.05])
    ball = trimesh.creation.icosphere(subdivisions=4, radius=case.radius)
    both = trimesh.util.concatenate([ball, lump])
    both.export(tmp_path / "object.ply")
    given = case.scene().model_dump()
    given["objects"]["sphere"]["shape"] = {"type": "mesh", "file": str(tmp_path / "object.ply")}
    verifier = Verifier(case.robot, Scene.model_validate(given), "sphere")
    height = 0.05 * 8e-6 / (8e-6 + ball.volume)
    np.testing.assert_allclose(verifier._center_of_mass - case.center, [0.0, 0.0, height], atol=1e-9)
    given["objects"]["sphere"]["center_of_mass"] = [0.0, 0.0, 0.001]
    verifier = Verifier(case.robot, Scene.model_validate(given), "sphere")
    np.testing.assert_allclose(verifier._center_of_mass - case.center, [0.0, 0.0, 0.001], atol=1e-12)


def test_a_least_resistance_may_be_asked_for(case: Case, check: Check) -> None:
    plain, asked = check(block(case)), check(block(case), withstand=1.0)
    assert asked.verified
    assert asked["Q_force"].limit == 1.0
    assert asked["Q_force"].value == pytest.approx(plain["Q_force"].value)


def test_pads_may_tilt_as_far_as_rubber_gives(case: Case, check: Check) -> None:
    """1 mm of rubber over half sides of 18 and 10 mm: 3.2 and half a degree of tolerance; 5 degrees, less than 5.7."""
    for degrees, axis, holds in [
        (3.5, (0.0, 0.0, 1.0), True),
        (4.0, (0.0, 0.0, 1.0), False),
        (4.9, (0.0, 1.0, 0.0), True),
        (5.1, (0.0, 1.0, 0.0), False),
    ]:
        certificate = check(block(case, math.radians(degrees), axis))
        tilt = certificate["pad tangency"]
        assert tilt.value == pytest.approx(math.radians(degrees), abs=math.radians(0.05))
        assert tilt.holds is holds
        limit = math.atan(0.001 / 0.018) + math.radians(0.5) if axis[2] else math.radians(5.0)
        assert tilt.limit == pytest.approx(limit)
        assert names(certificate) - {"pad clearance"} == (set() if holds else {"pad tangency"})
        assert certificate["pad clearance"].holds or not holds
        if axis[1] and holds:  # on the other axis the ends of the box are nearer
            depth = 0.011 * math.sin(math.radians(degrees))
            assert certificate["pad clearance"].value == pytest.approx(-depth, abs=1e-4)


# ---- claims that are wrong


def test_a_contact_off_the_surface(case: Case, check: Check) -> None:
    smaller = trimesh.creation.icosphere(subdivisions=5, radius=case.radius - 2e-4)
    certificate = check(smaller)
    assert names(certificate) == {"contact gap"}
    assert certificate["contact gap"].value == pytest.approx(2e-4, abs=1e-5)
    larger = trimesh.creation.icosphere(subdivisions=5, radius=case.radius + 2e-4)
    assert names(check(larger)) == {"contact gap"}


def test_a_contact_on_the_wrong_side(case: Case, check: Check) -> None:
    """A thin sheet where both pads should touch outside: the second one's contact is on its back."""
    sheet = trimesh.creation.box(extents=[0.005, 0.06, 0.04])
    sheet.apply_translation([case.radius + 0.0025, 0.0, 0.0])
    certificate = check(sheet)
    assert {"pad tangency", "normal force", "friction", "contact gap"} <= names(certificate)


def test_how_deep_the_object_is_in_the_rubber(case: Case, check: Check) -> None:
    shallow, deep = check(bumped(case, 0.0009)), check(bumped(case, 0.0018))
    assert shallow.verified, shallow.refuted_by
    assert shallow["pad clearance"].value == pytest.approx(-0.0009, abs=5e-5)
    assert names(deep) == {"pad clearance"}


def test_a_pin_through_the_rubber(case: Case, check: Check) -> None:
    """It is thinner than any depth that is allowed, but goes through the pad into its backing."""
    pin = trimesh.creation.cylinder(2e-4, 0.01, sections=12)
    pin.apply_transform(trimesh.transformations.rotation_matrix(0.5 * math.pi, [0, 1, 0]))
    pin.apply_translation([-case.radius + 0.002, 0.008, 0.0])
    certificate = check(trimesh.util.concatenate([block(case), pin]))
    assert names(certificate) == {"pad clearance"}
    assert certificate["pad clearance"].value == -math.inf


def test_a_handle_through_a_link(case: Case, check: Check) -> None:
    """From the object to the palm: the contacts know nothing of it."""
    poses = Verifier(case.robot, case.scene(), "sphere")._kinematics.poses(case.claim.joints)
    R = np.column_stack([case.jaw, case.across, np.cross(case.jaw, case.across)])
    palm = R.T @ (poses[PALM][:3, 3] - case.center)
    ball = trimesh.creation.icosphere(subdivisions=4, radius=case.radius)
    rod = trimesh.creation.cylinder(0.002, segment=[0.5 * palm * case.radius / np.linalg.norm(palm), palm])
    certificate = check(ball.union(rod, engine="manifold"))
    assert "object clearance" in names(certificate)
    assert certificate["object clearance"].value == -math.inf
    assert {"contact gap", "pad tangency", "friction"}.isdisjoint(names(certificate))
    # A part of its own under the skin of the palm, which no distance of triangles shows.
    crumb = trimesh.creation.icosphere(subdivisions=1, radius=0.001).apply_translation(palm)
    palm_mesh = Verifier(case.robot, case.scene(), "sphere")._robot.meshes[PALM]
    inside = palm_mesh.surrounds(np.zeros((1, 3)))
    certificate = check(trimesh.util.concatenate([ball, crumb]))
    assert (certificate["object clearance"].value == -math.inf) is inside


def test_links_that_are_no_pads_keep_their_margin_less_0_2_mm(case: Case, check: Check) -> None:
    near = check(block(case))["object clearance"]
    assert near.limit == pytest.approx(0.8e-3)
    margin = case.scene().task("sphere").margin.model_dump()
    short = check(block(case), margin=margin | {"object": near.value + 1e-4})
    assert short["object clearance"].holds
    assert names(check(block(case), margin=margin | {"object": near.value + 3e-4})) == {"object clearance"}


@pytest.mark.parametrize(("reach", "holds"), [(0.018 - 4e-5, True), (0.018 - 1e-4, False)])
def test_a_region_that_the_footprint_misses_by_a_tenth_of_a_millimetre(
    case: Case, check: Check, reach: float, holds: bool
) -> None:
    region = {"type": "box", "min": [-1.0, -reach, -1.0], "max": [1.0, 0.019, 1.0]}
    certificate = check(block(case), allowed_contacts=region)
    assert certificate["contact region"].holds is holds
    assert certificate["contact region"].value == pytest.approx(reach - 0.018, abs=2e-6)
    assert names(certificate) <= {"contact region"}


def test_a_forbidden_part_beside_the_contact(case: Case, check: Check) -> None:
    """A ball on the first side: inside of the rubber's outline it counts, though the contact point is off it."""
    at = [-case.radius, 0.012, 0.0]
    for radius, holds in [(0.005, False), (1e-5, True)]:
        certificate = check(block(case), forbidden_contacts={"type": "ball", "center": at, "radius": radius})
        assert certificate["contact region"].holds is holds
    beside = {"type": "ball", "center": [-case.radius, 0.0, 0.014], "radius": 0.003}
    assert check(block(case), forbidden_contacts=beside)["contact region"].holds


# ---- bodies besides the object


def test_a_mesh_as_an_obstacle(case: Case, tmp_path: Path) -> None:
    """The clearance is that of the box that the mesh is."""
    at = case.center + 0.12 * case.across
    size = [0.05, 0.05, 0.05]
    trimesh.creation.box(extents=size).subdivide_to_size(0.02).export(tmp_path / "box.stl")
    values = []
    for shape in ({"type": "box", "size": size}, {"type": "mesh", "file": str(tmp_path / "box.stl")}):
        given = case.scene().model_dump()
        given["obstacles"] = {"thing": {"shape": shape, "pose": {"position": at.tolist()}}}
        verifier = Verifier(case.robot, Scene.model_validate(given), "sphere")
        values.append(verifier.check(case.claim)["obstacle clearance"].value)
        assert verifier.clearances(case.claim.joints)
    assert values[0] == pytest.approx(values[1], abs=1e-6)


def test_a_mesh_in_a_compound(tmp_path: Path) -> None:
    """Distances, normals and footprints of the nearest part, at its pose."""
    trimesh.creation.box(extents=[0.04, 0.04, 0.04]).subdivide_to_size(0.01).export(tmp_path / "box.stl")
    mesh = {"type": "mesh", "file": str(tmp_path / "box.stl")}
    ball = {"shape": {"type": "sphere", "radius": 0.01}, "pose": {"position": [0.05, 0.0, 0.0]}}
    shape = Compound.model_validate({"parts": [{"shape": mesh, "pose": {"position": [0, 0, 0.1]}}, ball]})
    body = PlacedShape("it", Body(shape=shape))
    assert body.limits.yields
    top = np.array([0.0, 0.0, 0.12])
    np.testing.assert_allclose(body.distances(np.array([[0.0, 0.0, 0.125], [0.05, 0.0, 0.02]])), [0.005, 0.01])
    np.testing.assert_allclose(body.inward(top), [0.0, 0.0, -1.0], atol=1e-9)
    face = np.array([[-0.01, -0.005, 0.12], [0.01, -0.005, 0.12], [0.01, 0.005, 0.12], [-0.01, 0.005, 0.12]])
    found = body.footprint(face, top, np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(found.max(axis=0), [0.01, 0.005, 0.12], atol=2e-6)
    np.testing.assert_allclose(found.min(axis=0), [-0.01, -0.005, 0.12], atol=2e-6)


def test_numbers_that_are_not_finite(case: Case, tmp_path: Path, check: Check) -> None:
    case_scene = case.scene().model_dump()
    block(case).export(tmp_path / "object.ply")
    case_scene["objects"]["sphere"]["shape"] = {"type": "mesh", "file": str(tmp_path / "object.ply")}
    verifier = Verifier(case.robot, Scene.model_validate(case_scene), "sphere")
    certificate = verifier.check(replace(case.claim, forces=np.full((2, 3), np.nan)))
    assert all(math.isnan(figure.value) for figure in certificate.figures)


def test_spin_torques_may_be_off_balance_as_far_as_their_normals_are_known() -> None:
    """A grasp that balances about one's normals is off by 0.4 degrees' worth of its spin torque about another's."""
    turn, spin = math.radians(0.5), 0.05
    normals = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    off = np.array([[math.cos(math.radians(0.4)), math.sin(math.radians(0.4)), 0.0], [-1.0, 0.0, 0.0]])
    claim = Claim({}, np.zeros((2, 3)), np.zeros((2, 3)), np.array([spin, spin]))
    for allowed, found, holds in ((0.0, normals, True), (0.0, off, False), (turn, off, True)):
        force, torque = balance_figures(claim, found, np.zeros(3), 0.03, np.zeros(6), turn=allowed, balanced=True)
        assert force.holds
        assert torque.holds == holds
    assert torque.limit == pytest.approx(2.0 * spin * math.sin(turn), abs=1e-9)
