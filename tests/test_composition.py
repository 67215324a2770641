"""Robots of several URDFs: kinematics, names, errors, identity; and the shipped robot with the hand of the paper."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import trimesh
import yaml
from conftest import TOY_ROBOT, Array, alone, collision_model, matrix, poses_of

from pinograsp import InputError, Robot, load_robot
from pinograsp.database.identity import Identity
from pinograsp.descriptions import Scene, load_robot_description
from pinograsp.descriptions.pose import Pose
from pinograsp.descriptions.task import Margins
from pinograsp.descriptions.urdf import read_urdf
from pinograsp.kinematics.batch import BatchKinematics
from pinograsp.kinematics.contacts import contact_kinematics
from pinograsp.kinematics.forward import Configuration, forward
from pinograsp.kinematics.hand_posture import jaw_range
from pinograsp.kinematics.robot import SLIDE_STEP, SLIP_STEP, TURN_STEP
from pinograsp.results.provenance import provenance
from pinograsp.verification.check import Verifier
from pinograsp.verification.kinematics import Kinematics, parsed

BOX = '<geometry><box size="0.04 0.04 0.04"/></geometry>'
LIMIT = 'effort="1" velocity="1"/>'
MATERIAL = '<material name="grey"><color rgba="{} {} {} 1"/></material>'
RAIL_URDF = f"""<?xml version="1.0"?>
<robot name="rail">
  {MATERIAL.format(0.1, 0.1, 0.1)}
  <link name="base"/>
  <link name="carriage"><visual>{BOX}<material name="grey"/></visual><collision>{BOX}</collision></link>
  <joint name="slide" type="prismatic">
    <parent link="base"/><child link="carriage"/><origin xyz="0.1 0.2 0.3" rpy="0.1 0.2 -0.3"/>
    <axis xyz="0.6 0 0.8"/><limit lower="-0.2" upper="0.5" {LIMIT}
  </joint>
  <transmission name="drive"><joint name="slide"/></transmission>
</robot>
"""
ARM_URDF = f"""<?xml version="1.0"?>
<robot name="arm">
  {MATERIAL.format(0.2, 0.2, 0.2)}
  <link name="base"/>
  <link name="upper"><visual>{BOX}<material name="grey"/></visual><collision>{BOX}</collision></link>
  <link name="flange"/>
  <link name="old_tool"><collision>{BOX}</collision></link>
  <link name="old_finger"><collision>{BOX}</collision></link>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.1" rpy="0.3 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" {LIMIT}
  </joint>
  <joint name="end" type="fixed">
    <parent link="upper"/><child link="flange"/><origin xyz="0 0.05 0.3" rpy="0 0.4 0.2"/>
  </joint>
  <joint name="hold" type="fixed"><parent link="flange"/><child link="old_tool"/></joint>
  <joint name="open" type="revolute">
    <parent link="old_tool"/><child link="old_finger"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" {LIMIT}
  </joint>
</robot>
"""
HAND_URDF = f"""<?xml version="1.0"?>
<robot name="hand">
  {MATERIAL.format(0.3, 0.3, 0.3)}
  <link name="base"><collision>{BOX}</collision></link>
  <link name="left"><visual>{BOX}<material name="grey"/></visual><collision>{BOX}</collision></link>
  <link name="right"><collision>{BOX}</collision></link>
  <joint name="open" type="prismatic">
    <parent link="base"/><child link="left"/><origin xyz="0.02 0 0.1"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.05" {LIMIT}
  </joint>
  <joint name="follow" type="prismatic">
    <parent link="base"/><child link="right"/><origin xyz="-0.02 0 0.1"/><axis xyz="-1 0 0"/>
    <limit lower="0" upper="0.07" {LIMIT}
    <mimic joint="open" multiplier="1.25" offset="0.002"/>
  </joint>
</robot>
"""
URDFS = {"rail": RAIL_URDF, "arm": ARM_URDF, "hand": HAND_URDF}
ARM_SRDF = """<robot name="arm">
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="upper" link2="old_tool" reason="Never"/>
</robot>
"""
HAND_SRDF = """<robot name="hand">
  <disable_collisions link1="base" link2="left" reason="Adjacent"/>
  <disable_collisions link1="left" link2="right"/>
