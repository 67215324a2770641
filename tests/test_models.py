"""Kinematics, link hulls, exact distances and the surfaces of objects."""

from __future__ import annotations

import math
import pickle
from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest
import trimesh
from conftest import (
    TOY_ROBOT,
    TOY_URDF,
    Array,
    RobotFactory,
    SceneFactory,
    collision_model,
    link_solids,
    random_parameters,
    solids_of,
)
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

import pinograsp.collision.distances as collision
from pinograsp.collision.batch_clearance import CAP, BatchClearance
from pinograsp.collision.distances import REACH, CollisionModel
from pinograsp.collision.scene_world import enclosure_world
from pinograsp.descriptions import Scene
from pinograsp.descriptions.pose import Pose
from pinograsp.descriptions.shapes import Box, Cylinder, Shape, Sphere
from pinograsp.descriptions.task import Margins
from pinograsp.geometry.shapes import surface_of
from pinograsp.kinematics.batch import BatchKinematics
from pinograsp.kinematics.contacts import contact_kinematics, jacobian_derivatives
from pinograsp.kinematics.forward import Configuration, forward
from pinograsp.kinematics.robot import Robot
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.problem.constraints.clearance import Clearance

ROBOTS = ["gen3", "toy", "two_joint_toy", "paper"]
CURVED = ["curved_gen3", "mixed_toy"]
ONE_FINGER_URDF = TOY_URDF.split('  <joint name="slide_right"')[0].replace('name="right"', 'name="loose"') + (
    '  <joint name="hang" type="fixed"><parent link="left"/><child link="loose"/>'
    '<origin xyz="-0.08 0 0"/></joint>\n</robot>\n'
)
"""Two movable joints, the fewest that a robot file can have: both pads ride on the one slider."""


@pytest.fixture(scope="module")
def two_joint_toy(make_toy: RobotFactory) -> Robot:
    left, right = TOY_ROBOT["pads"]
    return make_toy(ONE_FINGER_URDF, pads=[left, right | {"link": "loose"}])


@pytest.fixture(scope="module", params=[*ROBOTS, *CURVED])
def robot(request: pytest.FixtureRequest) -> Robot:
    """Each robot, mounted askew."""
    model: Robot = request.getfixturevalue(request.param)
    return model.mounted(Pose(position=(0.1, -0.2, 0.3), rpy=(0.4, -1.1, 2.0)).matrix)


def configuration(robot: Robot, posture: Array) -> Configuration:
    return forward(robot, robot.model.createData(), posture)


def link_pose(robot: Robot, posture: Array, link: str) -> Array:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.joint_positions(posture))
    return np.asarray(data.oMf[robot.model.getFrameId(link)].homogeneous)


def random_postures(robot: Robot, count: int, seed: int = 0) -> Array:
    return np.random.default_rng(seed).uniform(robot.lower, robot.upper, (count, robot.posture_size))


def differences(function: Any, x: Array, step: float = 1e-6) -> Array:
    """Return central differences of an array-valued function, shape (..., v)."""
    return np.stack([(function(x + d) - function(x - d)) / (2 * step) for d in step * np.eye(len(x))], axis=-1)


# ---- the robot


TABLE_4 = {
    1: (
        [1.224, -0.638, 0.231, 1.344, 1.899, -1.698, 0.737],
        [57.4, 20.4, 826.3],
        [[0.175, 0.0, 0.985], [0.0, -1.0, 0.0], [0.985, 0.0, -0.175]],
    ),
    2: (
        [1.671, -0.785, -0.471, 1.937, 6.155, -1.168, 1.857],
        [147.5, 18.7, 855.5],
        [[-0.977, 0.001, 0.211], [0.001, -1.0, 0.007], [0.211, 0.007, 0.977]],
    ),
}


@pytest.mark.paper
@pytest.mark.parametrize("case", TABLE_4)
def test_forward_kinematics_of_the_printed_arm_joints(gen3: Robot, case: int) -> None:
    """Table 4 in the Gen3's base frame, at `end_effector_link`; both y axes are the paper's jaw axis, base -y.

    (This URDF's gripper closes along x: tested below.) The sphere's and the can's centre lie on the approach axis.
    """
    arm, position, axes = TABLE_4[case]
    pose = link_pose(gen3, np.array([*arm, 0.0]), "end_effector_link")
    np.testing.assert_allclose(1e3 * pose[:3, 3], position, atol=0.06)
    np.testing.assert_allclose(pose[:3, :3].T, axes, atol=1e-3)


