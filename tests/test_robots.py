"""The shipped robots, each in its scene: kinematics, gradients, grasps of the sphere and of the can.

What they are is compared with their URDFs as these are on disk, read by Pinocchio and an XML parser alone.
"""

from __future__ import annotations

import ast
import functools
import itertools
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from conftest import Array, agree, alone, matrix, poses_of, random_parameters
from numpy.typing import NDArray

import pinograsp
from benchmark_robots import SCENES
from pinograsp import Database, Robot, build_database, load_robot, load_scene, plan
from pinograsp.database import build, sampling
from pinograsp.descriptions import Scene, load_robot_description, shipped_robots
from pinograsp.descriptions.patches import SpherePatch
from pinograsp.descriptions.shapes import Cylinder, Shape, Sphere
from pinograsp.descriptions.urdf import read_urdf
from pinograsp.geometry.filled import center_of_mass_world
from pinograsp.onboarding.check import check_robot
from pinograsp.onboarding.parts import TOOL_FRAMES
from pinograsp.problem import GraspProblem, Residual, TaskModel, check_task
from pinograsp.problem.constraints.clearance import Clearance
from pinograsp.results import Contact, Grasp, Result
from pinograsp.solve.projection import initial_guesses, nearest_assignment
from pinograsp.solve.starts import starts_near

STARTS = 12
SLOW = pytest.mark.slow


@dataclass(frozen=True)
class Shipped:
    """What a shipped robot is, by the data sheets of arm and hand."""

    arm: int
    hand: int
    """Joints that synergies move, followers included."""
    synergies: int = 1
    pads: int = 2


ROBOTS = {
    "gen3_2f85": Shipped(arm=7, hand=6),
    "gen3_2f85_paper": Shipped(arm=7, hand=4),
    "panda": Shipped(arm=7, hand=2),
    "fr3": Shipped(arm=7, hand=2),
    "ur5_2f85": Shipped(arm=6, hand=6),
    "xarm7_2f85": Shipped(arm=7, hand=6),
    "xarm7_allegro": Shipped(arm=7, hand=15, synergies=10, pads=4),
}
TASKS = [(name, task) for name in ROBOTS for task in ("sphere", "can")]
ALLEGRO = "xarm7_allegro"
ALLEGRO_TASKS = [(ALLEGRO, "sphere"), (ALLEGRO, "can")]


def test_every_shipped_robot_is_tested() -> None:
    assert set(ROBOTS) == set(shipped_robots())


@functools.cache
def robot_named(name: str) -> Robot:
    return load_robot(name)


def scene_of(name: str, task: str) -> Scene:
    return load_scene(SCENES[name][task])


@functools.cache
def task_model(name: str, task: str) -> TaskModel:
    return TaskModel(robot_named(name), scene_of(name, task), task)


@pytest.fixture(params=list(ROBOTS))
def robot(request: pytest.FixtureRequest) -> Robot:
    return robot_named(request.param)


# ---- kinematics


@dataclass(frozen=True)
class UrdfJoint:
    """A movable joint as its URDF has it."""

    limits: tuple[float, float]
    """Infinite if it turns continuously."""
    mimic: tuple[str, float, float] | None
    """Leader, multiplier, offset."""


def joints_on_disk(robot: Robot) -> dict[str, UrdfJoint]:
    """Return the movable joints that the links of a robot hang on, from the XML of its URDFs."""
    description = robot.description
    parts = [(description.root, description.urdf_file)]
    parts += [
        (part.root, files.urdf) for part, files in zip(description.attach, description.attached_files, strict=True)
    ]
    return {
        joint.get("name", ""): urdf_joint(joint)
        for first, file in parts
        for joint in joints_below(ET.parse(file).getroot(), first)
        if end(joint, "child") in robot.urdf.links and joint.get("type") != "fixed"
    }


def end(joint: ET.Element, which: str) -> str:
    found = joint.find(which)
    assert found is not None
    return found.get("link", "")


