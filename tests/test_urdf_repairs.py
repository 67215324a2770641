"""Parts of a URDF that do not matter are passed over and said; joints are held; capsules and soft limits count."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import jaws
import numpy as np
import pytest
import yaml
from conftest import Run
from jaws import arm, box, joint, limit, link, parallel_jaw, solid

import pinograsp
from pinograsp import InputError, Robot
from pinograsp.disk import write_whole
from pinograsp.kinematics.collision_elements import link_elements
from pinograsp.onboarding.new import new_robot_file
from pinograsp.verification.robot import read_robot


def written(folder: Path, urdf: str) -> Path:
    """Write a URDF and the robot file of the parallel jaw's arm, as `robot new` makes it of one without oddities."""
    (folder / "arm.urdf").write_text(arm(parallel_jaw()))
    write_whole(folder / "robot.yaml", new_robot_file(folder / "arm.urdf", folder / "robot.yaml").text)
    (folder / "arm.urdf").write_text(urdf)
    return folder / "robot.yaml"


def with_keys(file: Path, **keys: Any) -> Path:
    file.write_text(f"{file.read_text()}\n{yaml.safe_dump(keys)}")
    return file


def poses(robot: Robot) -> dict[str, Any]:
    """Return the poses of all links with joints in mid-range, as the verification has them; they are the planner's."""
    angles = robot.joints_by_name(0.5 * (robot.lower + robot.upper))
    kinematics = read_robot(robot.description).kinematics
    found, own = kinematics.poses(kinematics.followed(angles)), robot.urdf.tree.poses(angles)
    assert found.keys() == own.keys()
    for name, T in found.items():
        np.testing.assert_allclose(T, own[name], atol=1e-12)
    return found


PLACEHOLDERS = {
    "a box of no size": ('<link name="palm">', f'<link name="palm">{box("0 0 0", "0 0 0")}', "<box> of link palm"),
    "a ball of no size": (
        '<link name="l6">',
        f'<link name="l6">{solid("0 0 0", """<sphere radius="0.0"/>""")}',
        "<sphere> of link l6 without size",
    ),
    "a collision without geometry": (
        '<link name="palm">',
        '<link name="palm"><collision><origin xyz="0 0 0"/></collision>',
        "<collision> of link palm without geometry",
    ),
    "a mimic at a fixed joint": (
        '<joint name="mount" type="fixed">',
        '<joint name="mount" type="fixed"><mimic joint="slide_l"/>',
        "<mimic> of the fixed joint mount",
    ),
    "limits without effort and velocity": (' effort="20" velocity="1"', "", None),
    "a robot without name": ('<robot name="little">', "<robot>", None),
    "a prefix that stands for nothing": (
        '<link name="palm">',
        '<link name="palm" xacro:if="1"><gazebo:material/>',
        "2 names with a prefix that stands for nothing",
    ),
    "blank lines before the declaration": (
        '<robot name="little">',
        '\n <?xml version="1.0"?><robot name="little">',
        None,
    ),
    "a colour that is none": (
        '<link name="palm">',
        '<material name="m"><color rgba="nan 0 0 255"/></material><link name="palm"><visual><geometry>'
        '<box size="1 1 1"/></geometry><material name="m"/></visual>',
        None,
    ),
    "a second mimic": (
        '<mimic joint="slide_l"',
        '<mimic joint="slide_l"/><mimic xyz="1 0 0"/><mimic joint="slide_l" multiplier="5"',
        "a second <mimic> of <joint> slide_r",
    ),
    "a second axis": (
        '<joint name="a1" type="revolute">',
        '<joint name="a1" type="revolute"><axis xyz="0 0 1"/>',
        "a second <axis> of <joint> a1",
    ),
    "a second shape": ("</geometry>", '<sphere radius="3"/></geometry>', "a second <sphere> of <geometry>"),
    "a type in other letters": ('name="a1" type="revolute"', 'name="a1" type="Revolute"', "of a1, taken as revolute"),
}