def test_the_gripper_closes_along_the_x_axis_of_the_wrist(gen3: Robot) -> None:
    posture = random_postures(gen3, 1)[0]
    contacts = contact_kinematics(configuration(gen3, posture), np.zeros(4))
    x = link_pose(gen3, posture, "end_effector_link")[:3, 0]
    np.testing.assert_allclose(np.abs(contacts.normals @ x), 1.0, atol=1e-3)
    np.testing.assert_allclose(contacts.normals.sum(axis=0), 0.0, atol=1e-9)


def test_posture_map_of_the_gripper(gen3: Robot) -> None:
    """All six finger joints follow one synergy with multipliers of +-1."""
    posture = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.25])
    q = gen3.joints_by_name(posture)
    assert [q[f"joint_{i}"] for i in range(1, 8)] == pytest.approx(posture[:7])
    fingers = {name: value for name, value in q.items() if name.startswith("robotiq")}
    assert len(fingers) == 6
    signs = {"left_knuckle": 1, "right_knuckle": -1, "left_inner": 1, "right_inner": -1, "left_finger_tip": -1}
    signs["right_finger_tip"] = 1
    for part, sign in signs.items():
        assert [value for name, value in fingers.items() if part in name] == pytest.approx([0.25 * sign])
    assert gen3.synergies.shape == (6, 1)
    np.testing.assert_array_equal(np.abs(gen3.synergies), 1.0)


def test_mimic_multiplier_and_offset(toy: Robot) -> None:
    assert toy.joints_by_name(np.array([0.3, 0.04])) == pytest.approx(
        {"shoulder": 0.3, "slide_left": 0.04, "slide_right": 1.25 * 0.04 + 0.002}
    )
    np.testing.assert_allclose(toy.lower, [-1.5, 0.0])
    np.testing.assert_allclose(toy.upper, [1.5, 0.06])


def test_continuous_joints_are_reported_within_one_turn(gen3: Robot) -> None:
    for posture in random_postures(gen3, 20):
        q = gen3.joints_by_name(posture)
        assert all(-math.pi < q[f"joint_{i}"] <= math.pi for i in (1, 3, 5, 7))
        assert [q[f"joint_{i}"] for i in (2, 4, 6)] == pytest.approx(posture[[1, 3, 5]])
        wrapped = np.array([*(q[f"joint_{i}"] for i in range(1, 8)), posture[7]])
        for link in ("bracelet_link", "robotiq_85_left_finger_tip_link"):
            np.testing.assert_allclose(link_pose(gen3, wrapped, link), link_pose(gen3, posture, link), atol=1e-12)
    at_pi = gen3.wrapped(np.array([-math.pi, 0, math.pi, 0, 3 * math.pi, 0, 0, 0]))
    np.testing.assert_allclose(at_pi[[0, 2, 4]], math.pi)


def test_a_continuous_joint_with_limits_of_its_own_is_not_wrapped(make_toy: RobotFactory) -> None:
    urdf = TOY_URDF.replace('name="shoulder" type="revolute"', 'name="shoulder" type="continuous"')
    posture = np.array([4.0, 0.0])
    free = make_toy(urdf)
    assert free.upper[0] == -free.lower[0] == 2 * math.pi
    assert free.joints_by_name(posture)["shoulder"] == pytest.approx(4.0 - 2 * math.pi)
    bound = make_toy(urdf, arm=TOY_ROBOT["arm"] | {"limits": {"shoulder": [0.5, 5.0]}})
    assert bound.joints_by_name(posture)["shoulder"] == 4.0
    assert (bound.lower[0], bound.upper[0]) == (0.5, 5.0)


def test_a_pickled_robot_is_the_same_robot(robot: Robot) -> None:
    copy = pickle.loads(pickle.dumps(robot))
    assert copy.joint_names == robot.joint_names
    for posture in random_postures(robot, 3):
        here, there = configuration(robot, posture), configuration(copy, posture)
        np.testing.assert_array_equal(there.translations, here.translations)
        np.testing.assert_array_equal(there.rotations, here.rotations)
        np.testing.assert_array_equal(there.jacobian, here.jacobian)


@settings(max_examples=15)
@example(roll=0.3, pitch=math.pi / 2, yaw=-0.8)
@example(roll=-0.7, pitch=-math.pi / 2, yaw=2.5)
@given(roll=st.floats(-3.1, 3.1), pitch=st.floats(-math.pi / 2, math.pi / 2), yaw=st.floats(-3.1, 3.1))
def test_mounting_moves_everything(toy: Robot, roll: float, pitch: float, yaw: float) -> None:
    T = Pose(position=(0.4, -0.1, 0.2), rpy=(roll, pitch, yaw)).matrix
    mounted = toy.mounted(T)
    posture = np.array([0.5, 0.02])
    for link in toy.urdf.links:
        np.testing.assert_allclose(link_pose(mounted, posture, link), T @ link_pose(toy, posture, link), atol=1e-7)
    check_moved_solids(toy, mounted, T, posture)