def joints_below(tree: ET.Element, link: str | None) -> list[ET.Element]:
    """Return the joints that a link carries; None: all joints."""
    joints = tree.findall("joint")
    if link is None:
        return joints
    own = [joint for joint in joints if end(joint, "parent") == link]
    return own + [below for joint in own for below in joints_below(tree, end(joint, "child"))]


def urdf_joint(joint: ET.Element) -> UrdfJoint:
    limit, mimic = joint.find("limit"), joint.find("mimic")
    limits, follows = (-math.inf, math.inf), None
    if joint.get("type") != "continuous":
        assert limit is not None
        limits = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
    if mimic is not None:
        multiplier, offset = (float(mimic.get(k, d)) for k, d in (("multiplier", "1"), ("offset", "0")))
        follows = mimic.get("joint", ""), multiplier, offset
    return UrdfJoint(limits, follows)


def random_postures(robot: Robot, count: int) -> Array:
    return np.random.default_rng(0).uniform(robot.lower, robot.upper, (count, robot.posture_size))


def test_sizes(robot: Robot) -> None:
    description, expected = robot.description, ROBOTS[robot.description.name]
    arm = description.arm.joints
    assert len(arm) == robot.arm_size == expected.arm
    assert robot.posture_size == expected.arm + expected.synergies
    assert len(robot.pads) == expected.pads
    assert len(robot.hand_joints) == expected.hand
    hand = {robot.joint_names[row] for row in robot.hand_joints}
    assert set(arm).isdisjoint(hand)
    assert set(robot.joint_names) == joints_on_disk(robot).keys()
    assert set(robot.joint_names) - set(arm) - hand == description.hand.rest.keys()


def test_links_are_where_the_parts_have_them(robot: Robot) -> None:
    """Every link: each URDF as it is on disk by Pinocchio, one fixed to a link of those before it."""
    description = robot.description
    for posture in random_postures(robot, 3):
        angles = robot.joints_by_name(posture)
        assert angles.keys() == joints_on_disk(robot).keys()
        expected = posed(description.urdf_file, angles)
        for part, files in zip(description.attach, description.attached_files, strict=True):
            there = posed(files.urdf, angles)
            first = part.root or next(iter(there))
            mount = matrix({"position": list(part.position), "rpy": list(part.rpy)})
            T = expected[part.to] @ mount @ np.linalg.inv(there[first])
            expected = {link: T @ pose for link, pose in there.items()} | expected
        found = poses_of(robot.model, robot.joint_positions(posture))
        assert {*robot.urdf.links, description.arm.wrist, *(pad.link for pad in description.pads)} <= found.keys()
        for link in robot.urdf.links:
            np.testing.assert_allclose(found[link], expected[link], atol=1e-9, err_msg=link)


def posed(file: Path, angles: dict[str, float]) -> dict[str, Array]:
    """Return the poses of the links of a URDF file; joints that are not in it are passed over."""
    text = file.read_text()
    names = {joint.get("name") for joint in ET.fromstring(text).iterfind("joint") if joint.get("type") != "fixed"}
    return alone(text, {name: angle for name, angle in angles.items() if name in names})


def test_arm_joints_carry_each_other_and_the_hand(robot: Robot) -> None:
    """In the order of the file, and the fingers move nothing of the arm."""
    description = robot.description
    rows = [robot.joint_names.index(name) for name in description.arm.joints]
    wrist = robot.supports[robot.model.frames[robot.wrist_frame].parentJoint]
    assert rows == sorted(rows)
    assert wrist[rows].all()
    assert not wrist[robot.hand_joints].any()
    for pad in robot.pads:
        assert robot.supports[pad.joint, rows].all()
        assert robot.supports[pad.joint, robot.hand_joints].any()