</robot>
"""

ON_RAIL = {"position": [0.01, -0.02, 0.03], "rpy": [0.5, -0.2, 1.0]}
ON_ARM = {"position": [0.0, 0.04, 0.02], "rpy": [-0.1, 0.3, 2.0]}
CHAIN: dict[str, Any] = TOY_ROBOT | {
    "name": "chain",
    "urdf": "rail.urdf",
    "attach": [
        {"urdf": "arm.urdf", "to": "carriage", "prefix": "arm_", "leave_out": ["old_tool"], **ON_RAIL},
        {"urdf": "hand.urdf", "to": "arm_flange", "prefix": "hand_", **ON_ARM},
    ],
    "arm": {"joints": ["slide", "arm_turn"], "wrist": "arm_flange"},
    "hand": {"synergies": [{"joint": "hand_open"}]},
    "pads": [pad | {"link": f"hand_{pad['link']}"} for pad in TOY_ROBOT["pads"]],
}
"""A rail, an arm on its carriage in the place of its old tool a hand: three URDFs whose names clash."""

Write = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Return a function that writes the chain, keys of its robot file and parts of its URDFs replaced."""

    def write(
        urdfs: dict[str, str] | None = None,
        attach: dict[int, dict[str, Any]] | None = None,
        parts: list[dict[str, Any]] = CHAIN["attach"],
        **keys: Any,
    ) -> Path:
        for name, text in (URDFS | (urdfs or {})).items():
            (tmp_path / f"{name}.urdf").write_text(text)
        (tmp_path / "arm.srdf").write_text(ARM_SRDF)
        (tmp_path / "hand.srdf").write_text(HAND_SRDF)
        content = CHAIN | {"attach": [part | (attach or {}).get(i, {}) for i, part in enumerate(parts)]}
        file = tmp_path / "robot.yaml"
        file.write_text(yaml.safe_dump(content | keys))
        return file

    return write


@pytest.fixture
def chain(write: Write) -> Robot:
    return load_robot(write())


def verified_poses(robot: Robot, joints: dict[str, float]) -> dict[str, Array]:
    """Return the link poses that the verification computes."""
    description = robot.description
    kinematics = Kinematics(parsed(read_urdf(description), description.urdf_file), Path("x")).mounted(
        robot.T_world_root
    )
    return kinematics.poses(joints)


def random_postures(robot: Robot, count: int) -> Array:
    return np.random.default_rng(0).uniform(robot.lower, robot.upper, (count, robot.posture_size))


def at(robot: Robot, posture: Array) -> Configuration:
    return forward(robot, robot.model.createData(), posture)


# ---- kinematics


def test_a_chain_of_three_is_the_product_of_its_parts(chain: Robot) -> None:
    mounting = Pose(position=(0.3, -0.1, 0.2), rpy=(0.4, -1.1, 2.0)).matrix
    robot = chain.mounted(mounting)
    assert set(robot.joint_names) == {"slide", "arm_turn", "hand_open", "hand_follow"}
    for posture in random_postures(robot, 5):
        slide, turn, opening = posture.tolist()
        rail = alone(RAIL_URDF, {"slide": slide})
        arm = alone(ARM_URDF, {"turn": turn})
        hand = alone(HAND_URDF, {"open": opening, "follow": 1.25 * opening + 0.002})
        on_rail = mounting @ rail["carriage"] @ matrix(ON_RAIL)
        on_arm = on_rail @ arm["flange"] @ matrix(ON_ARM)
        expected = {name: mounting @ T for name, T in rail.items()}
        expected |= {f"arm_{name}": on_rail @ T for name, T in arm.items() if not name.startswith("old")}
        expected |= {f"hand_{name}": on_arm @ T for name, T in hand.items()}
        assert set(robot.urdf.links) == set(expected)
        for found in (
            poses_of(robot.model, robot.joint_positions(posture)),
            verified_poses(robot, robot.joints_by_name(posture)),
        ):
            for link, T in expected.items():
                np.testing.assert_allclose(found[link], T, atol=1e-9, err_msg=link)