def test_mounting_moves_the_hulls_of_the_arm(gen3: Robot) -> None:
    T = Pose(position=(0.4, -0.1, 0.2), rpy=(0.0, math.pi / 2, 0.0)).matrix
    check_moved_solids(gen3, gen3.mounted(T), T, random_postures(gen3, 1)[0])


def check_moved_solids(robot: Robot, mounted: Robot, T: Array, posture: Array) -> None:
    here, there = configuration(robot, posture), configuration(mounted, posture)
    for before, after in zip(link_solids(robot), link_solids(mounted), strict=True):
        assert before.name == after.name
        np.testing.assert_allclose(placed(there, after), T @ placed(here, before), atol=1e-7)


def placed(configuration: Configuration, solid: Any) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = configuration.rotations[solid.joint], configuration.translations[solid.joint]
    return np.asarray(T @ solid.placement)


@pytest.fixture(scope="module")
def sliding_toy(make_toy: RobotFactory) -> Robot:
    """The toy with an arm joint that slides along an oblique axis."""
    urdf = TOY_URDF.replace('name="shoulder" type="revolute"', 'name="shoulder" type="prismatic"')
    return make_toy(urdf.replace('<axis xyz="0 1 0"/>', '<origin xyz="0.1 0 0" rpy="0.3 0 0"/><axis xyz="0.6 0 0.8"/>'))


@pytest.mark.parametrize("name", [*ROBOTS, "sliding_toy"])
def test_poses_of_many_arm_configurations(name: str, request: pytest.FixtureRequest) -> None:
    """Wrist and every link, the hand held still, against Pinocchio."""
    model: Robot = request.getfixturevalue(name)
    robot = model.mounted(Pose(position=(0.1, -0.2, 0.3), rpy=(0.4, -1.1, 2.0)).matrix)
    postures = random_postures(robot, 20)
    postures[:, robot.arm_size :] = synergies = postures[0, robot.arm_size :]
    batch = BatchKinematics(robot, synergies)
    frames = batch.frames(postures[:, : robot.arm_size])
    positions, approach = batch.wrist(frames)
    for posture, position, direction in zip(postures, positions, approach, strict=True):
        wrist = link_pose(robot, posture, robot.description.arm.wrist)
        np.testing.assert_allclose(position, wrist[:3, 3], atol=1e-12)
        np.testing.assert_allclose(direction, wrist[:3, 2], atol=1e-12)
    for solid in link_solids(robot):
        corner = batch.placement(solid.joint, solid.placement)[:3, 3]
        points = frames.place(batch.group_of[solid.joint], corner)
        expected = [placed(configuration(robot, posture), solid)[:3, 3] for posture in postures]
        np.testing.assert_allclose(points, expected, atol=1e-12)


# ---- contacts


def contact_parameters(robot: Robot, seed: int) -> Array:
    return random_parameters(robot, np.random.default_rng(seed))


def turned(angle: float, first: Array, second: Array) -> tuple[Array, Array]:
    """Turn two perpendicular directions, the first towards the second."""
    s, c = math.sin(angle), math.cos(angle)
    return c * first + s * second, c * second - s * first


def test_contact_points_lie_on_the_described_patches(robot: Robot) -> None:
    posture, parameters = random_postures(robot, 1, seed=4)[0], contact_parameters(robot, 4)
    contacts = contact_kinematics(configuration(robot, posture), parameters)
    rest = iter(parameters)
    for i, pad in enumerate(robot.description.pads):
        T, patch = link_pose(robot, posture, pad.link), pad.patch
        normal, x = np.array(patch.normal), np.array(patch.x_axis)
        y = np.cross(normal, x)
        u, v = next(rest), 0.0 if patch.type == "line" else next(rest)
        local = np.array(patch.origin)
        if patch.type in {"plane", "line"}:
            local += u * x + v * y
        elif patch.type == "cylinder":
            normal, y = turned(v, normal, y)
            local += u * x + patch.radius * normal
        else:
            normal, x = turned(u, normal, x)
            normal, y = turned(v, normal, y)
            local += patch.radius * normal
        np.testing.assert_allclose(contacts.points[i], T[:3, :3] @ local + T[:3, 3], atol=1e-12)
        np.testing.assert_allclose(contacts.normals[i], T[:3, :3] @ normal, atol=1e-12)
    assert not list(rest)


