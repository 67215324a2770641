"""Fixtures that several test files share."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import coal
import numpy as np
import pinocchio as pin
import pytest
import yaml
from hypothesis import settings
from numpy.typing import NDArray

import pinograsp
from pinograsp import cli
from pinograsp.cli import reporters
from pinograsp.collision.distances import CollisionModel
from pinograsp.collision.scene_world import task_world
from pinograsp.collision.solids import link_bodies
from pinograsp.collision.world import Body, Solid
from pinograsp.descriptions import RobotDescription, Scene
from pinograsp.descriptions.robot import CollisionDescription
from pinograsp.kinematics.robot import Robot
from pinograsp.problem import TaskModel

Array = NDArray[np.float64]
HEAVY = (
    *("clarabel", "coal", "duckdb", "matplotlib", "meshcat", "mujoco", "nlopt", "numba", "pinocchio", "scipy"),
    *("threadpoolctl", "trimesh", "yourdfpy"),
)
"""Libraries that who only reads a result does not load."""

settings.register_profile("pinograsp", deadline=None, derandomize=True, database=None, max_examples=40)
settings.load_profile("pinograsp")


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Start databases of this session, and of processes that it starts, are kept apart from the user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PINOGRASP_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session", autouse=True)
def no_progress() -> Iterator[None]:
    """Commands that run in this process write no line of progress: what they write does not depend on their speed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reporters, "INTERVAL", math.inf)
        yield


@pytest.fixture(scope="session")
def gen3() -> Robot:
    """The shipped arm and gripper, root link at the world's origin."""
    return pinograsp.load_robot("gen3_2f85")


@pytest.fixture(scope="session")
def gen3_hulls(gen3: Robot) -> Robot:
    """The shipped robot with one convex hull for each collision mesh."""
    return Robot(gen3.description.model_copy(update={"collision": CollisionDescription(pieces=1)}))


@pytest.fixture(scope="session")
def paper() -> Robot:
    """The arm with the hand of the paper: composed of two URDFs, one contact parameter a finger."""
    return pinograsp.load_robot("gen3_2f85_paper")


class PlacedSolid(NamedTuple):
    """A solid in the frame of its joint."""

    name: str
    joint: int
    placement: Array
    shape: Any
    center: Array
    radius: float


def link_solids(robot: Robot) -> list[PlacedSolid]:
    """Return the solids of all links in the frames of their joints."""
    return [placed(body, solid) for body in link_bodies(robot) for solid in body.solids]


def placed(body: Body, solid: Solid) -> PlacedSolid:
    """Return a solid of a body in the frame of the body's joint."""
    center = body.pose[:3, :3] @ solid.center + body.pose[:3, 3]
    return PlacedSolid(body.name, body.joint, body.pose @ solid.placement, solid.shape, center, solid.radius)


def collision_model(robot: Robot, scene: Scene, task: str) -> CollisionModel:
    """Return the collision model of a mounted robot at a task."""
    return CollisionModel(robot, task_world(robot, scene, scene.task(task)))


def solids_of(model: CollisionModel) -> list[PlacedSolid]:
    """Return the solids of a collision model; only walls have an infinite radius."""
    parts = zip(model.joints.tolist(), model.placements, model.shapes, strict=True)
    return [
        PlacedSolid("", joint, placement, shape, np.zeros(3), math.inf if isinstance(shape, coal.Halfspace) else 0.0)
        for joint, placement, shape in parts
    ]


def with_patches(robot: Robot, *patches: dict[str, Any]) -> Robot:
    """Return the robot with other surfaces of its pads, one after the other; keys that are not given stay."""
    content = robot.description.model_dump()
    for pad, patch in zip(content["pads"], patches, strict=True):
        frame = {key: pad["patch"][key] for key in ("origin", "normal", "x_axis", "u")}
        pad["patch"] = frame | patch
    return Robot(RobotDescription.model_validate(content))


@pytest.fixture(scope="session")
def curved_gen3(gen3: Robot) -> Robot:
    """The shipped robot with a cylinder along one finger tip and a sphere on the other; both bulge by millimetres."""
    cylinder = {"type": "cylinder", "radius": 0.03, "origin": (0.0046, -0.0008, 0.032), "v": (-0.3, 0.35)}
    sphere = {"type": "sphere", "radius": 0.04, "origin": (-0.0146, 0.0, 0.032), "u": (-0.4, 0.45), "v": (-0.2, 0.25)}
    return with_patches(gen3, cylinder, sphere)