def test_limits_keep_every_joint_in_its_own(robot: Robot) -> None:
    """Also followers; a limit of the arm is that of the file, else that of the URDF, else two turns."""
    on_disk, given = joints_on_disk(robot), robot.description.arm.limits
    assert np.isfinite([robot.lower, robot.upper]).all()
    assert (robot.lower < robot.upper).all()
    for i, name in enumerate(robot.description.arm.joints):
        low, high = given.get(name, np.clip(on_disk[name].limits, -2 * math.pi, 2 * math.pi))
        assert (robot.lower[i], robot.upper[i]) == pytest.approx((low, high), abs=1e-12)
    for posture in [robot.lower, robot.upper, *random_postures(robot, 50)]:
        q = dict(zip(robot.joint_names, robot.joint_positions(posture).tolist(), strict=True))
        for name, joint in on_disk.items():
            low, high = joint.limits
            assert low - 1e-9 <= q[name] <= high + 1e-9, name
            if joint.mimic:
                leader, multiplier, offset = joint.mimic
                assert q[name] == pytest.approx(multiplier * q[leader] + offset, abs=1e-12), name


def test_synergies_use_all_of_their_range(robot: Robot) -> None:
    """At either end some joint of the hand is at a limit of its own."""
    on_disk = joints_on_disk(robot)
    middle = 0.5 * (robot.lower + robot.upper)
    for column, bounds in itertools.product(range(robot.arm_size, robot.posture_size), (robot.lower, robot.upper)):
        posture = middle.copy()
        posture[column] = bounds[column]
        q = robot.joint_positions(posture)
        rows = np.flatnonzero(robot.B[:, column])
        slack = [min(abs(q[row] - end) for end in on_disk[robot.joint_names[row]].limits) for row in rows]
        assert min(slack) < 1e-9, robot.posture_names[column]


# ---- scenes and gradients


@pytest.mark.parametrize(("name", "task"), TASKS)
def test_tasks_suit_the_robot(name: str, task: str) -> None:
    """A sphere and an upright can; nothing about the tasks is refused or odd."""
    model = task_model(name, task)
    assert check_task(model) == []
    held = model.scene.objects[model.task.object]
    assert isinstance(held.shape, Sphere if task == "sphere" else Cylinder)
    assert held.pose.rpy == (0.0, 0.0, 0.0)
    assert len(model.robot.pads) == len(model.desired_points)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("robots")


@pytest.fixture(scope="module")
def small_batches() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "DRAWS", 1024)
        patch.setattr(sampling, "DRAWS", 1024)
        patch.setattr(sampling, "_BLOCK", 1024)
        yield


@pytest.fixture
def database(name: str, folder: Path, small_batches: None) -> Iterator[Database]:
    """A small database of the robot `name`, for both of its tasks."""
    with build_database(
        robot_named(name), scene_of(name, "sphere"), folder / f"{name}.duckdb", size=300, workers=1
    ) as small:
        yield small


@pytest.mark.parametrize("where", ["start", "near"])
@pytest.mark.parametrize(("name", "task"), TASKS)
def test_gradients(name: str, task: str, where: str, database: Database) -> None:
    """At a start, where little holds, and a little off a projected one, where everything nearly does."""
    model = task_model(name, task)
    problem, x = start(model, database) if where == "start" else near_a_grasp(model, database)

    def values(x: Array) -> Array:
        found = problem.evaluate(x)
        return np.array([found.cost, *found.equalities.values, *found.inequalities.values])

    def residual(x: Array) -> Residual:
        return problem.projection_residual(x, 0.3, 1.0)

    found, loose = problem.evaluate(x), np.where(near_a_cylinder(problem, x), LOOSE, STRICT)
    assert len(found.equalities.values) == 4 * len(model.robot.pads)
    jacobian = np.vstack([found.cost_gradient, found.equalities.jacobian, found.inequalities.jacobian])
    floor = np.where(np.arange(len(jacobian)) > len(found.equalities.values), 1.0, 1e-2)
    agree(jacobian, values, x, floor, behind(loose, len(jacobian)))
    jacobian = residual(x).jacobian
    agree(jacobian, lambda x: residual(x).values, x, tolerance=behind(loose, len(jacobian)))


