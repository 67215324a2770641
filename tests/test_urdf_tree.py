"""The tree of a URDF, against the verification's own reading of it."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from conftest import Array

import pinograsp
from pinograsp import InputError, Robot
from pinograsp.descriptions.urdf import RobotUrdf, attached, read_urdf
from pinograsp.kinematics.tree import UrdfTree
from pinograsp.verification.kinematics import Kinematics, parsed

ROBOTS = ("gen3_2f85", "panda", "xarm7_allegro")


@pytest.mark.parametrize("name", ROBOTS)
def test_links_are_where_the_verification_has_them(name: str) -> None:
    """Continuous joints far beyond half a turn, mimic joints, links that fixed joints join."""
    robot = pinograsp.load_robot(name)
    tree, kinematics = robot.urdf.tree, independent(robot)
    free = [joint.name for joint in tree.movable if joint.leader is None]
    rng = np.random.default_rng(0)
    for _ in range(5):
        angles = dict(zip(free, rng.uniform(-6.0, 6.0, len(free)).tolist(), strict=True))
        found, expected = tree.poses(angles), kinematics.poses(kinematics.followed(angles))
        assert set(tree.links) == found.keys() == expected.keys()
        for link, T in expected.items():
            np.testing.assert_allclose(found[link], T, atol=1e-12)
    zero, expected = tree.poses({}), kinematics.poses(kinematics.followed({}))
    for link, T in expected.items():
        np.testing.assert_allclose(zero[link], T, atol=1e-12)


@pytest.mark.parametrize("name", ROBOTS)
def test_bodies_and_neighbours(name: str) -> None:
    robot = pinograsp.load_robot(name)
    tree, kinematics = robot.urdf.tree, independent(robot)
    assert {link: tree.body(link) for link in tree.links} == kinematics.body
    pairs = list(combinations(tree.links, 2))
    found = {pair: tree.adjacent(*pair) for pair in pairs}
    assert found == {pair: kinematics.adjacent(*pair) for pair in pairs}
    assert 0 < sum(found.values()) < len(pairs)


def independent(robot: Robot) -> Kinematics:
    file = robot.description.urdf_file
    return Kinematics(parsed(robot.urdf.composed, file), file)


def joint(name: str, kind: str, parent: str, child: str, inside: str = "") -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


LIMIT = '<axis xyz="0 0 1"/><limit lower="-1" upper="2" effort="1" velocity="1"/>'


def tree_of(*joints: str, links: str = "abcde") -> UrdfTree:
    text = "".join(f'<link name="{link}"/>' for link in links) + "".join(joints)
    return UrdfTree(RobotUrdf(ET.fromstring(f'<robot name="r">{text}</robot>'), {}, False), Path("r.urdf"))


def test_who_carries_and_follows_whom() -> None:
    tree = tree_of(
        joint("turn", "continuous", "a", "b", '<axis xyz="0 0 1"/>'),
        joint("weld", "fixed", "b", "c"),
        joint("open", "revolute", "c", "d", LIMIT),
        joint("follow", "revolute", "b", "e", f'<mimic joint="open" multiplier="-2" offset="0.5"/>{LIMIT}'),
    )
    assert tree.links == ["a", "b", "c", "d", "e"]
    assert [j.name for j in tree.movable] == ["turn", "open", "follow"]
    assert [j.name for j in tree.path("d")] == ["turn", "open"]
    assert tree.body_links("b") == ["b", "c"]
    assert [j.name for j in tree.branches("b")] == ["open", "follow"]
    assert [j.name for j in tree.carried("a")] == ["turn", "open", "follow"]
    assert list(tree.outwards("c")) == ["d"]
    assert (tree.joints["turn"].limits, tree.joints["open"].limits) == ((0.0, 0.0), (-1.0, 2.0))
    assert tree.followers("turn") == {}
    assert {name: m.multiplier for name, m in tree.followers("open").items()} == {"follow": -2.0}
    assert tree.adjacent("a", "c")
    assert tree.adjacent("b", "c")
    assert not tree.adjacent("d", "e")
    poses = tree.poses({"turn": math.pi, "open": 0.3, "follow": 99.0})  # a follower has no angle of its own
    np.testing.assert_allclose(poses["d"], rotated(math.pi + 0.3), atol=1e-12)
    np.testing.assert_allclose(poses["e"], rotated(math.pi - 2 * 0.3 + 0.5), atol=1e-12)


def test_a_chain_of_many_links() -> None:
    """Longer than Python calls functions within each other."""
    names = [f"l{number}" for number in range(3000)]
    links = "".join(f'<link name="{name}"/>' for name in names)
    joints = "".join(joint(f"j{inner}", "fixed", outer, inner) for outer, inner in pairwise(names))
    tree = UrdfTree(RobotUrdf(ET.fromstring(f'<robot name="r">{links}{joints}</robot>'), {}, False), Path("r.urdf"))
    assert tree.links == names


def rotated(about_z: float) -> Array:
    T = np.eye(4)
    T[:2, :2] = [[math.cos(about_z), -math.sin(about_z)], [math.sin(about_z), math.cos(about_z)]]
    return T


def test_a_joint_that_mimics_nothing() -> None:
    with pytest.raises(InputError, match="mimics 'opn', which is no joint"):
        tree_of(joint("open", "revolute", "a", "b", f'<mimic joint="opn"/>{LIMIT}'), links="ab")


def test_a_hand_is_attached_to_an_arm_that_was_read_before(paper: Robot) -> None:
    """The same as reading all of it; the arm stays as it is."""
    whole = paper.description
    assert len(whole.attach) == 1
    arm = read_urdf(whole.model_copy(update={"attach": ()}))
    before = arm.xml
    found, expected = attached(arm, whole, 0), read_urdf(whole)
    assert (found.xml, found.disabled, found.complete) == (expected.xml, expected.disabled, expected.complete)
    assert arm.xml == before
    assert len(found.links) > len(arm.links)
