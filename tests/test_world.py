"""Bodies with roles: what must keep apart, poses that change, and what the hand holds."""

from __future__ import annotations

import gc
import pickle
import weakref
from pathlib import Path

import coal
import numpy as np
import pytest
import trimesh
from conftest import TOY_URDF, Array, RobotFactory, SceneFactory, collision_model, differences

from pinograsp.collision.distances import CollisionModel
from pinograsp.collision.scene_world import task_world
from pinograsp.collision.solids import bounded, link_bodies
from pinograsp.collision.world import Body, BodyKey, Hull, World
from pinograsp.descriptions import Scene
from pinograsp.descriptions.pose import Pose
from pinograsp.errors import InputError
from pinograsp.geometry.convex_solid import IDENTITY
from pinograsp.kinematics.forward import Configuration, forward
from pinograsp.kinematics.robot import Robot, _built
from pinograsp.memo import remembered
from pinograsp.progress import Progress

POSTURE = np.array([0.2, 0.03])
BALL = BodyKey("target", "ball")


@pytest.fixture(scope="module")
def world(toy: Robot, make_toy_scene: SceneFactory) -> World:
    scene = make_toy_scene()
    return task_world(toy, scene, scene.task("ball"))


def at(robot: Robot, posture: Array = POSTURE) -> Configuration:
    return forward(robot, robot.model.createData(), posture)


def least(model: CollisionModel, robot: Robot, posture: Array, kind: str, other: str) -> float:
    indices = [i for i, pair in enumerate(model.pairs) if pair.kind == kind and pair.other == other]
    return float(model.measure(np.array(indices), at(robot, posture))[0].min())


def test_roles_of_a_task(world: World) -> None:
    assert [body.name for body in world.of("link")] == ["base", "arm", "left", "right"]
    assert len(world.of("wall")) == 6
    assert [body.key for body in world.of("target", "obstacle")] == [BALL]
    assert world.margins["target"] > 0.001
    assert world.margins["link"] > 0.005


def test_a_moved_body_is_the_same_as_one_built_there(toy: Robot, make_toy_scene: SceneFactory) -> None:
    pose = Pose(position=(0.1, 0.05, 0.15), rpy=(0.3, -0.2, 1.0))
    scene = make_toy_scene()
    built = collision_model(toy, scene.with_object_pose("ball", pose), "ball")
    world = task_world(toy, scene, scene.task("ball"))
    for moved in (
        CollisionModel(toy, world).moved(BALL, pose.matrix),
        CollisionModel(toy, world.moved(BALL, pose.matrix)),
    ):
        one, other = (model.distances(at(toy)) for model in (moved, built))
        np.testing.assert_array_equal(one.indices, other.indices)
        np.testing.assert_array_equal(one.values, other.values)
        np.testing.assert_array_equal(one.gradients, other.gradients)


def test_moving_leaves_the_model_that_it_began_with(toy: Robot, world: World) -> None:
    model = CollisionModel(toy, world)
    before = model.distances(at(toy)).values
    model.moved(BALL, Pose(position=(0.1, 0.0, 0.3)).matrix).distances(at(toy))
    np.testing.assert_array_equal(model.distances(at(toy)).values, before)


def test_a_body_that_is_not_there_cannot_be_moved(toy: Robot, world: World) -> None:
    with pytest.raises(KeyError):
        world.moved(BodyKey("obstacle", "ball"), IDENTITY)
    with pytest.raises(KeyError):
        CollisionModel(toy, world).moved(BodyKey("obstacle", "ball"), IDENTITY)


def test_a_wall_that_is_moved_has_the_distance_of_one_built_there(toy: Robot, make_toy_scene: SceneFactory) -> None:
    here, there = make_toy_scene(), make_toy_scene(enclosure={"min": [-0.4, -0.3, -0.2], "max": [0.37, 0.3, 0.4]})
    model = collision_model(toy, here, "ball").moved(BodyKey("wall", "wall x=0.4"), Pose(position=(-0.03, 0, 0)).matrix)
    posture = np.array([1.2, 0.03])
    one = least(model, toy, posture, "enclosure clearance", "wall x=0.4")
    other = least(collision_model(toy, there, "ball"), toy, posture, "enclosure clearance", "wall x=0.37")
    assert one == pytest.approx(other, abs=1e-12)


def held_box(robot: Robot, link: str) -> Body:
    """A box of 30 mm in the hand, 60 mm beyond the origin of a link's joint."""
    solid = bounded(coal.Box(0.03, 0.03, 0.03), Pose(position=(0.0, 0.0, 0.06)).matrix)
    joint = robot.model.getJointId(link)
    return Body("held", "box", joint, IDENTITY, (solid,), (Hull(solid, (0,)),))