@pytest.fixture(scope="session")
def mixed_toy(toy: Robot) -> Robot:
    """The toy with soft fingers: one contact parameter on the left, on a line, two on the right, on a sphere."""
    line = {"type": "line", "u": (-0.015, 0.01)}
    sphere = {"type": "sphere", "radius": 0.02, "origin": (-0.02, 0.0, 0.02), "u": (-0.5, 0.6), "v": (0.1, 0.5)}
    content = with_patches(toy, line, sphere).description.model_dump()
    for pad in content["pads"]:
        pad["contact"] = {"model": "soft_finger", "torsion_radius": 0.005, "torsional_stiffness": 1.0}
    return Robot(RobotDescription.model_validate(content))


def random_parameters(robot: Robot, rng: np.random.Generator, part: float = 1.0) -> Array:
    """Return contact parameters from the middle part of their ranges, shape (c,)."""
    low, high = robot.parameter_limits.T
    return np.asarray(0.5 * (low + high) + 0.5 * part * (high - low) * rng.uniform(-1.0, 1.0, len(low)))


def differences(function: Callable[[Array], Any], x: Array, step: float) -> Array:
    """Return central differences of an array-valued function, shape (..., v)."""
    return np.stack([np.asarray(function(x + d) - function(x - d)) / (2 * step) for d in step * np.eye(len(x))], -1)


def agree(
    jacobian: Array,
    function: Callable[[Array], Any],
    x: Array,
    floor: float | Array = 1e-2,
    tolerance: float | Array = 1e-5,
) -> None:
    """Compare row by row to a part of the row's largest slope (at least `floor`), with the best of three step sizes.

    The longest step is for rows with rounding errors (V* of 1e9), the shorter for the rounded kink of the balance.
    """
    jacobian = np.atleast_2d(jacobian)
    best = np.full(len(jacobian), np.inf)
    for step in (1e-6, 1e-7, 1e-8):
        numeric = np.atleast_2d(differences(function, x, step))
        assert jacobian.shape == numeric.shape
        relative = np.abs(jacobian - numeric).max(axis=1) / np.maximum(np.abs(numeric).max(axis=1), floor)
        best = np.minimum(best, relative / tolerance)
        if (best <= 1.0).all():
            return
    assert best.max() <= 1.0


def matrix(pose: dict[str, list[float]]) -> Array:
    """Return a pose as Pinocchio makes it."""
    return np.asarray(pin.SE3(pin.rpy.rpyToMatrix(*pose["rpy"]), np.array(pose["position"])).homogeneous)


def poses_of(model: Any, q: Array) -> dict[str, Array]:
    """Return the poses of all links."""
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    bodies = [i for i, frame in enumerate(model.frames) if frame.type == pin.BODY]
    return {model.frames[i].name: np.array(data.oMf[i].homogeneous) for i in bodies}


def alone(xml: str, joints: dict[str, float]) -> dict[str, Array]:
    """Return the poses of the links of a single URDF in its root link; joints that are not given are at zero."""
    model = pin.buildModelFromXML(xml)
    q = pin.neutral(model)
    for name, value in joints.items():
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (math.cos(value), math.sin(value))
    return poses_of(model, q)


@pytest.fixture(scope="session")
def can_scene() -> Scene:
    return pinograsp.load_scene("glovebox_can")


@pytest.fixture(scope="session")
def glovebox() -> Scene:
    return pinograsp.load_scene("glovebox")


@pytest.fixture(scope="session")
def sphere_task(gen3: Robot, glovebox: Scene) -> TaskModel:
    return TaskModel(gen3, glovebox, "sphere")


@pytest.fixture(scope="session")
def paper_task(paper: Robot, glovebox: Scene) -> TaskModel:
    return TaskModel(paper, glovebox, "sphere")


TOY_URDF = """<?xml version="1.0"?>
<robot name="toy">
  <link name="base">
    <collision>
      <origin xyz="0 0 -0.05"/><geometry><box size="0.1 0.1 0.04"/></geometry>
    </collision>
  </link>
  <link name="arm">
    <collision>
      <origin xyz="0 0 0.1"/><geometry><box size="0.04 0.04 0.16"/></geometry>
    </collision>
  </link>
  <link name="left">
    <collision>
      <origin xyz="0.005 0 0.02"/><geometry><box size="0.01 0.02 0.04"/></geometry>
    </collision>
  </link>
  <link name="right">
    <collision>
      <origin xyz="-0.005 0 0.02"/><geometry><box size="0.01 0.02 0.04"/></geometry>
    </collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="1" velocity="1"/>
  </joint>
  <joint name="slide_left" type="prismatic">
    <parent link="arm"/><child link="left"/><origin xyz="0 0 0.2"/><axis xyz="1 0 0"/>
    <limit lower="0.0" upper="0.06" effort="1" velocity="1"/>
  </joint>
  <joint name="slide_right" type="prismatic">
    <parent link="arm"/><child link="right"/><origin xyz="0 0 0.2"/><axis xyz="-1 0 0"/>
    <limit lower="0.0" upper="0.08" effort="1" velocity="1"/>
    <mimic joint="slide_left" multiplier="1.25" offset="0.002"/>
  </joint>
</robot>
"""
"""One arm joint and a parallel jaw of one slider, the other finger mimicking it: two movable degrees."""

