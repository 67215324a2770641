"""Footprints as the optimiser sees them: contact faces, rays beside the check's own footprints, regions kept."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
import pytest
from conftest import Array, agree
from hypothesis import given
from hypothesis import strategies as st
from places import changed, project, random_starts
from pydantic import TypeAdapter
from scipy.spatial.transform import Rotation

import pinograsp
from pinograsp import InputError
from pinograsp.descriptions import Scene
from pinograsp.descriptions.patches import Patch, PlanePatch
from pinograsp.descriptions.regions import Region
from pinograsp.descriptions.shapes import Shape
from pinograsp.geometry.contact_faces import Flat, Ruling, Spot, clipped, edge_distance
from pinograsp.geometry.patches import inside_rim, patch_point
from pinograsp.geometry.regions import is_convex
from pinograsp.geometry.shapes import surface_of
from pinograsp.kinematics.robot import Robot
from pinograsp.problem import GraspProblem, State, TaskModel
from pinograsp.problem.footprint import rays
from pinograsp.solve.projection import nearest_assignment
from pinograsp.verification.check import Verifier
from pinograsp.verification.footprint import footprint
from pinograsp.verification.patches import contact_face, rim_distance
from pinograsp.verification.shapes import GEOMETRY

SHAPE = TypeAdapter(Shape)
CAN = SHAPE.validate_python({"type": "cylinder", "radius": 0.04, "height": 0.1})
BOX = SHAPE.validate_python({"type": "box", "size": [0.02, 0.04, 0.06]})


# ---- contact faces


def test_a_ball_touches_at_a_spot_without_edges() -> None:
    face = surface_of(SHAPE.validate_python({"type": "sphere", "radius": 0.03})).contact_face(np.array([0.03, 0, 0]))
    assert face == Spot()
    assert edge_distance(face, np.array([0.03, 0, 0]))[0] == math.inf


def test_the_side_of_a_can_is_ruled_from_cap_to_cap() -> None:
    face = surface_of(CAN).contact_face(np.array([0.0, 0.04, 0.02]))
    assert isinstance(face, Ruling)
    np.testing.assert_allclose([*face.direction, face.low, face.high], [0, 0, 1, -0.07, 0.03])
    distance, gradient = edge_distance(face, np.array([0.0, 0.04, 0.02]))
    assert distance == pytest.approx(0.03)
    np.testing.assert_allclose(gradient, [0, 0, -1])


def test_a_cap_is_flat_and_its_polygon_holds_the_disc() -> None:
    face = surface_of(CAN).contact_face(np.array([0.01, 0.0, -0.05]))
    assert isinstance(face, Flat)
    assert np.allclose(face.normal, [0, 0, -1])
    angles = np.linspace(0.0, 2 * math.pi, 200)
    rim = np.column_stack([0.04 * np.cos(angles), 0.04 * np.sin(angles), np.full(200, -0.05)])
    room = face.room(rim).min(axis=1)
    assert room.min() > -1e-12  # holds it,
    assert room.max() < 1e-4  # closely


@given(point=st.tuples(*[st.floats(-0.9, 0.9)] * 2), axis=st.integers(0, 2), side=st.sampled_from([-1.0, 1.0]))
def test_faces_of_a_box_run_round_their_normals_and_have_four_edges(
    point: tuple[float, float], axis: int, side: float
) -> None:
    half = np.array([0.01, 0.02, 0.03])
    at = np.insert(np.array(point), axis, side) * half
    face = surface_of(BOX).contact_face(at)
    assert isinstance(face, Flat)
    first, second = face.corners[1] - face.corners[0], face.corners[2] - face.corners[1]
    assert np.cross(first, second) @ face.normal > 0.0
    assert face.normal[axis] == side
    expected = np.delete(half - np.abs(at), axis).min()
    distance, gradient = edge_distance(face, at)
    assert distance == pytest.approx(expected, abs=1e-12)
    nearer = edge_distance(face, at - 1e-6 * gradient)[0]  # in the middle, every way leads to an edge
    assert nearer == pytest.approx(distance - 1e-6, abs=1e-12)


def square(size: float, center: tuple[float, float], turn: float = 0.0) -> Flat:
    corners = 0.5 * size * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.0]])
    return Flat(Rotation.from_euler("z", turn).apply(corners) + np.array([*center, 0.0]), np.array([0.0, 0, 1]))


def area(corners: Array) -> float:
    ahead = np.roll(corners, -1, axis=0)
    return 0.5 * float((corners[:, 0] * ahead[:, 1] - ahead[:, 0] * corners[:, 1]).sum())


def test_polygons_are_clipped_to_what_they_share() -> None:
    assert area(clipped(square(2.0, (0, 0)), square(2.0, (1.0, 0.5)))) == pytest.approx(1.5)
    assert area(clipped(square(1.0, (0, 0)), square(4.0, (0, 0), 0.3))) == pytest.approx(1.0)
    octagon = clipped(square(2.0, (0, 0)), square(2.0, (0, 0), math.pi / 4))
    assert len(octagon) == 8
    assert area(octagon) == pytest.approx(8 * math.tan(math.pi / 8))
    assert len(clipped(square(1.0, (0, 0)), square(1.0, (3.0, 0)))) == 0


CONVEX = {"type": "band", "z": [-0.1, 0.1]}
HOLE = {"type": "outside", "part": {"type": "ball", "center": [0, 0, 0], "radius": 0.01}}
HALF = {"type": "half_space", "normal": [0, 0, 1], "offset": 0.0}


@pytest.mark.parametrize(
    ("region", "expected"),
    [
        (CONVEX, True),
        (HOLE, False),
        ({"type": "outside", "part": HALF}, True),
        ({"type": "all_of", "parts": [CONVEX, HALF]}, True),
        ({"type": "all_of", "parts": [CONVEX, HOLE]}, False),
        ({"type": "any_of", "parts": [CONVEX, HALF]}, False),
        ({"type": "any_of", "parts": [HALF]}, True),
        ({"type": "sector", "middle": 0.0, "half_width": 1.5}, True),
        ({"type": "sector", "middle": 0.0, "half_width": 1.7}, False),
    ],
)
def test_which_regions_are_known_to_be_convex(region: dict[str, Any], expected: bool) -> None:
    assert is_convex(TypeAdapter(Region).validate_python(region)) is expected


# ---- rays


def projected(model: TaskModel, seed: int) -> State:
    """Return a state in which pads and object touch."""
    problem = GraspProblem(model, (0, 1))
    [start] = random_starts(model, 1, seed)
    x = np.concatenate([start, 0.5 * (problem.lower + problem.upper)[model.robot.posture_size :]])
    problem = GraspProblem(model, nearest_assignment(model, problem.state(x)))
    return problem.state(project(problem, x, "contacts"))


@pytest.fixture(scope="module", params=["side", "cap", "box", "paper", "round"])
def touching(
    request: pytest.FixtureRequest,
    gen3: Robot,
    paper: Robot,
    curved_gen3: Robot,
    can_scene: Scene,
) -> list[State]:
    """Flat pads on the side and on the caps of a can and on a box, the paper's on the side, round ones on the box."""
    robot, scene = {"paper": paper, "round": curved_gen3}.get(request.param, gen3), can_scene
    if request.param == "cap":
        shape, desired = {"type": "cylinder", "radius": 0.013, "height": 0.05}, [[0, 0.004, 0.025], [0, 0.004, -0.025]]
        scene = changed(changed(scene, "objects", "can", shape=shape), "tasks", "can", desired_contacts=desired)
    if request.param in {"box", "round"}:
        shape, desired = {"type": "box", "size": (0.05, 0.02, 0.06)}, [[0.025, 0.005, 0.02], [-0.025, 0.005, 0.02]]
        scene = changed(changed(scene, "objects", "can", shape=shape), "tasks", "can", desired_contacts=desired)
    model = TaskModel(robot, scene, "can")
    states = [state for state in (projected(model, seed) for seed in range(4)) if abs(state.surface[0]).max() < 1e-6]
    assert states
    return states