def test_hand_jacobians_are_those_of_pinocchio(robot: Robot) -> None:
    posture, parameters = random_postures(robot, 1, seed=5)[0], contact_parameters(robot, 5)
    contacts = contact_kinematics(configuration(robot, posture), parameters)
    model, data = robot.model, robot.model.createData()
    for i, pad in enumerate(robot.description.pads):
        frame = model.getFrameId(pad.link)
        pin.computeJointJacobians(model, data, robot.joint_positions(posture))
        pin.updateFramePlacement(model, data, frame)
        J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED).reshape(6, model.nv)
        lever = contacts.points[i] - data.oMf[frame].translation
        linear = J[:3] + np.cross(J[3:].T, lever).T
        expected = np.concatenate([linear, J[3:]])[:, robot.hand_joints]
        np.testing.assert_allclose(contacts.jacobians[i], expected, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_derivatives_of_contacts(robot: Robot, seed: int) -> None:
    size = robot.posture_size
    x = np.concatenate([random_postures(robot, 1, seed)[0], contact_parameters(robot, seed)])

    def at(x: Array) -> Any:
        return contact_kinematics(configuration(robot, x[:size]), x[size:])

    here = at(x)
    for value, derivative in (
        (lambda c: c.points, here.d_points),
        (lambda c: c.normals, here.d_normals),
        (lambda c: c.jacobians, jacobian_derivatives(robot, here)),
    ):
        numeric = differences(lambda v, value=value: value(at(v)), x)
        assert np.abs(numeric).max() > 1e-3 or size == 2
        np.testing.assert_allclose(derivative, numeric, atol=1e-8)


# ---- hulls


def test_hulls_contain_the_meshes_and_nothing_that_the_meshes_do_not_span(gen3_hulls: Robot) -> None:
    """Vertices as trimesh reads them lie within every facet; corners of the hull are vertices of the mesh."""
    geometry = pin.buildGeomFromUrdfString(gen3_hulls.model, gen3_hulls.urdf.xml, pin.GeometryType.COLLISION)
    solids = link_solids(gen3_hulls)
    assert len(solids) == len(geometry.geometryObjects) == 17
    for solid, item in zip(solids, geometry.geometryObjects, strict=True):
        vertices = np.array(trimesh.load_scene(item.meshPath).to_geometry().vertices) * item.meshScale
        normals, offsets = facets(solid.shape)
        for block in np.array_split(vertices, len(vertices) // 2000 + 1):
            assert (block @ normals.T - offsets).max() < 1e-6
        corners = np.array(solid.shape.points())
        sorted_vertices = vertices[np.lexsort(vertices.T[::-1])]
        nearest = [np.abs(sorted_vertices - corner).max(axis=1).min() for corner in corners[::25]]
        assert max(nearest) < 1e-6


def facets(hull: Any) -> tuple[Array, Array]:
    """Return outward normals and offsets of a hull's triangles, from their corners alone."""
    points = np.array(hull.points())
    corners = np.array([[points[hull.polygons(k)[i]] for i in range(3)] for k in range(hull.num_polygons)])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    real = length > 1e-12
    normals, corners = normals[real] / length[real, None], corners[real]
    normals *= np.sign(((corners[:, 0] - points.mean(axis=0)) * normals).sum(axis=1))[:, None]
    return normals, (normals * corners[:, 0]).sum(axis=1)


def test_a_scaled_mesh_is_scaled_once(make_toy: RobotFactory, tmp_path: Any) -> None:
    trimesh.creation.box((10.0, 20.0, 40.0)).export(tmp_path / "finger.stl")
    box = '<origin xyz="0.005 0 0.02"/><geometry><box size="0.01 0.02 0.04"/></geometry>'
    mesh = '<origin xyz="0.005 0 0.02"/><geometry><mesh filename="finger.stl" scale="0.001 0.002 0.003"/></geometry>'
    assert box in TOY_URDF
    robot = make_toy(TOY_URDF.replace(box, mesh), meshes=(tmp_path / "finger.stl",))
    [left] = [solid for solid in link_solids(robot) if solid.name == "left"]
    points = np.array(left.shape.points())
    np.testing.assert_allclose(np.ptp(points, axis=0), [0.01, 0.04, 0.12], atol=1e-7)


def test_bounding_spheres_contain_their_bodies(gen3: Robot, toy: Robot) -> None:
    for robot in (gen3, toy):
        for solid in link_solids(robot):
            if isinstance(solid.shape, coal.Box):
                signs = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
                points = signs * np.array(solid.shape.halfSide)
            else:
                points = np.array(solid.shape.points())
            in_joint = points @ solid.placement[:3, :3].T + solid.placement[:3, 3]
            assert np.linalg.norm(in_joint - solid.center, axis=1).max() <= solid.radius + 1e-9


# ---- distances


WIDE = {"min": (-3.0, -3.0, -3.0), "max": (3.0, 3.0, 3.0)}
TIGHT = {"min": (-0.15, -0.3, -0.2), "max": (0.25, 0.3, 0.4)}
"""For the toy: walls within reach on both sides."""


def with_object_at(scene: Scene, task: str, position: Array, **changes: Any) -> Scene:
    content = scene.model_dump() | changes
    content["objects"][scene.task(task).object]["pose"]["position"] = tuple(float(v) for v in position)
    return Scene.model_validate(content)


class Bench:
    """A collision model with a posture at which one link has a wanted distance from the object."""

    def __init__(self, robot: Robot, scene: Scene, task: str, link: str, seed: int) -> None:
        self.scene, self.task, self.link = scene, task, link
        self.robot = robot.mounted(scene.mounting.matrix)
        self.data = self.robot.model.createData()
        low, high = self.robot.lower, self.robot.upper
        self.posture = np.random.default_rng(seed).uniform(0.6 * low + 0.4 * high, 0.4 * low + 0.6 * high)
        solids = link_solids(self.robot)
        [solid] = [solid for solid in solids if solid.name == link]
        here = self.at(self.posture)
        center = here.rotations[solid.joint] @ solid.center + here.translations[solid.joint]
        away = np.random.default_rng(seed + 100).normal(size=3)
        surface = surface_of(scene.objects[scene.task(task).object].shape)
        self.position = center + away / np.linalg.norm(away) * (solid.radius + surface.radius + 0.005)
        self.place(0.0)
        # A ball moved along the normal keeps its nearest point of the link.
        distance, normal = self.measure()
        self.start = self.position - distance * normal
        self.normal = normal

    def at(self, posture: Array) -> Configuration:
        return forward(self.robot, self.data, posture)

    def place(self, distance: float | None) -> None:
        """Put the object this far from the link (0 before the touching position is known)."""
        if hasattr(self, "start"):
            assert distance is not None
            self.position = self.start + distance * self.normal
        scene = with_object_at(self.scene, self.task, self.position)
        self.model = collision_model(self.robot, scene, self.task)
        [self.index] = [
            i for i, pair in enumerate(self.model.pairs) if pair.kind == "object clearance" and pair.link == self.link
        ]

    def measure(self) -> tuple[float, Array]:
        values, _, normals = self.model.measure(np.array([self.index]), self.at(self.posture))
        return float(values[0]), normals[0]


CASES = [("gen3", "robotiq_85_left_finger_link", 1), ("gen3", "bracelet_link", 2), ("toy", "arm", 3)]


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"{case[0]}-{case[1]}")
def bench(request: pytest.FixtureRequest, glovebox: Scene, make_toy_scene: SceneFactory) -> Bench:
    name, link, seed = request.param
    scene, task = (make_toy_scene(enclosure=WIDE), "ball") if name == "toy" else (glovebox, "sphere")
    return Bench(request.getfixturevalue(name), scene, task, link, seed)


@pytest.mark.parametrize("distance", [0.02, 1e-4, 0.0, -1e-4, -0.003])
def test_distances_and_gradients_apart_touching_and_penetrating(bench: Bench, distance: float) -> None:
    """Of the chosen pair and of every other pair that is measured there."""
    bench.place(distance)
    assert bench.measure()[0] == pytest.approx(distance, abs=1e-8)
    check_gradients(bench.model, bench.robot, bench.posture, bench.index)


def check_gradients(model: CollisionModel, robot: Robot, posture: Array, wanted: int | None = None) -> int:
    here = model.distances(configuration(robot, posture))
    assert np.isfinite(here.values).all()
    assert np.isfinite(here.gradients).all()
    assert wanted is None or wanted in here.indices

    def values(posture: Array) -> Array:
        return model.measure(here.indices, configuration(robot, posture))[0]

    numeric = differences(values, posture)
    np.testing.assert_allclose(here.gradients, numeric, atol=1e-6)
    return len(here.indices)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", ROBOTS)
def test_distances_of_random_postures(
    name: str,
    seed: int,
    request: pytest.FixtureRequest,
    sphere_task: TaskModel,
    make_toy_scene: SceneFactory,
) -> None:
    """Robot against walls, object and itself, most of them in collision somewhere."""
    if name == "gen3":
        model, robot = sphere_task.collisions, sphere_task.robot
    else:
        robot, scene = request.getfixturevalue(name), make_toy_scene(enclosure=TIGHT)
        model = collision_model(robot, scene, "ball")
    tried = random_postures(robot, 20, seed)
    posture = next(p for p in tried if len(model.distances(configuration(robot, p)).indices))
    assert check_gradients(model, robot, posture) > 0
    check_witnesses(model, configuration(robot, posture))


def check_witnesses(model: CollisionModel, at: Configuration) -> None:
    """p2 = p1 + d n: shifting the second body by -d n makes the two just touch; wall distances by corners.

    A hair's breadth is left between them: of bodies that touch exactly Coal may say that they are 1e308 m apart.
    """
    indices = np.flatnonzero(np.arange(len(model.pairs)) % 3 == 0)
    values, points, normals = model.measure(indices, at)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-9)
    for index, d, p1, n in zip(indices, values, points, normals, strict=True):
        first, second = (solids_of(model)[i] for i in (model.pairs[index].first, model.pairs[index].second))
        if math.isinf(second.radius):
            side = np.array(second.shape.n)
            corners = in_world(at, first, hull_points(first.shape))
            assert (corners @ side).min() - second.shape.d == pytest.approx(d, abs=1e-9)
            assert (p1 + d * n) @ side == pytest.approx(second.shape.d, abs=1e-7)
            continue
        T1, T2 = (placed(at, solid) for solid in (first, second))
        T2[:3, 3] -= (d - 1e-5) * n
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        touching = coal.distance(first.shape, transform(T1), second.shape, transform(T2), request, result)
        assert touching == pytest.approx(1e-5, abs=2e-6)