TOY_ROBOT: dict[str, Any] = {
    "format": 1,
    "name": "toy",
    "urdf": "toy.urdf",
    "arm": {"joints": ["shoulder"], "wrist": "arm"},
    "hand": {"synergies": [{"joint": "slide_left"}]},
    "pads": [
        {
            "name": side,
            "link": side,
            "patch": {
                "type": "plane",
                "origin": [0.0, 0.0, 0.02],
                "normal": [normal, 0.0, 0.0],
                "x_axis": [0.0, 0.0, 1.0],
                "u": [-0.018, 0.018],
                "v": [-0.008, 0.008],
            },
            "contact": {"model": "hard_finger"},
        }
        for side, normal in (("left", -1.0), ("right", 1.0))
    ],
    "stiffness": {"joint": 100.0, "contact": 10000.0},
}

RobotFactory = Callable[..., Robot]


@pytest.fixture(scope="session")
def make_toy(tmp_path_factory: pytest.TempPathFactory) -> RobotFactory:
    """Return a function that writes and loads the toy robot.

    `urdf` replaces its URDF, `meshes` are copied beside it, further keywords replace keys of its robot file.
    """

    def make(urdf: str = TOY_URDF, meshes: tuple[Path, ...] = (), **changes: Any) -> Robot:
        folder = tmp_path_factory.mktemp("toy")
        for mesh in meshes:
            (folder / mesh.name).write_bytes(mesh.read_bytes())
        (folder / "toy.urdf").write_text(urdf)
        return pinograsp.load_robot(_written(folder / "robot.yaml", TOY_ROBOT | changes))

    return make


@pytest.fixture(scope="session")
def toy(make_toy: RobotFactory) -> Robot:
    return make_toy()


TOY_SCENE: dict[str, Any] = {
    "format": 1,
    "name": "toy_room",
    "enclosure": {"min": [-0.4, -0.3, -0.2], "max": [0.4, 0.3, 0.4]},
    "objects": {"ball": {"shape": {"type": "sphere", "radius": 0.025}, "pose": {"position": [0.0, 0.0, 0.222]}}},
    "tasks": {
        "ball": {
            "object": "ball",
            "desired_contacts": [[0.025, 0.0, 0.0], [-0.025, 0.0, 0.0]],
            "wrench": {"force": [0.0, 0.0, -2.0]},
            "contact": {"friction": 0.9},
        }
    },
}

SceneFactory = Callable[..., Scene]


@pytest.fixture(scope="session")
def make_toy_scene(tmp_path_factory: pytest.TempPathFactory) -> SceneFactory:
    """Return a function that writes and loads the toy's scene, further keywords replacing its keys."""

    def make(**changes: Any) -> Scene:
        file = tmp_path_factory.mktemp("toy_scene") / "scene.yaml"
        return pinograsp.load_scene(_written(file, TOY_SCENE | changes))

    return make


@pytest.fixture(scope="session")
def toy_task(toy: Robot, make_toy_scene: SceneFactory) -> TaskModel:
    return TaskModel(toy, make_toy_scene(), "ball")


@pytest.fixture(scope="session")
def soft_gen3(gen3: Robot, tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """The shipped arm and gripper with soft finger contacts, read from a file of its own."""
    content = yaml.safe_load(gen3.description.source.read_text())
    for pad in content["pads"]:
        pad["contact"] = {"model": "soft_finger", "torsion_radius": 0.005, "torsional_stiffness": 1.0}
    return pinograsp.load_robot(_written(tmp_path_factory.mktemp("soft") / "robot.yaml", content))


def _written(file: Path, content: dict[str, Any]) -> Path:
    file.write_text(yaml.safe_dump(content))
    return file


Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Run:
    """Return a function that runs the command line in tmp_path and gives exit code, output and errors."""
    monkeypatch.chdir(tmp_path)

    def run_once(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["pinograsp", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        captured = capsys.readouterr()
        return int(ended.value.code or 0), captured.out, captured.err

    return run_once