def test_planning_with_a_rail(chain: Robot) -> None:
    """The rail is an arm joint: limits, units, starts' kinematics, contacts and their derivatives."""
    np.testing.assert_allclose(chain.lower, [-0.2, -2.0, 0.0])
    np.testing.assert_allclose(chain.upper, [0.5, 2.0, 0.05])
    assert chain.arm_size == 2
    np.testing.assert_allclose(chain.step_units, [SLIDE_STEP, TURN_STEP, SLIDE_STEP, *[SLIP_STEP] * 4])
    postures = random_postures(chain, 10)
    postures[:, 2] = 0.01
    batch = BatchKinematics(chain, np.array([0.01]))
    positions, approaches = batch.wrist(batch.frames(postures[:, :2]))
    for posture, position, approach in zip(postures, positions, approaches, strict=True):
        wrist = poses_of(chain.model, chain.joint_positions(posture))["arm_flange"]
        np.testing.assert_allclose(position, wrist[:3, 3], atol=1e-12)
        np.testing.assert_allclose(approach, wrist[:3, 2], atol=1e-12)
        contacts = contact_kinematics(at(chain, posture), np.zeros(4))
        for k, step in enumerate(1e-6 * np.eye(3)):
            plus, minus = (contact_kinematics(at(chain, posture + s), np.zeros(4)) for s in (step, -step))
            np.testing.assert_allclose(contacts.d_points[:, :, k], (plus.points - minus.points) / 2e-6, atol=1e-8)
            np.testing.assert_allclose(contacts.d_normals[:, :, k], (plus.normals - minus.normals) / 2e-6, atol=1e-8)


def test_collision_bodies_of_every_part_are_there(chain: Robot, make_toy_scene: Any) -> None:
    verifier = Verifier(chain.description, make_toy_scene(), "ball")
    assert set(verifier._robot.meshes) == {"carriage", "arm_upper", "hand_base", "hand_left", "hand_right"}
    geometry = pin.buildGeomFromUrdfString(chain.model, chain.urdf.xml, pin.COLLISION)
    links = {chain.model.frames[item.parentFrame].name for item in geometry.geometryObjects}
    assert links == set(verifier._robot.meshes)


# ---- names, subtrees, files


def test_prefix_is_put_before_links_joints_mimics_and_pairs(write: Write) -> None:
    attach = {0: {"srdf": "arm.srdf"}, 1: {"srdf": "hand.srdf"}}
    robot = load_robot(write(attach=attach))
    assert set(robot.urdf.movable) == {"slide", "arm_turn", "hand_open", "hand_follow"}
    assert robot.urdf.mimics["hand_follow"].leader == "hand_open"
    assert robot.joints_by_name(np.array([0.1, 0.2, 0.04]))["hand_follow"] == pytest.approx(0.052)
    composed = read_urdf(robot.description)
    reasons = {tuple(sorted(pair)): set(reasons) for pair, reasons in composed.disabled.items()}
    assert reasons == {
        ("arm_base", "arm_upper"): {"adjacent"},
        ("hand_base", "hand_left"): {"adjacent"},
        ("hand_left", "hand_right"): {""},
    }
    assert robot.urdf.disabled_pairs == set(composed.disabled)
    assert not composed.complete  # the rail has none
    rail = {"srdf": "rail.srdf"}
    (robot.description.source.parent / "rail.srdf").write_text("<robot/>")
    assert read_urdf(load_robot_description(write(attach=attach, **rail))).complete


def test_pairs_of_an_srdf_mean_the_links_of_its_own_urdf(write: Write) -> None:
    """A hand without prefix, cut out of a robot that has a link with the name of one of this robot.

    Any other name in an SRDF means a link of the robot.
    """
    pairs = [("upper", "palm"), ("upper", "left"), ("left", "right"), ("carriage", "left")]
    srdf = "".join(f'<disable_collisions link1="{a}" link2="{b}" reason="User"/>' for a, b in pairs)
    old_arm = '<link name="upper"/><joint name="old" type="fixed"><parent link="upper"/><child link="palm"/></joint>'
    hand = HAND_URDF.replace('"base"', '"palm"').replace("</robot>", f"{old_arm}</robot>")
    own = {"rail": RAIL_URDF, "arm": ARM_URDF.replace('"base"', '"arm_base"'), "hand": hand}
    attach = {0: {"prefix": ""}, 1: {"prefix": "", "to": "flange", "root": "palm", "srdf": "user.srdf"}}
    keys: dict[str, Any] = {"arm": {"joints": ["slide", "turn"], "wrist": "flange"}, "pads": TOY_ROBOT["pads"]}
    file = write(own, attach, **keys, hand={"synergies": [{"joint": "open"}]})
    (file.parent / "user.srdf").write_text(f"<robot>{srdf}</robot>")
    disabled = read_urdf(load_robot_description(file)).disabled
    assert {tuple(sorted(pair)) for pair in disabled} == {("left", "right"), ("carriage", "left")}