def of_the_check(state: State, pad: int) -> Array:
    """Return the vertices of a footprint as the verification finds them."""
    model, point = state.model, state.contacts.points[pad]
    T = model.T_world_object
    geometry = GEOMETRY[type(model.scene.objects[model.task.object].shape)](
        model.scene.objects[model.task.object].shape
    )
    on_object = geometry.face(T[:3, :3].T @ (point - T[:3, 3])) @ T[:3, :3].T + T[:3, 3]
    described = model.robot.pads[pad]
    R = state.configuration.rotations[described.joint]
    origin = R @ described.translation + state.configuration.translations[described.joint]
    R = R @ described.rotation
    on_pad = contact_face(described.patch, R.T @ (point - origin)) @ R.T + origin
    return footprint(on_pad, on_object, point, state.surface[1][pad])


def test_rays_end_where_the_footprints_of_the_check_do(touching: list[State]) -> None:
    for state in touching:
        for pad in range(2):
            expected, found = of_the_check(state, pad), []
            for ray in rays(state, pad):
                found += [ray.end] if ray.last is None else list(ray.last)
            if not found:
                assert len(expected) == 1
                continue
            apart = np.linalg.norm(expected[:, None] - np.array(found)[None], axis=2)
            # The cap of a can is a polygon here and there, of sides of 1.7 mm.
            assert apart.min(axis=1).max() < (9e-4 if len(expected) > 8 else 2e-5)
            if len(expected) == 2:
                assert apart.min(axis=0).max() < 2e-5