def transform(T: Array) -> Any:
    return coal.Transform3s(T[:3, :3], T[:3, 3])


def hull_points(shape: Any) -> Array:
    if isinstance(shape, coal.Box):
        return np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]) * np.array(shape.halfSide)
    return np.array(shape.points())


def in_world(at: Configuration, solid: Any, points: Array) -> Array:
    T = placed(at, solid)
    return np.asarray(points @ T[:3, :3].T + T[:3, 3])


def test_pairs_left_out_are_beyond_reach(sphere_task: TaskModel) -> None:
    model = sphere_task.collisions
    left_out = 0
    for posture in random_postures(sphere_task.robot, 5, seed=8):
        at = configuration(sphere_task.robot, posture)
        others = np.setdiff1d(np.arange(len(model.pairs)), model.distances(at).indices)
        values, _, _ = model.measure(others, at)
        left_out += len(others)
        assert values.min() >= REACH - 1e-9
    assert left_out > 100


def test_distances_do_not_depend_on_the_query_before(gen3: Robot, glovebox: Scene, sphere_task: TaskModel) -> None:
    robot = sphere_task.robot
    fresh = collision_model(robot, glovebox, "sphere")
    postures = random_postures(robot, 6, seed=2)
    forwards = [sphere_task.collisions.distances(configuration(robot, p)) for p in postures]
    backwards = [fresh.distances(configuration(robot, p)) for p in postures[::-1]][::-1]
    for one, other in zip(forwards, backwards, strict=True):
        np.testing.assert_array_equal(one.indices, other.indices)
        np.testing.assert_array_equal(one.values, other.values)
        np.testing.assert_array_equal(one.gradients, other.gradients)