def test_names_without_prefix_stay(write: Write) -> None:
    """Also those of materials, which parts without prefix may share."""
    own = {name: text.replace('"base"', f'"{name}_base"') for name, text in URDFS.items()}
    keys: dict[str, Any] = {"arm": {"joints": ["slide", "turn"], "wrist": "flange"}, "pads": TOY_ROBOT["pads"]}
    attach = {0: {"prefix": ""}, 1: {"prefix": "", "to": "flange"}}
    robot = load_robot(write(own, attach, **keys, hand={"synergies": [{"joint": "open"}]}))
    assert set(robot.joint_names) == {"slide", "turn", "open", "follow"}
    model = pin.buildModelFromXML(read_urdf(robot.description).xml)
    visuals = pin.buildGeomFromUrdfString(model, read_urdf(robot.description).xml, pin.VISUAL)
    colors = {model.frames[item.parentFrame].name: item.meshColor[0] for item in visuals.geometryObjects}
    assert colors == pytest.approx({"carriage": 0.1, "upper": 0.2, "left": 0.3})


def test_two_of_the_same(write: Write) -> None:
    """One URDF attached twice, to two links, with two prefixes."""
    more = [*CHAIN["attach"], CHAIN["attach"][1] | {"prefix": "spare_", "to": "carriage"}]
    robot = load_robot(write(parts=more))
    assert {"hand_open", "hand_follow", "spare_open", "spare_follow"} < set(robot.joint_names)
    assert robot.urdf.mimics["spare_follow"].leader == "spare_open"


def test_root_and_leave_out(write: Write) -> None:
    """The rail's file has only its carriage, the arm's begins above its base, in front of its flange."""
    attach = {0: {"root": "upper", "leave_out": ["old_finger", "old_tool"]}}
    description = load_robot_description(write(attach=attach, root="carriage"))
    composed = read_urdf(description)
    assert composed.root == "carriage"
    assert composed.links == ("carriage", "arm_upper", "arm_flange", "hand_base", "hand_left", "hand_right")
    joints = {joint.get("name"): joint.get("type") for joint in composed.tree.findall("joint")}
    assert {name for name, kind in joints.items() if kind != "fixed"} == {"hand_open", "hand_follow"}
    for order in (["old_tool", "old_finger"], ["old_tool"]):  # the finger goes with the tool
        again = load_robot_description(write(attach={0: {"root": "upper", "leave_out": order}}, root="carriage"))
        assert read_urdf(again).xml == composed.xml


def test_a_frame_of_a_link_is_found_though_a_joint_has_its_name(write: Write) -> None:
    """As after a prefix that makes them alike."""
    rail = RAIL_URDF.replace('"slide"', '"arm_flange"')
    robot = load_robot(write({"rail": rail}, arm={"joints": ["arm_flange", "arm_turn"], "wrist": "arm_flange"}))
    posture = random_postures(robot, 1)[0]
    batch = BatchKinematics(robot, posture[2:])
    position, _ = batch.wrist(batch.frames(posture[None, :2]))
    np.testing.assert_allclose(position[0], verified_poses(robot, robot.joints_by_name(posture))["arm_flange"][:3, 3])