@pytest.mark.parametrize(("old", "new", "remark"), PLACEHOLDERS.values(), ids=PLACEHOLDERS)
def test_what_does_not_matter_is_passed_over(
    old: str, new: str, remark: str | None, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """The robot is the one without it, for both readers, can be drawn, and the check says what was passed over."""
    plain = pinograsp.load_robot(written(tmp_path, arm(parallel_jaw())))
    wanted, elements = poses(plain), link_elements(plain.urdf.composed, plain.description.urdf_file)
    assert old in arm(parallel_jaw())
    robot = pinograsp.load_robot(written(tmp_path, arm(parallel_jaw()).replace(old, new)))
    found = poses(robot)
    for name, T in wanted.items():
        np.testing.assert_allclose(found[name], T, atol=1e-12)
    again = link_elements(robot.urdf.composed, robot.description.urdf_file)
    assert [(e.link, e.kind, e.size) for e in again] == [(e.link, e.kind, e.size) for e in elements]
    assert read_robot(robot.description).meshes.keys() == {e.link for e in elements}
    pinograsp.visualization.write_robot_html(robot, tmp_path / "page.html")
    assert "urdf_parser" not in capfd.readouterr().err
    said = [what for what in robot.urdf.composed.remarks if remark is not None and remark in what]
    assert (len(said), len(robot.urdf.composed.remarks)) == ((0, 0) if remark is None else (1, 1))


def test_the_check_says_what_was_passed_over(tmp_path: Path) -> None:
    urdf = arm(parallel_jaw()).replace('<link name="palm">', f'<link name="palm">{box("0 0 0", "0 0 0")}')
    report = pinograsp.check_robot(written(tmp_path, urdf))
    assert ("ok", "passed over in the URDF: <box> of link palm without size") in [
        (finding.level, finding.what) for finding in report.findings
    ]


def test_a_plate_without_thickness_is_refused(tmp_path: Path) -> None:
    """It could touch something: only points and lines are placeholders."""
    urdf = arm(parallel_jaw()).replace('<link name="palm">', f'<link name="palm">{box("0 0 0", "0.1 0.1 0")}')
    with pytest.raises(InputError, match="link palm: the size of a <box> is not positive"):
        link_elements(pinograsp.load_robot(written(tmp_path, urdf)).urdf.composed, tmp_path / "arm.urdf")


@pytest.mark.parametrize(
    ("sizes", "words"),
    [('radius="0.1"', "radius 0.1 and length 0"), ('radius="-1" length="1"', "radius -1 and length 1")],
)
def test_a_capsule_without_sizes_of_one_is_refused_where_it_collides(sizes: str, words: str, tmp_path: Path) -> None:
    capsule = f"<capsule {sizes}/>"
    collides, shown = (solid("0 0 0", capsule, tag) for tag in ("collision", "visual"))
    urdf = arm(parallel_jaw())
    with pytest.raises(InputError, match=f"link palm: a <capsule> has {words}"):
        pinograsp.load_robot(written(tmp_path, urdf.replace('<link name="palm">', f'<link name="palm">{collides}')))
    file = written(tmp_path, urdf.replace('<link name="palm">', f'<link name="palm">{shown}'))
    (finding,) = (finding for finding in pinograsp.check_robot(file).findings if finding.level != "ok")
    assert finding.what == "link palm is not drawn as it is to be shown: a visual is a <capsule>"


@pytest.mark.parametrize("tag", ["xacro:macro", "xacro:if"])
def test_macros_with_an_unbound_prefix_are_xacro_still(tag: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is xacro, not URDF"):
        pinograsp.load_robot(written(tmp_path, arm(parallel_jaw(), more=f"<{tag}/>")))


def test_a_capsule_is_a_cylinder_between_two_balls(tmp_path: Path) -> None:
    """Its length is the cylinder's. Turned by 90 degrees about x, its z axis is -y of the link."""
    capsule = '<collision><origin xyz="0.1 0.2 0.3" rpy="1.5707963267948966 0 0"/><geometry><capsule {}/></geometry>'
    text = f'<link name="palm">{capsule.format("""radius="0.02" length="0.1" """)}</collision>'
    robot = pinograsp.load_robot(written(tmp_path, arm(parallel_jaw()).replace('<link name="palm">', text)))
    parts = [e for e in link_elements(robot.urdf.composed, tmp_path / "arm.urdf") if e.link == "palm"][:3]
    assert [(part.kind, part.size) for part in parts] == [("cylinder", (0.02, 0.1)), *[("sphere", (0.02,))] * 2]
    np.testing.assert_allclose(parts[0].origin[:3, 2], [0.0, -1.0, 0.0], atol=1e-12)
    places = sorted(part.origin[:3, 3].tolist() for part in parts)
    np.testing.assert_allclose(places, [[0.1, 0.15, 0.3], [0.1, 0.2, 0.3], [0.1, 0.25, 0.3]], atol=1e-12)
    vertices = read_robot(robot.description).meshes["palm"].vertices
    assert vertices[:, 1].max() == pytest.approx(0.27, abs=2e-4)
    assert not robot.urdf.composed.remarks
    flat = text.replace('length="0.1"', 'length="0"')
    with pytest.raises(InputError, match=r"arm\.urdf: link palm: a <capsule> has radius 0.02 and length 0"):
        pinograsp.load_robot(written(tmp_path, arm(parallel_jaw()).replace('<link name="palm">', flat)))


# ---- joints that are held

LOOSE = link("world") + joint("float", "floating", "world", "base", "0 0 0.5")


def test_a_floating_joint_is_cut_off_or_held(tmp_path: Path) -> None:
    file = written(tmp_path, arm(parallel_jaw(), more=LOOSE))
    with pytest.raises(InputError) as error:
        pinograsp.load_robot(file)
    assert error.value.key == "float"
    assert "a floating joint is moved by nothing. Hold it where its origin is, hold: {float: 0.0}, or" in str(
        error.value
    )
    text = file.read_text()
    cut = pinograsp.load_robot(with_keys(file, root="base"))
    assert cut.urdf.tree.root == "base"
    file.write_text(text)
    held = pinograsp.load_robot(with_keys(file, hold={"float": 0.0}))
    np.testing.assert_allclose(poses(held)["base"][:3, 3], [0.0, 0.0, 0.5], atol=1e-15)
    file.write_text(text)
    with pytest.raises(
        InputError, match="float: a floating joint can only be held where its origin is, at 0, not at 1"
    ):
        pinograsp.load_robot(with_keys(file, hold={"float": 1.0}))


def test_robot_new_holds_what_floats(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(arm(parallel_jaw(), more=LOOSE))
    write_whole(tmp_path / "robot.yaml", new_robot_file(tmp_path / "arm.urdf", tmp_path / "robot.yaml").text)
    assert "hold: {float: 0.0}    # CHECK" in (tmp_path / "robot.yaml").read_text()
    assert pinograsp.load_robot(tmp_path).description.arm.joints == tuple(f"a{i}" for i in range(1, 7))


FOLLOWS = '<mimic joint="rail" multiplier="2" offset="0.1"/>'
RAIL = (
    link("world")
    + joint("rail", "prismatic", "world", "car", "0 0.1 0", "0 3 4", limit(-1, 1))
    + link("car")
    + joint("turn", "revolute", "car", "base", "0 0 0.2", "0 0 2", limit(-1, 1) + FOLLOWS)
)


def test_held_joints_are_where_they_would_be_moved_to(tmp_path: Path) -> None:
    """A rail at 0.25 m along (0, 3/5, 4/5), and what follows it at 2 * 0.25 + 0.1 rad about z."""
    robot = pinograsp.load_robot(with_keys(written(tmp_path, arm(parallel_jaw(), more=RAIL)), hold={"rail": 0.25}))
    assert not {"rail", "turn"} & robot.urdf.movable.keys()
    T = poses(robot)["base"]
    np.testing.assert_allclose(T[:3, 3], [0.0, 0.1 + 0.15, 0.2 + 0.2], atol=1e-12)
    np.testing.assert_allclose(T[:3, 0], [math.cos(0.6), math.sin(0.6), 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("hold", "key", "words"),
    [
        ({"rial": 0.0}, "hold.rial", "joint 'rial' is not in arm.urdf. Did you mean rail"),
        ({"turn": 0.0}, "hold.turn", "joint 'turn' mimics 'rail'. Hold 'rail' instead"),
    ],
)
def test_joints_that_cannot_be_held(hold: dict[str, float], key: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        pinograsp.load_robot(with_keys(written(tmp_path, arm(parallel_jaw(), more=RAIL)), hold=hold))
    assert error.value.key == key
    assert words in str(error.value)


# ---- soft limits

SOFT = '<safety_controller k_position="x" {}/>'
ENDS = {
    "both": ('soft_lower_limit="0.005" soft_upper_limit="0.03"', (0.005, 0.03)),
    "one": ('soft_upper_limit="0.03"', (0.0, 0.03)),
    "none": ("", (0.0, 0.04)),
    "wider ones": ('soft_lower_limit="-1" soft_upper_limit="1"', (0.0, 0.04)),
    "zeros": ('soft_lower_limit="0" soft_upper_limit="0"', (0.0, 0.04)),
}


@pytest.mark.parametrize(("soft", "limits"), ENDS.values(), ids=ENDS)
def test_soft_limits_count_within_hard_ones(soft: str, limits: tuple[float, float], tmp_path: Path) -> None:
    file = written(tmp_path, arm(parallel_jaw(left=SOFT.format(soft))))
    robot = pinograsp.load_robot(file)
    assert (robot.lower[-1], robot.upper[-1]) == limits
    assert robot.urdf.tree.joints["slide_l"].limits == limits
    assert read_robot(robot.description).limits["slide_l"] == limits
    report = pinograsp.check_robot(file)
    said = [(finding.level, finding.what) for finding in report.findings if "soft limits" in finding.what]
    used = "soft limits of <safety_controller> are kept: slide_l"
    assert said == {
        "both": [("ok", f"{used} 0.005 .. 0.03")],
        "one": [("ok", f"{used} 0 .. 0.03")],
        "zeros": [("doubtful", "soft limits of slide_l leave nothing to move in, and are not kept")],
    }.get(next(name for name, case in ENDS.items() if case[0] == soft), [])


# ---- geometry for show


def test_what_is_shown_can_stand_for_collision_geometry(run: Run, tmp_path: Path) -> None:
    shown = arm(parallel_jaw()).replace("collision>", "visual>")
    (tmp_path / "arm.urdf").write_text(shown)
    code, _, errors = run("robot", "new", "arm.urdf", "--out", "r")
    assert code == 2
    assert "arm.urdf: --use-visual: no link has collision geometry. Set it, and links without collide as" in errors
    assert run("robot", "new", "arm.urdf", "--out", "r", "--use-visual")[0] == 0
    robot = pinograsp.load_robot(tmp_path / "r")
    (tmp_path / "arm.urdf").write_text(arm(parallel_jaw()))
    write_whole(
        tmp_path / "p" / "robot.yaml", new_robot_file(tmp_path / "arm.urdf", tmp_path / "p" / "robot.yaml").text
    )
    plain = pinograsp.load_robot(tmp_path / "p")
    assert robot.description.pads == plain.description.pads
    assert read_robot(robot.description).meshes.keys() == read_robot(plain.description).meshes.keys()


def test_a_hand_that_is_only_shown(tmp_path: Path) -> None:
    fingers = jaws.link("finger_l", box("0 0.005 0.03", "0.02 0.01 0.06"))
    urdf = arm(parallel_jaw())
    for finger in (fingers, fingers.replace("finger_l", "finger_r").replace("0 0.005", "0 -0.005")):
        assert finger in urdf
        urdf = urdf.replace(finger, finger.replace("collision>", "visual>"))
    (tmp_path / "arm.urdf").write_text(urdf)
    with pytest.raises(InputError, match="use_visual: no link of the hand has collision geometry"):
        new_robot_file(tmp_path / "arm.urdf", tmp_path / "robot.yaml")
    draft = new_robot_file(tmp_path / "arm.urdf", tmp_path / "robot.yaml", use_visual=True)
    assert draft.pads == ("finger_l", "finger_r")
