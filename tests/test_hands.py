"""Hands of several kinds, from `robot new` over `robot check` to a plan: a fixed finger, coupled jaws, many fingers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from jaws import FIXED_FINGER, MANY_FINGERS, MOUNT, THUMB, arm, box, joint, limit, link, parallel_jaw

import pinograsp
from pinograsp import InputError, Scene
from pinograsp.database import build, sampling
from pinograsp.disk import write_whole
from pinograsp.onboarding.new import new_robot_file

ARM = tuple(f"a{i}" for i in range(1, 7))


def new(folder: Path, hand: str) -> tuple[pinograsp.Draft, Path]:
    """Write URDF and robot file of the arm with a hand."""
    (folder / "arm.urdf").write_text(arm(hand))
    draft = new_robot_file(folder / "arm.urdf", folder / "robot.yaml")
    write_whole(folder / "robot.yaml", draft.text)
    return draft, folder / "robot.yaml"


def doubtful(file: Path) -> list[pinograsp.Finding]:
    report = pinograsp.check_robot(file)
    assert not report.wrong
    return [finding for finding in report.findings if finding.level == "doubtful"]


def can(radius: float) -> Scene:
    shape = {"type": "cylinder", "radius": radius, "height": 0.1}
    return Scene(
        name="room",
        enclosure={"min": (-0.8, -0.8, 0.0), "max": (0.8, 0.8, 1.3)},
        objects={"can": {"shape": shape, "pose": {"position": (0.45, 0.1, 0.3)}}},
        tasks={"can": {"object": "can", "wrench": {"force": (0.0, 0.0, -2.0)}, "contact": {"friction": 0.8}}},
    )


# ---- a fixed finger

SLIDING = (
    link("palm", box("0 0 0.015", "0.05 0.1 0.03"), box("0 -0.045 0.08", "0.02 0.01 0.1"))
    + MOUNT
    + link("jaw", box("0 0.005 0.045", "0.02 0.01 0.09"))
    + joint("close", "prismatic", "palm", "jaw", "0 -0.04 0.04", "0 1 0", limit(0, 0.08))
)


@pytest.mark.parametrize(("hand", "model"), [(FIXED_FINGER, "soft_finger"), (SLIDING, "hard_finger")])
def test_the_jaw_of_a_fixed_finger_is_no_arm_joint(hand: str, model: str, tmp_path: Path) -> None:
    """The pads are the face of the fixed finger, 100 x 20 mm at y = -40 mm, and that of the moving one, 90 x 20 mm."""
    draft, file = new(tmp_path, hand)
    assert (draft.arm, draft.hand, draft.pads) == (ARM, ("close",), ("palm", "jaw"))
    np.testing.assert_allclose(draft.pad_sizes, [[0.1, 0.02], [0.09, 0.02]], atol=1e-9)
    robot = pinograsp.load_robot(file)
    fixed, moving = robot.description.pads
    np.testing.assert_allclose(fixed.patch.origin, [0.0, -0.04, 0.08], atol=1e-9)
    np.testing.assert_allclose(fixed.patch.normal, [0.0, 1.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(moving.patch.origin, [0.0, 0.0, 0.045], atol=1e-9)
    np.testing.assert_allclose(moving.patch.normal, [0.0, -1.0, 0.0], atol=1e-9)
    assert {fixed.contact.model, moving.contact.model} == {model}
    assert doubtful(file) == []


def test_a_fixed_finger_plans(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (build, sampling):
        monkeypatch.setattr(module, "DRAWS", 4096)
    robot, scene = pinograsp.load_robot(new(tmp_path, FIXED_FINGER)[1]), can(0.034)
    with pinograsp.build_database(robot, scene, tmp_path / "room.duckdb", size=60, workers=1) as database:
        result = pinograsp.plan(robot, scene, "can", starts=6, workers=1, database=database)
    assert result.verified >= 4
    assert result.refuted == 0
    assert {contact.pad for contact in result.grasps[0].contacts} == {"palm", "jaw"}


def test_hard_fingers_that_turn_against_each_other_are_doubtful(tmp_path: Path) -> None:
    _, file = new(tmp_path, FIXED_FINGER)
    content = yaml.safe_load(file.read_text())
    for pad in content["pads"]:
        pad["contact"] = {"model": "hard_finger"}
    file.write_text(yaml.safe_dump(content))
    assert [finding.what[:45] for finding in doubtful(file)] == ["the pads do not stay parallel, and are hard f"]


def test_a_pad_that_nothing_closes_on_is_refused(tmp_path: Path) -> None:
    """On the link that carries the moving finger a pad may stay still, farther inwards it may not."""
    _, file = new(tmp_path, FIXED_FINGER)
    content = yaml.safe_load(file.read_text())
    content["pads"][0]["link"] = "l6"  # of one body with the palm
    file.write_text(yaml.safe_dump(content))
    pinograsp.load_robot(file)
    content["pads"][0]["link"] = "l5"
    file.write_text(yaml.safe_dump(content))
    with pytest.raises(InputError, match=r"pads\[0\]\.link: link 'l5' is not moved by the hand"):
        pinograsp.load_robot(file)


def test_an_arm_whose_last_link_turns_has_no_jaw(tmp_path: Path) -> None:
    """Its last joint, about the arm's axis, keeps flat faces at their distance."""
    flange = link("flange", box("0 0 0.03", "0.08 0.08 0.02")) + joint(
        "a7", "revolute", "l6", "flange", "0 0 0.03", "0 0 1", limit(-3, 3)
    )
    with pytest.raises(InputError, match="no fingers were found: none branch off flange, after 7 joints"):
        new(tmp_path, flange)


# ---- coupled jaws