@pytest.fixture(scope="module")
def tight_toy_task(toy: Robot, make_toy_scene: SceneFactory) -> TaskModel:
    """Walls within reach on both sides and a post beside the arm."""
    post = {"shape": {"type": "box", "size": [0.02, 0.02, 0.1]}, "pose": {"position": [0.1, 0.04, 0.2]}}
    return TaskModel(toy, make_toy_scene(enclosure=TIGHT, obstacles={"post": post}), "ball")


@pytest.mark.parametrize("name", ["sphere_task", "tight_toy_task"])
def test_clearance_of_many_configurations(name: str, request: pytest.FixtureRequest) -> None:
    """What it keeps keeps both margins by the single measurement, pair by pair, and the least distance is the same.

    Neither the object counts nor what the hand does by itself.
    """
    task: TaskModel = request.getfixturevalue(name)
    robot = task.robot
    model = collision_model(robot, task.scene, task.task_name)
    model._reach[:] = 2 * CAP  # measures all that the batch does
    margins = Margins(enclosure=0.012, robot=0.03)
    postures = random_postures(robot, 600, seed=3)
    postures[:, robot.arm_size :] = synergies = 0.5 * (robot.lower + robot.upper)[robot.arm_size :]
    batch = BatchClearance(robot, enclosure_world(robot, task.scene, margins), synergies)
    kept, clearances, _ = batch.measure(postures[:, : robot.arm_size])
    group = [batch.kinematics.group_of[joint] for joint in model.joints.tolist()]
    counts = [
        pair.kind in {"enclosure clearance", "obstacle clearance"} or group[pair.first] != group[pair.second]
        for pair in model.pairs
    ]
    counts = np.array(counts) & np.array([pair.kind != "object clearance" for pair in model.pairs])
    wanted = np.array([0.03 if pair.kind == "self clearance" else 0.012 for pair in model.pairs])
    expected, least = [], []
    for i, posture in enumerate(postures):
        found = model.distances(configuration(robot, posture))
        values, limits = found.values[counts[found.indices]], wanted[found.indices][counts[found.indices]]
        if (values >= limits).all():
            expected.append(i)
            least.append(values.min(initial=CAP))
    assert kept.tolist() == expected
    assert 5 < len(expected) < 595
    np.testing.assert_allclose(clearances, least, atol=1e-6)
    assert min(least) < CAP


