"""Many obstacles: the tree finds all that is near, and culling changes no bit of any result."""

from __future__ import annotations

import itertools
import math
from typing import Any

import coal
import numpy as np
import pytest
from conftest import Array, SceneFactory, collision_model
from hypothesis import given
from hypothesis import strategies as st

from pinograsp import Body, Box, Compound, Part, Pose, Sphere
from pinograsp.collision.ball_tree import BallTree
from pinograsp.collision.batch_clearance import BatchClearance
from pinograsp.collision.boxes import _box_gap, half_edges
from pinograsp.collision.distances import REACH, Distances
from pinograsp.collision.scene_world import enclosure_world
from pinograsp.collision.solids import bounded, distance_request
from pinograsp.collision.world import BodyKey
from pinograsp.descriptions import Scene
from pinograsp.kinematics.forward import forward
from pinograsp.kinematics.hand_posture import hand_opening
from pinograsp.kinematics.robot import Robot
from pinograsp.problem.constraints.clearance import Clearance
from pinograsp.problem.task_model import TaskModel
from pinograsp.verification.check import Verifier
from pinograsp.verification.clearance import CAP, Placed, Surroundings, part_distance, shape_figure
from pinograsp.verification.shapes import PlacedShape

ROD = Compound(
    parts=(
        Part(shape=Box(size=(0.06, 0.01, 0.01))),
        Part(shape=Sphere(radius=0.012), pose=Pose(position=(0.03, 0.0, 0.0))),
    )
)


def rotation(rng: np.random.Generator) -> Array:
    Q, R = np.linalg.qr(rng.normal(size=(3, 3)))
    Q *= np.sign(np.diag(R))
    return Q if np.linalg.det(Q) > 0 else Q[:, ::-1]


@pytest.fixture(scope="module")
def cluttered(glovebox: Scene) -> Scene:
    """The glovebox with 80 things in all of it, away from the object and the robot's base."""
    rng, obstacles = np.random.default_rng(3), dict[str, Body]()
    low, high = np.array(glovebox.enclosure.min), np.array(glovebox.enclosure.max)
    kept_free = [np.array(glovebox.objects["sphere"].pose.position), np.array(glovebox.mounting.position)]
    while len(obstacles) < 80:
        place = rng.uniform(low, high)
        if min(np.linalg.norm(place - at) for at in kept_free) > 0.2:
            shape = (Box(size=(0.02, 0.03, 0.05)), Sphere(radius=0.02), ROD)[len(obstacles) % 3]
            pose = Pose(position=tuple(place.tolist()), rpy=tuple(rng.uniform(-3, 3, 3).tolist()))
            obstacles[f"thing {len(obstacles)}"] = Body(shape=shape, pose=pose)
    return glovebox.model_copy(update={"obstacles": obstacles})


@pytest.fixture(scope="module")
def model(gen3: Robot, cluttered: Scene) -> TaskModel:
    return TaskModel(gen3, cluttered, "sphere")


def postures(robot: Robot, count: int) -> Array:
    low, high = np.maximum(robot.lower, -math.pi), np.minimum(robot.upper, math.pi)
    return np.random.default_rng(0).uniform(low, high, (count, robot.posture_size))


# ---- the tree