COUPLED = {
    "alike": (parallel_jaw(mimic=""), 1.0, None),
    "along one axis": (parallel_jaw(mimic="", right="0 1 0", ends=limit(-0.04, 0)), -1.0, None),
    "10 mm apart when closed": (parallel_jaw(mimic="", right="0 1 0", ends=limit(-0.05, -0.01)), -1.0, -0.01),
}


@pytest.mark.parametrize(("hand", "factor", "rest"), COUPLED.values(), ids=COUPLED)
def test_jaws_that_look_coupled_are_one_synergy(hand: str, factor: float, rest: float | None, tmp_path: Path) -> None:
    """They close together; the line in the comment undoes it, and then it is doubtful."""
    draft, file = new(tmp_path, hand)
    text = file.read_text()
    content = yaml.safe_load(text)
    assert content["hand"]["synergies"] == [{"name": "close", "joints": {"slide_l": 1.0, "slide_r": factor}}]
    assert content["hand"].get("rest") == (None if rest is None else {"slide_r": rest})
    assert "slide_l, slide_r move two fingers alike, and no <mimic> couples them" in draft.coupled
    assert draft.coupled in draft.summary()
    robot = pinograsp.load_robot(file)
    np.testing.assert_allclose([robot.lower[-1], robot.upper[-1]], [0.0, 0.04], atol=1e-12)
    assert doubtful(file) == []
    lines = [line.replace("  # synergies:", "  synergies:") for line in text.splitlines()]
    left_out = ("  synergies: [{name: close", "  rest:", "    slide_r:")
    file.write_text("\n".join(line for line in lines if not line.startswith(left_out)))
    assert pinograsp.load_robot(file).posture_names == (*ARM, "slide_l", "slide_r")
    (finding,) = doubtful(file)
    assert finding.what == "slide_l, slide_r move two fingers alike, and no <mimic> couples them"
    assert f"hand.synergies: [{{name: close, joints: {{slide_l: 1.0, slide_r: {factor}}}}}]" in finding.remedy


@pytest.mark.parametrize(
    "hand",
    [
        parallel_jaw(),
        parallel_jaw(mimic="", ends=limit(0, 0.03)),
        parallel_jaw(mimic="", right="0 0 -1"),
    ],
    ids=["a mimic couples them", "ranges differ", "ways differ"],
)
def test_other_jaws_do_not_look_coupled(hand: str, tmp_path: Path) -> None:
    assert new(tmp_path, hand)[0].coupled == ""


# ---- many fingers


def test_a_thumb_closes_on_the_fingers(tmp_path: Path) -> None:
    """Pads are the insides of the outer phalanges, the thumb's first; sides that face each other over 5 mm are none."""
    draft, file = new(tmp_path, MANY_FINGERS)
    assert draft.pads[0] == "thumb_2"
    assert set(draft.pads[1:]) == {"index_2", "middle_2", "ring_2"}
    pads = {pad.link: pad for pad in pinograsp.load_robot(file).description.pads}
    for name, pad in pads.items():
        inward = 1.0 if name == "thumb_2" else -1.0
        np.testing.assert_allclose(pad.patch.normal, [0.0, inward, 0.0], atol=1e-9)
        np.testing.assert_allclose(pad.patch.origin, [0.0, 0.006 * inward, 0.0235], atol=1e-9)
    assert "# CHECK: the first is of the thumb" in draft.text


def test_fingers_side_by_side_have_no_pads(tmp_path: Path) -> None:
    """Without the thumb: their sides keep their distance, and their insides look the same way."""
    hand = MANY_FINGERS.removesuffix(THUMB)
    assert new(tmp_path, hand)[0].pads == ()


# ---- no pads yet


def test_a_file_without_pads_shows_the_faces_of_its_hand(tmp_path: Path) -> None:
    """What is shown of a face is a pad: written into the file it gives the robot."""
    _, file = new(tmp_path, parallel_jaw())
    pads = yaml.safe_load(file.read_text())["pads"]
    start = file.read_text().index("pads:")
    head, tail = file.read_text()[:start], file.read_text()[file.read_text().index("stiffness:") :]
    file.write_text(f"{head}pads: []\n{tail}")
    report = pinograsp.check_robot(file)
    assert [finding.what for finding in report.findings if finding.level == "wrong"] == [
        f"{file}: pads: a hand holds with two pads or more, not with 0"
    ]
    assert report.robot is not None
    assert {face.link for face in report.faces} == {"l6", "palm", "finger_l", "finger_r"}
    faces = {face.link: face for face in report.faces if face.axes[1, 2] == (-1.0 if face.link == "finger_l" else 1.0)}
    np.testing.assert_allclose(faces["finger_l"].sides, [0.06, 0.02], atol=1e-9)
    page = tmp_path / "page.html"
    pinograsp.visualization.write_robot_html(report.robot, page, report.findings, report.faces)
    for number, face in enumerate(report.faces, 1):
        assert f"&nbsp;{number} {face.link}, " in page.read_text()
    assert page.read_text().count("<pre>") == len(report.faces)
    assert all(face.pad in page.read_text() for face in report.faces)
    written = "\n".join(faces[link].pad for link in ("finger_l", "finger_r"))
    file.write_text(f"{head}pads:\n{written}\n{tail}")
    found = yaml.safe_load(file.read_text())["pads"]
    assert [{**pad, "name": pad["link"]} for pad in found] == pads
    assert not pinograsp.check_robot(file).wrong
    with pytest.raises(InputError, match=r"pads: a hand holds with two pads or more, not with 1"):
        file.write_text(f"{head}pads:\n{faces['finger_l'].pad}\n{tail}")
        pinograsp.load_robot(file)
    assert pinograsp.check_robot(file).faces