def test_the_derivatives_of_rays(touching: list[State]) -> None:
    for state in touching:
        for pad in range(2):
            for number, ray in enumerate(rays(state, pad)):
                end = partial(end_of_ray, GraspProblem(state.model, (0, 1)), pad, number)
                agree(ray.d_end, end, state.x, floor=1.0, tolerance=5e-5)


def end_of_ray(problem: GraspProblem, pad: int, number: int, x: Array) -> Array:
    return rays(problem.state(x), pad)[number].end


# ---- plans


def edges(result: pinograsp.Result) -> list[float]:
    return [grasp.certificate["contact region"].value for grasp in result.grasps]


def test_footprints_stay_in_the_ring_that_is_allowed(gen3: Robot, can_scene: Scene) -> None:
    result = pinograsp.plan(gen3, can_scene, "can_region", starts=12, workers=2)
    assert result.verified >= 11
    assert result.refuted == 0
    assert min(edges(result)) > -1e-6
    heights = [contact.point[2] - 0.034 for grasp in result.grasps for contact in grasp.contacts]
    assert min(heights) > can_scene.objects["can"].pose.position[2]


def test_a_point_may_be_inside_where_its_footprint_is_not(gen3: Robot, can_scene: Scene) -> None:
    by_point = changed(can_scene, "tasks", "can_region", contact_regions="point")
    result = pinograsp.plan(gen3, by_point, "can_region", starts=6, workers=2)
    assert result.verified == 6
    strict = Verifier(gen3.description, can_scene, "can_region")
    outside = [strict.check(grasp.claim)["contact region"].value for grasp in result.grasps]
    assert min(outside) < -1e-3


def test_contacts_keep_their_reserve_from_rims(gen3: Robot, can_scene: Scene) -> None:
    """Without one the desired points, beside the ring, draw them to the very rim."""
    for rim in (0.0, 0.004):
        scene = changed(can_scene, "tasks", "can_region", reserve={"rim": rim})
        result = pinograsp.plan(gen3, scene, "can_region", starts=6, workers=1)
        assert result.verified >= 5
        found = [grasp.certificate["pad rim"].value for grasp in result.grasps]
        assert min(found) == pytest.approx(rim, abs=2e-6)
        assert min(grasp.certificate["surface edge"].value for grasp in result.grasps) >= rim - 2e-5


PATCH = TypeAdapter(Patch)
FRAME = {"origin": [0, 0, 0], "normal": [0, 0, 1], "x_axis": [1, 0, 0]}
PATCHES = (
    {"type": "plane", "u": [-0.01, 0.02], "v": [-0.01, 0.005]},
    {"type": "line", "u": [-0.01, 0.02], "width": 0.02},
    {"type": "cylinder", "radius": 0.01, "u": [-0.01, 0.02], "v": [-1.0, 0.7]},
    {"type": "cylinder", "radius": 0.01, "u": [-0.01, 0.02], "v": [-math.pi, math.pi]},
    {"type": "sphere", "radius": 0.012, "u": [-1.2, 0.785], "v": [-1.0, 0.6]},
)


@pytest.mark.parametrize("described", PATCHES, ids=lambda patch: str(patch["type"]))
@given(share=st.tuples(st.floats(0, 1), st.floats(0, 1)), reserve=st.floats(0.0, 0.004))
def test_parameters_within_a_reserve_are_so_far_from_the_rim(
    described: dict[str, Any], share: tuple[float, float], reserve: float
) -> None:
    patch = PATCH.validate_python(described | FRAME)
    low, high = inside_rim(patch, reserve).T
    at = low + np.array(share[: len(low)]) * (high - low)
    assert rim_distance(patch, patch_point(patch, at).point) >= reserve - 1e-12
    if isinstance(patch, PlanePatch):
        assert rim_distance(patch, patch_point(patch, low).point) == pytest.approx(reserve, abs=1e-12)


def test_a_reserve_that_leaves_nothing_of_a_pad_is_refused(gen3: Robot, can_scene: Scene) -> None:
    scene = changed(can_scene, "tasks", "can", reserve={"rim": 0.011})
    with pytest.raises(
        InputError, match=r"tasks\.can\.reserve\.rim: a reserve of 11 mm leaves nothing of the pad 'left'"
    ):
        TaskModel(gen3, scene, "can")