def start(model: TaskModel, database: Database, number: int = 0) -> tuple[GraspProblem, Array]:
    """Return a start with contacts somewhere on their pads, and the problem with the assignment that suits it."""
    posture = starts_near(database, model, STARTS, seed=0)[number]
    x = np.concatenate([posture, random_parameters(model.robot, np.random.default_rng(number), 0.5)])
    problem = GraspProblem(model, tuple(range(len(model.robot.pads))))
    return GraspProblem(model, nearest_assignment(model, problem.state(x))), x


def near_a_grasp(model: TaskModel, database: Database) -> tuple[GraspProblem, Array]:
    """Return a point a little off the first projected start that keeps every constraint to a millimetre."""
    for number in range(STARTS):
        problem, x = start(model, database, number)
        x = next(initial_guesses(problem, x, "contacts and clearance"))
        if problem.evaluate(x).violation < 0.1:
            return problem, x + np.random.default_rng(0).normal(0.0, 1e-4, len(x))
    raise AssertionError("no start is near a grasp")


STRICT, LOOSE = 1e-5, 1e-2
"""Relative errors. Coal's nearest points of a cylinder are found by iteration: its normals are a little off."""


def behind(clearances: Array, count: int) -> Array:
    """Return tolerances of `count` rows, the last ones those of clearances."""
    return np.append(np.full(count - len(clearances), STRICT), clearances)


def near_a_cylinder(problem: GraspProblem, x: Array) -> NDArray[np.bool_]:
    """Return of which links the clearance takes in a distance to or from a cylinder."""
    scene, xml = problem.model.scene, ET.fromstring(problem.model.robot.urdf.xml)
    bodies = {**scene.objects, **scene.obstacles}
    curved = {name for name, body in bodies.items() if isinstance(body.shape, Cylinder)}
    curved |= {link.get("name", "") for link in xml.iterfind("link[collision]") if link.find(".//cylinder") is not None}
    pairs = [problem.model.collisions.pairs[index] for index in problem.state(x).distances.indices]
    links = {pair.link for pair in pairs if {pair.link, pair.other} & curved}
    return np.array([link in links for link in Clearance(problem.model).links])


# ---- grasps


@pytest.fixture(scope="module")
def planned() -> dict[tuple[str, str], Result]:
    """Results that there are already."""
    return {}


@pytest.fixture
def result(name: str, task: str, planned: dict[tuple[str, str], Result], database: Database) -> Result:
    if (name, task) not in planned:
        scene = scene_of(name, task)
        planned[name, task] = plan(robot_named(name), scene, task, starts=STARTS, workers=1, database=database)
    return planned[name, task]


@pytest.mark.parametrize(("name", "task"), TASKS)
def test_grasps(name: str, task: str, result: Result) -> None:
    """Of 12 starts ten give grasps, with many fingers four. None is refuted, and what is reported of them is true."""
    scene, robot = scene_of(name, task), robot_named(name)
    assert (result.robot, result.scene, result.task) == (name, scene.name, task)
    assert result.done == STARTS
    assert result.verified >= (4 if name == ALLEGRO else 10)
    assert result.refuted == 0
    mounted = robot.mounted(scene.mounting.matrix)
    on_disk = joints_on_disk(robot)
    for grasp in result.grasps:
        assert grasp.certificate.verified
        assert grasp.joints.keys() == on_disk.keys()
        poses = poses_of(mounted.model, np.array([grasp.joints[joint] for joint in mounted.joint_names]))
        for contact in grasp.contacts:
            assert off_its_pad(contact, mounted, poses) < 2e-5
        assert_held(grasp, scene, task)


def off_its_pad(contact: Contact, robot: Robot, poses: dict[str, Array]) -> float:
    """Return how far a contact is off the surface that its pad is a part of, m."""
    [patch] = [pad.patch for pad in robot.description.pads if pad.name == contact.pad]
    T = poses[contact.link]
    point = patch.rotation.T @ (T[:3, :3].T @ (contact.point - T[:3, 3]) - patch.origin)
    return abs(np.linalg.norm(point) - patch.radius if isinstance(patch, SpherePatch) else point[2])