def test_meshes_are_looked_up_beside_the_urdf_that_names_them(
    write: Write, tmp_path: Path, make_toy_scene: Any
) -> None:
    """The hand in a folder of its own, its mesh beside it; another mesh of the same address beside the arm."""
    for folder, size in (("parts", 0.02), (".", 0.08)):
        (tmp_path / folder / "meshes").mkdir(parents=True)
        trimesh.creation.box((size,) * 3).export(tmp_path / folder / "meshes" / "solid.stl")
    mesh = '<geometry><mesh filename="meshes/solid.stl"/></geometry>'
    meshed = {name: text.replace(BOX, mesh) for name, text in URDFS.items()}
    file = write(meshed, {1: {"urdf": "parts/hand.urdf"}})
    shutil.move(tmp_path / "hand.urdf", tmp_path / "parts" / "hand.urdf")
    robot = load_robot(file)
    extents = {}
    for link, mesh in Verifier(robot.description, make_toy_scene(), "ball")._robot.meshes.items():
        extents[link] = float(np.ptp(mesh.hull, axis=0).max())
    assert extents == pytest.approx(
        {"carriage": 0.08, "arm_upper": 0.08, "hand_base": 0.02, "hand_left": 0.02, "hand_right": 0.02}
    )
    assert {Path(mesh) for mesh in robot.urdf.meshes} == {
        tmp_path / "meshes" / "solid.stl",
        tmp_path / "parts" / "meshes" / "solid.stl",
    }


def test_files_of_a_composed_robot(write: Write, tmp_path: Path) -> None:
    description = load_robot_description(write(attach={1: {"srdf": "hand.srdf"}}))
    names = {"urdf": "rail.urdf", "attach[0].urdf": "arm.urdf"}
    names |= {"attach[1].urdf": "hand.urdf", "attach[1].srdf": "hand.srdf"}
    assert description.files == {key: tmp_path / name for key, name in names.items()}


# ---- refusals


def refused(file: Path) -> InputError:
    with pytest.raises(InputError) as caught:
        load_robot(file)
    assert "\n" not in str(caught.value)
    return caught.value


@pytest.mark.parametrize(
    ("keys", "attach", "key", "words"),
    [
        ({}, {0: {"to": "cariage"}}, "attach[0].to", "'cariage' is not in rail.urdf. Did you mean carriage"),
        ({}, {1: {"to": "flange"}}, "attach[1].to", "Did you mean arm_flange"),
        ({}, {0: {"to": "hand_base"}}, "attach[0].to", "'hand_base'"),  # only what is there so far
        ({}, {0: {"root": "uper"}}, "attach[0].root", "'uper' is not in arm.urdf. Did you mean upper"),
        ({"root": "cariage"}, {}, "root", "'cariage' is not in rail.urdf. Did you mean carriage"),
        ({"leave_out": ["base", "bse"]}, {}, "leave_out[1]", "'bse' is not in rail.urdf. Did you mean base"),
        ({}, {0: {"leave_out": ["old_tool", "old_toll"]}}, "attach[0].leave_out[1]", "Did you mean old_tool"),
        ({}, {1: {"leave_out": ["hand_left"]}}, "attach[1].leave_out[0]", "'hand_left' is not in hand.urdf"),
        ({}, {0: {"prefix": ""}}, "attach[0].prefix", "1 link names are in the robot already, the first is 'base'"),
        ({}, {1: {"prefix": "arm_"}}, "attach[1].prefix", "Give a prefix, or another one"),
        ({}, {1: {"urdf": "hnd.urdf"}}, "attach[1].urdf", "hnd.urdf was not found. Looked in"),
        ({}, {1: {"srdf": "hnd.srdf"}}, "attach[1].srdf", "hnd.srdf was not found. Looked in"),
        ({}, {0: {"urdf": "package://nowhere/arm.urdf"}}, "attach[0].urdf", "was not found"),
        ({"leave_out": ["base"]}, {}, "leave_out", "nothing is left"),
        ({}, {1: {"leave_out": ["base"]}}, "attach[1].leave_out", "nothing is left"),
        ({}, {1: {"root": "left", "leave_out": ["left"]}}, "attach[1].leave_out", "nothing is left"),
        ({}, {1: {"too": "carriage"}}, "attach[1].too", "unknown key. Did you mean to"),
        ({}, {1: {"rpy": [0.0, 0.0]}}, "attach[1].rpy", "3 values are wanted (2 given)"),
        ({"arm": CHAIN["arm"] | {"wrist": "flange"}}, {}, "arm.wrist", "is not in rail.urdf or arm.urdf or hand.urdf"),
    ],
    ids=str,
)
def test_composition_that_is_refused(
    keys: dict[str, Any], attach: dict[int, dict[str, Any]], key: str, words: str, write: Write, tmp_path: Path
) -> None:
    error = refused(write(attach=attach, **keys))
    assert (error.file, error.key) == (tmp_path / "robot.yaml", key)
    assert words in str(error)