def test_pairs_of_the_glovebox(sphere_task: TaskModel) -> None:
    """Every moving link against six walls; the finger tips, which are behind their pads, not against the object."""
    pairs = sphere_task.collisions.pairs
    links = {pair.link for pair in pairs if pair.kind == "enclosure clearance"}
    assert len(links) == 16
    assert sum(pair.kind == "enclosure clearance" for pair in pairs) == 6 * 16
    against_object = {pair.link for pair in pairs if pair.kind == "object clearance"}
    assert links - against_object == {"robotiq_85_left_finger_tip_link", "robotiq_85_right_finger_tip_link"}
    disabled = sphere_task.robot.urdf.disabled_pairs
    selves = [pair for pair in pairs if pair.kind == "self clearance"]
    assert len({frozenset((pair.first, pair.second)) for pair in selves}) == len(selves)
    assert not disabled & {frozenset((pair.link, pair.other)) for pair in selves}


# ---- culling and the clearance term


def clearance(problem: GraspProblem, posture: Array) -> Any:
    x = np.concatenate([posture, np.zeros(problem.lower.size - posture.size)])
    return Clearance(problem.model).inside(problem.state(x))


def test_culling_changes_no_clearance(sphere_task: TaskModel, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = GraspProblem(sphere_task, (0, 1))
    postures = random_postures(sphere_task.robot, 6, seed=11)
    culled = [clearance(problem, posture) for posture in postures]
    everything = np.arange(len(sphere_task.collisions.pairs))
    monkeypatch.setattr(collision, "near_pairs", lambda *geometry: everything)
    for posture, one in zip(postures, culled, strict=True):
        full = clearance(problem, posture)
        np.testing.assert_allclose(one.values, full.values, atol=1e-12)
        np.testing.assert_allclose(one.jacobian, full.jacobian, atol=1e-12)


def test_clearance_does_not_jump_where_pairs_come_into_reach(sphere_task: TaskModel) -> None:
    """The places on a path where the set of measured pairs changes are bisected; both sides give one clearance."""
    problem, robot = GraspProblem(sphere_task, (0, 1)), sphere_task.robot
    start, end = random_postures(robot, 2, seed=6)
    end = start + 0.25 * (end - start)

    def measured_at(t: float) -> list[int]:
        return sphere_task.collisions.distances(configuration(robot, start + t * (end - start))).indices.tolist()

    grid = np.linspace(0.0, 1.0, 60)
    sets = [measured_at(t) for t in grid]
    changes = [k for k in range(len(grid) - 1) if sets[k] != sets[k + 1]]
    assert len(changes) >= 10
    for k in changes:
        low, high = grid[k], grid[k + 1]
        while high - low > 1e-10:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if measured_at(middle) == sets[k] else (low, middle)
        before, after = (clearance(problem, start + t * (end - start)) for t in (low, high))
        np.testing.assert_allclose(after.values, before.values, atol=1e-8)
        np.testing.assert_allclose(after.jacobian, before.jacobian, atol=1e-5)


# ---- shapes


SHAPES = st.one_of(
    st.builds(lambda r: Sphere(type="sphere", radius=r), st.floats(0.01, 0.2)),
    st.builds(lambda r, h: Cylinder(type="cylinder", radius=r, height=h), st.floats(0.01, 0.2), st.floats(0.02, 0.3)),
    st.builds(lambda *s: Box(type="box", size=s), *[st.floats(0.02, 0.3)] * 3),
)
POINTS = st.tuples(*[st.floats(-0.3, 0.3)] * 3).map(np.array)


def smooth_there(shape: Shape, point: Array) -> bool:
    """Whether the distance is smooth within 1e-4 of the point, and curved little enough for differences."""
    if isinstance(shape, Sphere):
        return bool(np.linalg.norm(point) > 1e-2)
    if isinstance(shape, Cylinder):
        rho = float(np.hypot(point[0], point[1]))
        over = np.sort([rho - shape.radius, abs(point[2]) - 0.5 * shape.height])
        if rho < 1e-2:
            return False
    else:
        over = np.sort(np.abs(point) - 0.5 * np.array(shape.size))
    if over[-1] < 0:
        return bool(over[-1] - over[-2] > 1e-4 and np.abs(point).min() > 1e-4)
    return bool(np.abs(over).min() > 1e-4)


@settings(max_examples=150)
@given(shape=SHAPES, point=POINTS)
def test_derivatives_of_signed_distance(shape: Shape, point: Array) -> None:
    assume(smooth_there(shape, point))
    surface = surface_of(shape)
    _, gradients, hessians = surface.signed_distance(point[None])
    numeric = differences(lambda p: surface.signed_distance(p[None])[0][0], point)
    np.testing.assert_allclose(gradients[0], numeric, atol=1e-8)
    numeric = differences(lambda p: surface.signed_distance(p[None])[1][0], point)
    np.testing.assert_allclose(hessians[0], numeric, atol=1e-5 * (1 + np.abs(numeric).max()))
    assert np.linalg.norm(gradients[0]) == pytest.approx(1.0)


@settings(max_examples=150)
@given(shape=SHAPES, point=POINTS)
def test_signed_distance_is_that_of_coal(shape: Shape, point: Array) -> None:
    surface = surface_of(shape)
    [distance], _, _ = surface.signed_distance(point[None])
    # Coal errs where the centre of a ball is in a cylinder, and on its axis and in its middle plane.
    far = distance > 1e-6 and np.hypot(point[0], point[1]) > 1e-3 and abs(point[2]) > 1e-3
    assume(far or not isinstance(shape, Cylinder))
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = True
    at = coal.Transform3s(np.eye(3), point)
    [piece], probe = surface.solids(), 1e-3
    expected = coal.distance(piece.geometry, coal.Transform3s(), coal.Sphere(probe), at, request, result) + probe
    assert distance == pytest.approx(expected, abs=2e-6)


@given(shape=SHAPES, seed=st.integers(0, 2**32 - 1))
def test_extents_and_widths(shape: Shape, seed: int) -> None:
    surface = surface_of(shape)
    directions = np.random.default_rng(seed).normal(size=(50, 3))
    directions = np.concatenate([directions / np.linalg.norm(directions, axis=1)[:, None], np.eye(3)])
    extents = np.array([surface.extent(direction) for direction in directions])
    widths = extents + [surface.extent(-direction) for direction in directions]
    assert widths.min() >= surface.least_width - 1e-12
    assert widths[-3:].min() == pytest.approx(surface.least_width)
    assert extents.max() <= surface.radius + 1e-12
    # the point of the surface farthest along a direction is on the surface
    if isinstance(shape, Box):
        farthest = np.sign(directions) * np.array(shape.size) / 2
    elif isinstance(shape, Cylinder):
        across = np.linalg.norm(directions[:, :2], axis=1, keepdims=True)
        rim = shape.radius * directions[:, :2] / np.where(across > 0, across, 1.0)
        farthest = np.column_stack([rim, np.sign(directions[:, 2]) * shape.height / 2])
    else:
        farthest = surface.radius * directions
    np.testing.assert_allclose((farthest * directions).sum(axis=1), extents, atol=1e-12)
    np.testing.assert_allclose(surface.signed_distance(farthest)[0], 0.0, atol=1e-12)


def test_distance_at_the_very_centre_is_finite() -> None:
    cylinder = Cylinder(type="cylinder", radius=0.05, height=0.2)
    for shape in (Sphere(type="sphere", radius=0.05), Box(type="box", size=(0.1, 0.1, 0.1)), cylinder):
        distance, gradient, hessian = surface_of(shape).signed_distance(np.zeros((1, 3)))
        assert distance[0] == pytest.approx(-0.05)
        assert np.linalg.norm(gradient[0]) == pytest.approx(1.0)
        assert np.isfinite(hessian).all()
