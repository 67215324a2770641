"""Numbers of a URDF: one check for all of them, before either of the two readers sees one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from conftest import TOY_ROBOT, TOY_URDF

import pinograsp
from pinograsp import InputError
from pinograsp.descriptions import load_robot_description
from pinograsp.descriptions.urdf import read_urdf
from pinograsp.onboarding.check import check_robot
from pinograsp.verification.kinematics import Kinematics, parsed


def written(folder: Path, *changes: tuple[str, str], **keys: object) -> Path:
    text = TOY_URDF
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "toy.urdf").write_text(text)
    (folder / "robot.yaml").write_text(yaml.safe_dump(TOY_ROBOT | keys))
    return folder / "robot.yaml"


BAD = {
    "nan": "'nan' is not a number",
    "0 0 nan": "'nan' is not a number",
    "0 0 -inf": "'-inf' is not a number",
    "0 1_0 0": "'1_0' is not a number",
    "0 0x1 0": "'0x1' is not a number",
    "1,0,0": "'1,0,0' is not a number",
    "": "has 0 numbers, not 3",
    "0 1": "has 2 numbers, not 3",
    "0 0 1 0": "has 4 numbers, not 3",
    "0 0 1e16": "1e+16 is too large",
    "0 0 1e999": "inf is too large",
}


@pytest.mark.parametrize("text", BAD)
@pytest.mark.parametrize("where", ["origin", "turn", "axis", "collision", "size", "scale"])
def test_vectors_of_three_finite_numbers_are_wanted(where: str, text: str, tmp_path: Path) -> None:
    """The right line names joint or link, attribute, and what is wrong with it."""
    axis, box = '<axis xyz="0 1 0"/>', '<box size="0.1 0.1 0.04"/>'
    mesh = f'<visual><geometry><mesh filename="a.stl" scale="{text}"/></geometry></visual>'
    changes, key = {
        "origin": ((axis, f'{axis}<origin xyz="{text}"/>'), "xyz of <origin>"),
        "turn": ((axis, f'{axis}<origin rpy="{text}"/>'), "rpy of <origin>"),
        "axis": ((axis, f'<axis xyz="{text}"/>'), "xyz of <axis>"),
        "collision": (('<origin xyz="0 0 -0.05"/>', f'<origin xyz="{text}"/>'), "xyz of <origin>"),
        "size": ((box, f'<box size="{text}"/>'), "size of <box>"),
        "scale": (("</collision>", f"</collision>{mesh}"), "scale of <mesh>"),
    }[where]
    file = written(tmp_path, changes)
    with pytest.raises(InputError) as caught:
        pinograsp.load_robot(file)
    words = str(caught.value)
    assert str(tmp_path / "toy.urdf") in words and key in words and BAD[text] in words, words
    assert words.split(key)[0].split(": ")[1].split()[0] in {"joint", "link"}
    with pytest.raises(InputError, match=r"toy\.urdf"):  # the reading that the verification begins with
        read_urdf(load_robot_description(file))


def test_an_axis_of_no_length_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"joint \w+: the axis has no length"):
        pinograsp.load_robot(written(tmp_path, ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0.0"/>')))


@pytest.mark.parametrize("text", ["nan", "1 2", "", "wide"])
def test_limits_and_factors_are_numbers(text: str, tmp_path: Path) -> None:
    for old, new in (('lower="-1.5"', f'lower="{text}"'), ('multiplier="1.25"', f'multiplier="{text}"')):
        with pytest.raises(InputError, match=r"toy.urdf: joint \w+: (lower of <limit>|multiplier of <mimic>)"):
            pinograsp.load_robot(written(tmp_path, (old, new)))


@pytest.mark.parametrize("limit", ["1e16", "inf", "INF", "infinity", "1e999"])
def test_limits_that_bound_nothing_are_no_limits(limit: str, tmp_path: Path) -> None:
    """Refused with the joint, unless the robot file has others; a new robot file has those of whole turns."""
    wide = ('lower="-1.5" upper="1.5"', f'lower="-{limit}" upper="{limit}"')
    file = written(tmp_path, wide)
    with pytest.raises(InputError, match=r"arm.limits: joint 'shoulder' has no usable limits"):
        pinograsp.load_robot(file)
    assert [finding.level for finding in check_robot(file).findings] == ["wrong"]
    assert "joint shoulder has no usable limits" in check_robot(file).findings[0].what
    draft = pinograsp.new_robot_file(tmp_path / "toy.urdf", file)
    turns = yaml.safe_load(draft.text)["arm"]["limits"]["shoulder"]
    np.testing.assert_allclose(turns, [-2 * np.pi, 2 * np.pi])
    arm = TOY_ROBOT["arm"] | {"limits": {"shoulder": [-1.0, 2.0]}}
    robot = pinograsp.load_robot(written(tmp_path, wide, arm=arm))
    assert (robot.lower[0], robot.upper[0]) == (-1.0, 2.0)


def test_a_follower_that_leaves_nothing_to_move_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        pinograsp.load_robot(written(tmp_path, ('multiplier="1.25" offset="0.002"', 'multiplier="-1.25"')))
    assert "slide_left to 0 .. " in str(caught.value) and "slide_right to -" in str(caught.value)


def test_numbers_that_readers_take_differently_are_written_alike(tmp_path: Path) -> None:
    """Numbers below the smallest of C's, which Pinocchio refuses, are 0; spaces and signs are as they may be."""
    robot = pinograsp.load_robot(
        written(tmp_path, ('<origin xyz="0 0 0.2"/>', '<origin xyz=" 1e-400  +.0\n 2E-1 " rpy="-0. 4e-320 0"/>'))
    )
    expected = np.eye(4)
    expected[2, 3] = 0.2
    np.testing.assert_array_equal(robot.urdf.tree.poses({})["left"], expected)