@given(count=st.integers(0, 60), seed=st.integers(0, 2**32 - 1))
def test_the_tree_finds_what_a_look_at_every_ball_finds(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    centers, radii = rng.uniform(-1, 1, (count, 3)), rng.uniform(0.0, 0.2, count)
    R = np.array([rotation(rng) for _ in range(4)])
    points, halves, reaches = rng.uniform(-1, 1, (4, 3)), rng.uniform(0.0, 0.4, (4, 3)), rng.uniform(-0.1, 0.3, 4)
    tree = BallTree.of(centers + 1.0, radii).moved(centers)
    found = list(zip(*(numbers.tolist() for numbers in tree.near(R, points, halves, reaches)), strict=True))
    assert len(set(found)) == len(found)
    for row, member in itertools.product(range(4), range(count)):
        beyond = np.maximum(np.abs((centers[member] - points[row]) @ R[row]) - halves[row], 0.0)
        gap = float(np.linalg.norm(beyond)) - radii[member] - reaches[row]
        if abs(gap) > 1e-8:
            assert ((row, member) in found) == (gap < 0.0 and reaches[row] + radii[member] > 0.0)
    assert [row for row, _ in found] == sorted(row for row, _ in found)


@given(seed=st.integers(0, 2**32 - 1))
def test_boxes_are_no_nearer_than_their_gap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solids = [bounded(coal.Box(*rng.uniform(0.01, 0.3, 3)), np.eye(4)) for _ in range(2)]
    R, apart = [rotation(rng) for _ in solids], rng.uniform(-0.4, 0.4, 3)
    poses = coal.Transform3s(R[0], np.zeros(3)), coal.Transform3s(R[1], apart)
    shapes = [solid.shape for solid in solids]
    distance = coal.distance(shapes[0], poses[0], shapes[1], poses[1], distance_request(), coal.DistanceResult())
    gap = _box_gap(R[0], half_edges(shapes[0]), R[1], half_edges(shapes[1]), apart)
    assert gap <= distance + 1e-8
    beside = np.array([half_edges(shapes[0])[0] + half_edges(shapes[1])[0] + 0.02, 0.0, 0.0])
    straight = _box_gap(np.eye(3), half_edges(shapes[0]), np.eye(3), half_edges(shapes[1]), beside)
    assert straight == pytest.approx(0.02)


# ---- the problem


def test_what_is_not_measured_is_out_of_reach(model: TaskModel) -> None:
    collisions, robot = model.collisions, model.robot
    data, everything = robot.model.createData(), np.arange(len(model.collisions.pairs))
    reach = REACH + np.array([pair.margin for pair in collisions.pairs])
    obstacles = np.array([pair.kind == "obstacle clearance" for pair in collisions.pairs])
    near = 0
    for posture in postures(robot, 12):
        configuration = forward(robot, data, posture)
        values = collisions.measure(everything, configuration)[0]
        measured = collisions.distances(configuration)
        assert set(np.flatnonzero(values < reach)) <= set(measured.indices)
        assert (np.diff(measured.indices) > 0).all()
        np.testing.assert_array_equal(measured.values, values[measured.indices])
        assert len(measured.indices) < 0.05 * len(everything)
        near += int(obstacles[measured.indices].sum())
    assert near > 50


class _Measured:
    """As much of a state as the clearance looks at."""

    def __init__(self, distances: Distances, size: int) -> None:
        self.distances, self.x = distances, np.zeros(size)


def test_culling_changes_no_bit_of_the_clearance(model: TaskModel) -> None:
    collisions, robot, clearance = model.collisions, model.robot, Clearance(model)
    data, everything = robot.model.createData(), np.arange(len(model.collisions.pairs))
    for posture in postures(robot, 8):
        configuration = forward(robot, data, posture)
        culled = collisions.distances(configuration)
        values, points, normals = collisions.measure(everything, configuration)
        gradients = np.zeros((len(everything), culled.gradients.shape[1]))
        gradients[culled.indices] = culled.gradients
        del points, normals  # gradients of pairs out of reach count for nothing
        whole: Any = _Measured(Distances(everything, values, gradients), len(posture))
        part: Any = _Measured(culled, len(posture))
        for one, other in zip(clearance.inside(whole), clearance.inside(part), strict=True):
            np.testing.assert_array_equal(one, other)


def test_an_obstacle_that_moves_is_found_where_it_is(gen3: Robot, cluttered: Scene, model: TaskModel) -> None:
    name = "thing 5"
    pose = Pose(position=(0.5, 0.1, 0.0), rpy=(0.2, 0.5, 0.0))
    body = Body(shape=cluttered.obstacles[name].shape, pose=pose)
    built = TaskModel(gen3, cluttered.with_obstacle(name, body), "sphere").collisions
    moved = model.collisions.moved(BodyKey("obstacle", name), pose.matrix)
    data = model.robot.model.createData()
    for posture in postures(model.robot, 6):
        configuration = forward(model.robot, data, posture)
        one, other = moved.distances(configuration), built.distances(configuration)
        np.testing.assert_array_equal(one.indices, other.indices)
        np.testing.assert_array_equal(one.values, other.values)


def test_a_link_that_never_moves_needs_no_obstacle(toy: Robot, make_toy_scene: SceneFactory) -> None:
    post = {"shape": {"type": "sphere", "radius": 0.02}, "pose": {"position": [0.2, 0.0, 0.22]}}
    collisions = collision_model(toy, make_toy_scene(obstacles={"post": post}), "ball")
    pairs = [pair for pair in collisions.pairs if pair.kind == "obstacle clearance"]
    assert {pair.link for pair in pairs} == {"arm", "left", "right"}
    data, found = toy.model.createData(), set[str]()
    for angle in np.linspace(-1.0, 1.0, 9):
        measured = collisions.distances(forward(toy, data, np.array([angle, 0.03])))
        found |= {collisions.pairs[i].link for i in measured.indices if collisions.pairs[i].other == "post"}
    assert "right" in found


# ---- rows of the database


class _Everything(BatchClearance):
    """Looks at every obstacle."""

    def _near_obstacles(self, frames: Any, most: Array) -> Any:
        pairs = itertools.product(range(len(most)), range(len(self._pieces)), range(len(self._obstacles)))
        which, pieces, members = np.array(list(pairs)).T
        return which, pieces, members, np.full(len(which), -np.inf)


def test_culling_changes_no_bit_of_a_row(gen3: Robot, cluttered: Scene) -> None:
    robot = gen3.mounted(cluttered.mounting.matrix)
    world = enclosure_world(robot, cluttered, cluttered.task("sphere").margin)
    q = postures(robot, 1500)[:, : robot.arm_size]
    one, other = (kind(robot, world, hand_opening(robot)).measure(q) for kind in (BatchClearance, _Everything))
    assert len(one[0]) >= 3
    np.testing.assert_array_equal(one[0], other[0])
    np.testing.assert_array_equal(one[1], other[1])
    none = BatchClearance(
        robot,
        enclosure_world(robot, cluttered.model_copy(update={"obstacles": {}}), cluttered.task("sphere").margin),
        hand_opening(robot),
    )
    assert len(none.measure(q)[0]) > len(one[0])


# ---- the verification


def test_culling_changes_no_bit_of_a_certificate(gen3: Robot, cluttered: Scene) -> None:
    verifier = Verifier(gen3, cluttered, "sphere")
    shapes = [PlacedShape(name, body) for name, body in cluttered.obstacles.items()]
    meshes = verifier._robot.moving
    around, seen = Surroundings(meshes, shapes), 0
    for posture in postures(gen3, 3):
        joints = gen3.joints_by_name(posture)
        placed = Placed(verifier._robot.meshes, verifier._kinematics.poses(joints))
        figure = shape_figure("obstacle clearance", around, placed, 0.005)
        pairs = itertools.product(meshes, [part for shape in shapes for part in shape.parts])
        least = min(part_distance(mesh, part, placed, CAP) for mesh, part in pairs)
        assert figure.value == least
        listed = [pair for pair in verifier.clearances(joints) if pair.name == "obstacle clearance"]
        assert min((pair.distance for pair in listed), default=CAP) == least
        assert len({(pair.link, pair.other) for pair in listed}) == len(listed)
        seen += len(listed)
    assert seen > 3