def test_what_is_held_moves_with_the_link_that_is_its_parent(toy: Robot, make_toy_scene: SceneFactory) -> None:
    """Kept off walls, obstacles and links by their margins, with gradients; off the links named it need not be."""
    post = {"shape": {"type": "sphere", "radius": 0.02}, "pose": {"position": [0.2, 0.0, 0.22]}}
    scene = make_toy_scene(obstacles={"post": post})
    bare = task_world(toy, scene, scene.task("ball"))
    box = held_box(toy, "slide_left")
    fingers = frozenset(frozenset((box.key, BodyKey("link", name))) for name in ("left", "right"))
    world = World((*bare.bodies, box), {**bare.margins, "held": bare.margins["link"]}, bare.allowed | fingers)
    model = CollisionModel(toy, world)
    kinds = {(pair.kind, pair.link, pair.other) for pair in model.pairs if "box" in (pair.link, pair.other)}
    assert ("obstacle clearance", "box", "post") in kinds
    assert ("self clearance", "box", "arm") in kinds
    assert ("self clearance", "box", "base") in kinds
    assert len([kind for kind, _, _ in kinds if kind == "enclosure clearance"]) == 6
    assert not {pair for pair in kinds if {"left", "right"} & set(pair)}
    [index] = [i for i, p in enumerate(model.pairs) if (p.link, p.other) == ("box", "post")]

    def distance(posture: Array) -> float:
        return float(model.measure(np.array([index]), at(toy, posture))[0][0])

    posture = np.array([0.6, 0.02])
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.015 + [0.0, 0.0, 0.06]
    configuration = at(toy, posture)
    world_corners = corners @ configuration.rotations[box.joint].T + configuration.translations[box.joint]
    assert distance(posture) <= np.linalg.norm(world_corners - [0.2, 0.0, 0.22], axis=1).min() - 0.02 + 1e-9
    measured = model.distances(configuration)
    row = measured.indices.tolist().index(index)
    np.testing.assert_allclose(measured.gradients[row], differences(distance, posture, 1e-6), atol=1e-5)


def test_solids_are_made_once_for_a_robot(gen3: Robot, glovebox: Scene) -> None:
    here, there = link_bodies(gen3), link_bodies(gen3.mounted(glovebox.mounting.matrix))
    assert all(a.solids is b.solids for a, b in zip(here, there, strict=True))
    fewer = gen3.with_pads(("left", "right")[::-1])
    assert [pad.name for pad in fewer.description.pads] == ["right", "left"]
    assert all(a.solids is b.solids for a, b in zip(here, link_bodies(fewer), strict=True))


def test_a_robot_that_travels_is_built_once_until_its_files_change(make_toy: RobotFactory, tmp_path: Path) -> None:
    trimesh.creation.box((0.01, 0.02, 0.04)).export(tmp_path / "finger.stl")
    box = '<geometry><box size="0.01 0.02 0.04"/></geometry>'
    mesh = '<geometry><mesh filename="finger.stl"/></geometry>'
    robot = make_toy(TOY_URDF.replace(box, mesh), meshes=(tmp_path / "finger.stl",))
    mounted = robot.mounted(Pose(position=(0.1, 0.2, 0.3)).matrix)
    first, second = (pickle.loads(pickle.dumps(mounted)) for _ in range(2))
    assert first.unmounted is second.unmounted
    link_bodies(first)  # as they are now
    np.testing.assert_array_equal(first.T_world_root, mounted.T_world_root)
    [file] = set(robot.urdf.meshes)
    trimesh.creation.box((0.01, 0.02, 0.05)).export(file)
    changed = pickle.loads(pickle.dumps(Robot(robot.description).mounted(mounted.T_world_root)))
    assert changed.unmounted is not first.unmounted
    link_bodies(changed)
    on_its_way = pickle.dumps(changed.unmounted)
    trimesh.creation.box((0.01, 0.02, 0.06)).export(file)
    _built.cache_clear()  # as in another process
    with pytest.raises(InputError, match="meshes changed since the robot was loaded"):
        pickle.loads(on_its_way)
    heights = [np.ptp(np.array(link_bodies(r)[2].solids[0].shape.points())[:, 2]) for r in (first, changed)]
    np.testing.assert_allclose(heights, [0.04, 0.05], atol=1e-7)


def test_bodies_are_reported_while_they_are_made(make_toy: RobotFactory) -> None:
    robot, seen = make_toy(), list[Progress]()
    link_bodies(robot, seen.append)
    assert seen == [Progress("convex pieces", done, 4) for done in range(4)]
    link_bodies(robot.mounted(np.eye(4)), seen.append)  # they are there
    assert len(seen) == 4


def test_an_interrupt_leaves_no_robot_without_some_of_its_bodies(make_toy: RobotFactory) -> None:
    robot = make_toy()

    def interrupt(progress: Progress) -> None:
        if progress.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        link_bodies(robot, interrupt)
    assert [body.name for body in link_bodies(robot)] == ["base", "arm", "left", "right"]


def test_what_is_remembered_goes_with_its_subject(make_toy: RobotFactory) -> None:
    calls = []

    @remembered
    def named(robot: Robot, suffix: str) -> str:
        calls.append(suffix)
        return robot.description.name + suffix

    robot, other = make_toy(), make_toy()
    found = [named(robot, "a"), named(robot, "a"), named(robot, "b"), named(other, "a")]
    assert found == ["toya", "toya", "toyb", "toya"]
    assert calls == ["a", "b", "a"]
    link_bodies(robot)
    gone = weakref.ref(robot)
    del robot
    gc.collect()
    assert gone() is None