def test_what_nothing_asks_for_stops_nothing(tmp_path: Path) -> None:
    """Masses, damping, effort and velocity of whatever kind: both readers place the links as before."""
    plain = pinograsp.load_robot(written(tmp_path))
    other = tmp_path / "other"
    other.mkdir()
    spoiled = pinograsp.load_robot(
        written(
            other,
            ('<link name="arm">', '<link name="arm"><inertial><mass value="heavy"/><inertia ixx="nan"/></inertial>'),
            (
                '<axis xyz="0 1 0"/>',
                '<axis xyz="0 1 0"/><dynamics damping="nan" friction=""/><calibration rising="x"/>',
            ),
            ('effort="1" velocity="1"', 'effort="much" velocity=""'),
        )
    )
    for angle in (0.0, 0.7):
        expected, found = (robot.urdf.tree.poses({"shoulder": angle}) for robot in (plain, spoiled))
        file = spoiled.description.urdf_file
        kinematics = Kinematics(parsed(spoiled.urdf.composed, file), file)
        independent = kinematics.poses(kinematics.followed({"shoulder": angle}))
        for link, T in expected.items():
            np.testing.assert_array_equal(found[link], T)
            np.testing.assert_allclose(independent[link], T, atol=1e-12)


@pytest.mark.parametrize("encoding", ["foo", "utf-99", "rot13"])
def test_an_encoding_that_there_is_not(encoding: str, tmp_path: Path) -> None:
    file = written(tmp_path)
    (tmp_path / "toy.urdf").write_text(f'<?xml version="1.0" encoding="{encoding}"?>{TOY_URDF}')
    with pytest.raises(InputError, match=r"toy\.urdf: is not valid XML"):
        pinograsp.load_robot(file)


@pytest.mark.parametrize("named", ["", 'name=""'], ids=["none", "empty"])
@pytest.mark.parametrize("what", ["joint", "link"])
def test_links_and_joints_have_names(what: str, named: str, tmp_path: Path) -> None:
    """Pinocchio says only that there is no valid URDF."""
    file = written(tmp_path, ("</robot>", f"<{what} {named}/></robot>"))
    with pytest.raises(
        InputError, match=rf"toy\.urdf: {what} number \d has no name\. Every <{what}> of a URDF has one"
    ):
        pinograsp.load_robot(file)