def test_joint_names_clash(write: Write, tmp_path: Path) -> None:
    """Links do not, a joint does."""
    hand = HAND_URDF.replace('"open"', '"turn"').replace('"base"', '"palm"')
    error = refused(write({"hand": hand}, {1: {"prefix": "arm_"}}))
    assert (error.file, error.key) == (tmp_path / "robot.yaml", "attach[1].prefix")
    assert "1 joint names are in the robot already, the first is 'arm_turn'" in str(error)


@pytest.mark.parametrize(
    ("part", "old", "new", "key", "words"),
    [
        ("hand", BOX, '<geometry><mesh filename="finger.stl"/></geometry>', "link base", "finger.stl was not found"),
        ("arm", '<child link="flange"/>', '<child link="flnge"/>', "end", "its child 'flnge' is no link"),
        ("arm", "</robot>", "", None, "not valid XML"),
        ("hand", '<mimic joint="open"', '<mimic joint="opn"', "follow", "mimics 'opn', which is no joint"),
        ("hand", 'type="prismatic"', 'type="planar"', "open", "a planar joint is moved by nothing"),
    ],
    ids=str,
)
def test_errors_name_the_attached_file(
    part: str, old: str, new: str, key: str | None, words: str, write: Write, tmp_path: Path
) -> None:
    assert old in URDFS[part]
    error = refused(write({part: URDFS[part].replace(old, new)}))
    assert (error.file, error.key) == (tmp_path / f"{part}.urdf", key)
    assert words in str(error)
    if "was not found" in words:
        assert f"Looked in {tmp_path}" in str(error)


def test_a_joint_that_mimics_one_that_is_left_out(write: Write, tmp_path: Path) -> None:
    error = refused(write(attach={1: {"leave_out": ["left"]}}))
    assert (error.file, error.key) == (tmp_path / "hand.urdf", "follow")
    assert "mimics 'open', which is no joint" in str(error)


def test_visual_meshes_may_be_missing(write: Write) -> None:
    """In planning and checking; only who draws needs them."""
    hand = HAND_URDF.replace("<visual>" + BOX, '<visual><geometry><mesh filename="nowhere.dae"/></geometry>')
    assert hand != HAND_URDF
    load_robot(write({"hand": hand}))


# ---- which robot it is


@pytest.mark.parametrize(
    ("attach", "keys", "differs"),
    [
        ({0: {"position": [0.01, -0.02, 0.031]}}, {}, ["composition"]),
        ({1: {"rpy": [-0.1, 0.3, 2.1]}}, {}, ["composition"]),
        ({1: {"to": "carriage"}}, {}, ["composition"]),
        ({0: {"leave_out": []}}, {}, ["composition"]),
        ({0: {"use_visual": True}}, {}, ["composition"]),
        ({1: {"srdf": "hand.srdf"}}, {}, ["files"]),
        ({}, {"stiffness": {"joint": 1.0, "contact": 2.0}}, None),
    ],
    ids=str,
)
def test_another_composition_is_another_robot(
    attach: dict[int, dict[str, Any]],
    keys: dict[str, Any],
    differs: list[str] | None,
    write: Write,
    make_toy_scene: Any,
) -> None:
    """For a start database, and in what a result records."""
    scene = make_toy_scene()

    def identity(file: Path) -> tuple[Identity, dict[str, str]]:
        robot = load_robot(file)
        return Identity.of(robot, scene, Margins()), provenance(robot.description, scene, robot.files)["sha256"]

    before, hashes = identity(write())
    assert identity(write()) == (before, hashes)
    after, other = identity(write(attach=attach, **keys))
    assert hashes["robot"] != other["robot"]
    if differs is None:
        assert after == before
    else:
        [difference] = before.differences(after)
        assert difference.split("different: ")[1].rstrip(")").split(", ") == differs
        assert Identity.from_json(after.to_json()) == after