def assert_held(grasp: Grasp, scene: Scene, task: str) -> None:
    """Contacts on the object, forces that push, within the friction cones, and carry the weight."""
    held, wanted = scene.objects[task], scene.tasks[task]
    arms = np.array([contact.point for contact in grasp.contacts]) - center_of_mass_world(held)
    forces = np.array([contact.force for contact in grasp.contacts])
    np.testing.assert_allclose([above(arm, held.shape) for arm in arms], 0.0, atol=2e-5)
    np.testing.assert_allclose(forces.sum(axis=0) + wanted.wrench.force, 0.0, atol=5e-3)
    torques = np.cross(arms, forces) - [contact.spin_torque * contact.normal for contact in grasp.contacts]
    np.testing.assert_allclose(torques.sum(axis=0), 0.0, atol=2e-4)
    slopes = [[above(arm + d, held.shape) - above(arm - d, held.shape) for d in 1e-6 * np.eye(3)] for arm in arms]
    pressure = -(forces * np.array(slopes) / 2e-6).sum(axis=1)
    assert (pressure > 0.0).all()
    friction = np.sqrt(np.maximum((forces**2).sum(axis=1) - pressure**2, 0.0))
    assert (friction <= wanted.contact.friction * pressure * (1 + 1e-3)).all()
    assert np.linalg.norm(forces, axis=1).max() <= wanted.contact.max_force * (1 + 1e-6)


def above(point: Array, shape: Shape) -> float:
    """Return the height of a point near its surface over a sphere or an upright cylinder, m."""
    if isinstance(shape, Sphere):
        return float(np.linalg.norm(point)) - shape.radius
    assert isinstance(shape, Cylinder)
    return max(math.hypot(point[0], point[1]) - shape.radius, abs(point[2]) - 0.5 * shape.height)


@SLOW
@pytest.mark.parametrize("name", ROBOTS)
def test_most_starts_are_verified(name: str) -> None:
    result = plan(robot_named(name), scene_of(name, "sphere"), "sphere", starts=500, workers=2)
    assert result.done == 500
    assert result.verified >= 300, result.blocked


# ---- a hand of many fingers


@pytest.mark.parametrize(("name", "task"), ALLEGRO_TASKS)
def test_three_of_four_fingers_hold(name: str, task: str, result: Result) -> None:
    """The pads that the task names, six internal forces; the ring finger stays off the object."""
    robot, scene = robot_named(name), load_scene(result.scene)
    held, ring = scene.objects[task], robot.description.pads[3]
    assert ring.name == "ring"
    for grasp in result.grasps:
        assert (
            tuple(contact.pad for contact in grasp.contacts) == scene.tasks[task].pads == ("thumb", "index", "middle")
        )
        assert grasp.synergy.shape == (10,)
        assert grasp.contact_parameters.shape == (6,)
        arms = np.array([contact.point for contact in grasp.contacts]) - center_of_mass_world(held)
        G = np.block([[np.eye(3)] * 3, [pin.skew(arm) / held.shape.radius for arm in arms]])
        assert np.linalg.matrix_rank(G, tol=1e-3) == 6
        assert grasp.internal_forces.shape == (6,)  # 12 components of force and spin torque, less 6
        posture = np.concatenate([grasp.q_arm, grasp.synergy])
        mounted = robot.mounted(scene.mounting.matrix)
        T = poses_of(mounted.model, mounted.joint_positions(posture))[ring.link]
        tip = T[:3, :3] @ ring.patch.origin + T[:3, 3] - center_of_mass_world(held)
        if task == "sphere":
            assert np.linalg.norm(tip) >= held.shape.radius + ring.patch.radius - 1e-6