def test_another_attached_file_is_another_robot(write: Write, make_toy_scene: Any) -> None:
    scene, found = make_toy_scene(), []
    for text in (HAND_URDF, HAND_URDF.replace('xyz="0.02 0 0.1"', 'xyz="0.02 0 0.11"')):
        robot = load_robot(write({"hand": text}))
        found.append(
            (Identity.of(robot, scene, Margins()), provenance(robot.description, scene, robot.files)["sha256"])
        )
    (before, hashes), (after, other) = found
    assert {key for key in hashes if hashes[key] != other[key]} == {"attach[1].urdf"}
    [difference] = before.differences(after)
    assert "different: files)" in difference


# ---- which pairs are checked


def test_adjacent_links_without_srdf_and_pairs_with_one(write: Write, make_toy_scene: Any) -> None:
    """What an SRDF excuses stays excused if another part has none; there neighbours are, and postures tell the rest."""
    ball = make_toy_scene()

    def pairs(**attach: dict[str, Any]) -> tuple[set[frozenset[str]], set[frozenset[str]]]:
        numbered = {int(key[1:]): value for key, value in attach.items()}
        verifier = Verifier(load_robot_description(write(attach=numbered)), ball, "ball")
        return names(verifier._clearances.enabled), names(verifier._clearances.never)

    def names(pairs: list[Any]) -> set[frozenset[str]]:
        return {frozenset((a.link, b.link)) for a, b in pairs}

    fingers = frozenset(("hand_left", "hand_right"))
    palm = {frozenset(("hand_base", f"hand_{side}")) for side in ("left", "right")}
    enabled, never = pairs()
    assert fingers not in enabled
    assert never == {fingers}  # they come near each other, but touch in no posture of the hand
    assert not palm & enabled
    enabled, never = pairs(_1={"srdf": "hand.srdf"})
    assert never == {fingers}  # no reason given: a claim
    assert not palm & enabled
    assert fingers not in enabled


# ---- the robot of the paper


def hand_joints(sigma: float) -> dict[str, float]:
    """Eq. (19)."""
    names = ("left_shoulder", "left_knuckle", "right_shoulder", "right_knuckle")
    angles = (sigma, math.pi / 2 - sigma, math.pi - sigma, sigma - math.pi / 2)
    return dict(zip(names, angles, strict=True))


def test_paper_robot_is_the_product_of_arm_and_hand(paper: Robot) -> None:
    description = paper.description
    arm_xml, hand_xml = (file.read_text() for key, file in description.files.items() if key.endswith("urdf"))
    model = pin.buildModelFromXML(arm_xml)
    assert description.files["attach[0].urdf"].parent == description.source.parent  # beside the robot file
    assert description.urdf.startswith("package://")
    mounting = np.eye(4)
    mounting[2, 3] = 0.055
    for posture in random_postures(paper, 5):
        joints = paper.joints_by_name(posture)
        arm = alone(arm_xml, {name: joints[name] for name in description.arm.joints})
        hand = alone(hand_xml, hand_joints(posture[7]))
        expected = {name: T for name, T in arm.items() if "robotiq" not in name}
        expected |= {name: arm["end_effector_link"] @ mounting @ T for name, T in hand.items()}
        assert set(paper.urdf.links) == set(expected)
        for found in (poses_of(paper.model, paper.joint_positions(posture)), verified_poses(paper, joints)):
            for link, T in expected.items():
                np.testing.assert_allclose(found[link], T, atol=1e-9, err_msg=link)
    assert any("robotiq" in frame.name for frame in model.frames)  # what was left out


def test_verification_places_the_paper_robot_as_the_model_does(paper: Robot, glovebox: Scene) -> None:
    robot = paper.mounted(glovebox.mounting.matrix)
    kinematics = Verifier(paper.description, glovebox, "sphere")._kinematics
    for posture in random_postures(robot, 10):
        placed = poses_of(robot.model, robot.joint_positions(posture))
        for link, T in kinematics.poses(robot.joints_by_name(posture)).items():
            np.testing.assert_allclose(T, placed[link], atol=1e-9, err_msg=link)


@pytest.mark.paper
def test_paper_robot_has_the_limits_of_section_4_1(paper: Robot) -> None:
    """And one contact parameter a finger, from the tip inwards, (20)."""
    upper = [6.283, 2.094, 6.283, 2.443, 6.283, 1.919, 6.283]
    np.testing.assert_array_equal(paper.lower, [*(-value for value in upper), 1.570])
    np.testing.assert_array_equal(paper.upper, [*upper, 2.119])
    np.testing.assert_array_equal(paper.parameter_limits, [[-0.0437, 0.0]] * 2)
    stiffness = paper.description.stiffness
    assert (stiffness.joint, stiffness.contact) == (100.0, 10000.0)


@pytest.mark.paper
@pytest.mark.parametrize("sigma", np.linspace(1.570, 2.119, 8))
def test_gap_and_directions_of_the_paper_hand(paper: Robot, sigma: float) -> None:
    """Eq. (19): the gap is 25.2 - 2 * 57.3 cos(sigma) mm, and the distal phalanges stay parallel."""
    posture = np.array([*random_postures(paper, 1)[0, :7], sigma])
    joints = paper.joints_by_name(posture)
    assert {name: joints[name] for name in hand_joints(sigma)} == pytest.approx(hand_joints(sigma))
    for depth in (0.0, -0.02, -0.0437):
        contacts = contact_kinematics(at(paper, posture), np.full(2, depth))
        wrist = poses_of(paper.model, paper.joint_positions(posture))["end_effector_link"]
        apart = (contacts.points[1] - contacts.points[0]) @ wrist[:3, :3]
        gap = 25.2 - 2 * 57.3 * math.cos(sigma)
        np.testing.assert_allclose(1e3 * apart, [0.0, gap, 0.0], atol=1e-6)  # along y of the wrist
        np.testing.assert_allclose(contacts.normals @ wrist[:3, :3], [[0, 1, 0], [0, -1, 0]], atol=1e-9)
        # Along the finger, towards the tip: the approach direction of both.
        along = contacts.d_points[[0, 1], :, paper.posture_size + np.arange(2)]
        np.testing.assert_allclose(along @ wrist[:3, :3], [[0, 0, 1]] * 2, atol=1e-9)
        tip = (contacts.points[0] - wrist[:3, 3]) @ wrist[:3, 2]
        assert tip == pytest.approx(0.055 + 0.0573 * math.sin(sigma) + 0.0437 + depth, abs=1e-9)


@pytest.mark.paper
def test_stroke_and_synergy_of_the_paper_hand(paper: Robot) -> None:
    """The jaw takes the paper's sphere (r 37.3 mm) and can (r 42.3 mm); S has the signs of eq. (19)."""
    jaw = jaw_range(paper)
    assert jaw is not None
    assert 1e3 * jaw[1] == pytest.approx(25.2 - 2 * 57.3 * math.cos(2.119), abs=1e-9)
    assert 2 * 42.3 < 1e3 * jaw[1] < 85.0
    hand = [paper.joint_names[i] for i in paper.hand_joints]
    signs = dict(zip(hand, paper.synergies[:, 0], strict=True))
    assert signs == {"left_shoulder": 1.0, "left_knuckle": -1.0, "right_shoulder": -1.0, "right_knuckle": 1.0}


def test_faces_of_the_paper_hand_carry_the_contact_lines(paper: Robot, glovebox: Scene) -> None:
    """The line of a finger is the middle of its phalanx's inner face, which no part of the phalanx stands out of.

    So contact at the pad keeps the phalanx off the object, and there is no distance between the two.
    """
    meshes = Verifier(paper.description, glovebox, "sphere")._robot.meshes
    for pad in paper.description.pads:
        local = (meshes[pad.link].hull - pad.patch.origin) @ pad.patch.rotation
        low, high = local.min(axis=0), local.max(axis=0)
        np.testing.assert_allclose([low[0], high[0]], pad.patch.u, atol=1e-9)
        np.testing.assert_allclose(low[1], -high[1], atol=1e-9)
        assert high[2] == pytest.approx(0.0, abs=1e-9)
    pairs = collision_model(paper, glovebox, "sphere").pairs
    against_object = {pair.link for pair in pairs if pair.kind == "object clearance"}
    assert "left_proximal" in against_object
    assert not against_object & {pad.link for pad in paper.description.pads}