def test_contacts_of_all_four_fingers() -> None:
    """With a fourth contact the internal forces are as many as the components of force and torque, less 6."""
    scene, robot = scene_of(ALLEGRO, "sphere"), robot_named(ALLEGRO)
    task = scene.tasks["sphere"]
    content = scene.model_dump()
    radius = content["objects"]["sphere"]["shape"]["radius"]
    points = (*task.desired_contacts, (0.0, radius, 0.0))
    content["tasks"]["sphere"] |= {"pads": None, "desired_contacts": points}
    model = TaskModel(robot, Scene.model_validate(content), "sphere")
    assert check_task(model) == []
    problem = GraspProblem(model, (0, 1, 2, 3))
    rng = np.random.default_rng(0)
    for _ in range(5):
        state = problem.state(rng.uniform(problem.lower, problem.upper))
        assert state.statics.G.shape == (6, 16)
        assert np.linalg.matrix_rank(state.statics.G) == 6
        assert state.statics.E_s.shape == (16, 10)
        np.testing.assert_allclose(state.statics.G @ state.statics.E_s, 0.0, atol=1e-9)
        np.testing.assert_allclose(state.statics.residual, 0.0, atol=1e-9)


def test_a_pad_that_the_hand_does_not_have() -> None:
    scene = scene_of(ALLEGRO, "sphere")
    content = scene.model_dump()
    content["tasks"]["sphere"]["pads"] = ("thumb", "index", "midle")
    with pytest.raises(pinograsp.InputError) as caught:
        TaskModel(robot_named(ALLEGRO), Scene.model_validate(content), "sphere")
    assert (caught.value.file, caught.value.key) == (scene.source, "tasks.sphere.pads[2]")
    assert "xarm7_allegro has no pad 'midle'. Did you mean middle" in str(caught.value)


# ---- robot check


@pytest.mark.parametrize("name", [pytest.param(name, marks=[] if name == "panda" else SLOW) for name in ROBOTS])
def test_robot_check_is_clean(name: str) -> None:
    report = check_robot(name)
    assert [finding for finding in report.findings if finding.level != "ok"] == []
    assert any("pads face each other" in finding.what for finding in report.findings)


# ---- nothing about a robot is in Python

PACKAGE = Path(pinograsp.__file__).parent
DEFAULTS = {("cli/arguments.py", "gen3_2f85")}
"""The robot of commands that are given none."""
EVERYBODYS = {"link1", "link2", "joint1", "joint2", "world", "base", "palm"} | set(TOOL_FRAMES)
"""Attributes of an SRDF and of an MJCF, plain words, and names of tool frames that `robot new` looks for on any arm."""


def words_of(file: Path) -> Iterator[str]:
    """Yield the names and the texts of a Python file, docstrings left out."""
    tree = ast.parse(file.read_text())
    alone = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in alone:
            yield node.value
        yield from (found for key in ("id", "attr", "arg", "name") if isinstance(found := getattr(node, key, 0), str))


def test_no_python_file_knows_a_robot() -> None:
    """Not the name of a shipped robot, arm or hand, nor how that of a joint or link begins: a robot is a folder."""
    parts = {part for name in shipped_robots() for part in name.split("_")} - {"paper"}
    names: set[str] = set()
    for name in shipped_robots():
        tree = read_urdf(load_robot_description(name)).tree
        names |= {element.get("name", "") for tag in ("joint", "link") for element in tree.iterfind(tag)}
    assert {"gen3", "panda", "allegro"} < parts
    assert {"joint_1", "panda_hand", "link_3.0_tip"} < names - EVERYBODYS

    def known(text: str) -> bool:
        words = {word.strip("_.") for pattern in (r"[\w.]+", r"\w+") for word in re.findall(pattern, text)} - EVERYBODYS
        begun = (word for word in words if "_" in word and any(name.startswith(word) for name in names))
        return bool(words & names) or any(begun) or any(part in text.lower() for part in parts)

    files = sorted(PACKAGE.rglob("*.py"))
    found = {(file.relative_to(PACKAGE).as_posix(), text) for file in files for text in words_of(file) if known(text)}
    assert found == DEFAULTS
