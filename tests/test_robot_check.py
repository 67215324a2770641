"""`pinograsp robot check`: what it finds wrong or doubtful, and the page with joint sliders."""

from __future__ import annotations

import html
import json
import re
import sys
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest
import trimesh
import yaml
from conftest import TOY_ROBOT, TOY_URDF, Array, Run

from pinograsp import Progress, Robot, cli
from pinograsp.descriptions import urdf
from pinograsp.kinematics.shown_geometry import shown_of
from pinograsp.onboarding.check import RobotReport, check_robot
from pinograsp.visualization.pads import surface
from pinograsp.visualization.robot_page import write_robot_html

Check = Callable[..., RobotReport]


@pytest.fixture
def check(tmp_path: Path) -> Check:
    """Return a function that checks the toy; `urdf` replaces texts of its URDF, other keywords replace keys."""

    def check(urdf: dict[str, str] | None = None, **changes: Any) -> RobotReport:
        return check_robot(write_toy(tmp_path, urdf or {}, **changes))

    return check


def write_toy(folder: Path, urdf: dict[str, str], **changes: Any) -> Path:
    text = TOY_URDF
    for old, new in urdf.items():
        assert old in text
        text = text.replace(old, new)
    (folder / "toy.urdf").write_text(text)
    (folder / "robot.yaml").write_text(yaml.safe_dump(TOY_ROBOT | changes))
    return folder / "robot.yaml"


def pads(left: dict[str, Any], **both: Any) -> list[dict[str, Any]]:
    """Return the toy's pads, the left one's patch changed."""
    first, second = ({**pad, "patch": {**pad["patch"], **both}} for pad in TOY_ROBOT["pads"])
    return [{**first, "patch": {**first["patch"], **left}}, second]


def said(report: RobotReport, level: str) -> list[str]:
    return [finding.what for finding in report.findings if finding.level == level]


# ---- findings


def test_a_report_is_a_record(check: Check) -> None:
    report = check()
    assert report == check()
    assert report != check({'"-1.5" upper="1.5"': '"0" upper="0"'})
    data = json.loads(json.dumps(report.to_json(), allow_nan=False))
    assert data.keys() == {"name", "findings", "links", "faces", "wrong"}
    assert (data["name"], data["wrong"]) == (report.name, False)
    assert [finding["what"] for finding in data["findings"]] == [finding.what for finding in report.findings]
    assert [link["excess"] for link in data["links"]] == [link.excess for link in report.links]


def test_nothing_is_wrong_with_the_toy(check: Check) -> None:
    report = check()
    assert said(report, "wrong") == []
    assert said(report, "doubtful") == []
    assert not report.wrong
    text = "\n".join(said(report, "ok"))
    assert "the wrist, arm, is moved by 1 joint" in text
    assert "synergy slide_left moves 2 joints: slide_left +1, slide_right +1.25" in text
    assert "2 contacts, 2 hard and 0 soft fingers: no torque about the line" in text
    assert "pads face each other, 2.0 to 137.0 mm apart" in text
    assert "pad left lies on left, at most 0.00 mm off" in text
    assert "not every URDF has an SRDF: 3 pairs of neighbours are not checked, nor 1 that" in text
    assert "no self-collision" in text
    assert [(link.link, link.triangles, link.closed, link.pieces) for link in report.links] == [
        (name, 12, True, 1) for name in ("base", "arm", "left", "right")
    ]
    assert all(link.excess == 0.0 for link in report.links)


def test_what_is_wrong_comes_first_and_advice_once(run: Run, tmp_path: Path) -> None:
    """Then what is doubtful, then one line for all that is ok; the page has all of it in the same order."""
    more = ANOTHER_JOINT.replace("</robot>", "") + ANOTHER_JOINT.replace("lid", "flap").replace("hinge", "hinge_2")
    write_toy(tmp_path, {"</robot>": more}, pads=pads({"normal": [1.0, 0.0, 0.0]}))
    code, output, _ = run("robot", "check", ".")
    assert code == 1
    lines = output[: output.index("collision geometry;")].splitlines()
    levels = [line.split(" ", 1)[0] for line in lines if line and not line.startswith(" ")]
    wrong, doubts = levels.count("wrong"), levels.count("doubtful")
    assert levels == ["toy:", *["wrong"] * wrong, *["doubtful"] * doubts, "ok"]
    assert wrong >= 1
    said = " ".join(output.split())
    assert said.count("is neither arm nor hand joint: it stays at 0") == 2
    assert said.count("Add it to arm.joints or hand.synergies") == 1
    fine = len(said_ok := [f for f in check_robot(tmp_path).findings if f.level == "ok"])
    assert lines[-2].split() == f"ok {fine} things looked at, listed on the page and with --json".split()
    text = (tmp_path / "out" / "toy_check.html").read_text()
    assert text.count("Add it to arm.joints or hand.synergies") == 1
    assert all(html.escape(finding.what) in text for finding in said_ok)
    assert text.index("is neither arm nor hand joint") < text.index(f"ok: {fine} things looked at")


ANOTHER_JOINT = """<link name="lid"/><joint name="hinge" type="revolute"><parent link="base"/><child link="lid"/>
<axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>"""
LONG = '<origin xyz="0 0 0.1"/><geometry><box size="0.04 0.04 0.16"/>'
FAR = {'<child link="arm"/><axis xyz="0 1 0"/>': '<child link="arm"/><origin xyz="0 0 200"/><axis xyz="0 1 0"/>'}
LONGER = '<origin xyz="0 0 0.1"/><geometry><box size="0.07 0.04 0.4"/>'


@pytest.mark.parametrize(
    ("urdf", "changes", "level", "words"),
    [
        ({'"-1.5" upper="1.5"': '"0" upper="0"'}, {}, "wrong", "joint shoulder has no usable limits (0 .. 0)"),
        ({'upper="0.06"': 'upper="0"'}, {}, "wrong", "joint slide_left has no usable limits"),
        ({'upper="0.08"': 'upper="0.03"'}, {}, "doubtful", "joints that follow slide_left keep it within 0 .. 0.02"),
        ({'"-1.5" upper="1.5"': '"-99" upper="99"'}, {}, "doubtful", "the limits of shoulder are -99 .. 99"),
        ({"</robot>": ANOTHER_JOINT}, {}, "doubtful", "joint hinge is neither arm nor hand joint: it stays at 0"),
        ({}, {"arm": {"joints": ["sholder"], "wrist": "arm"}}, "wrong", "'sholder' is not in toy.urdf"),
        ({}, {"arm": {"joints": ["shoulder"], "wrist": "base"}}, "doubtful", "shoulder does not move the wrist, base"),
        ({}, {"arm": {"joints": ["shoulder"], "wrist": "left"}}, "doubtful", "the z axis of left is "),
        ({}, {"pads": pads({"normal": [1.0, 0.0, 0.0]})}, "wrong", "pad left: the normal points into left"),
        ({}, {"pads": pads({"origin": [-0.004, 0.0, 0.02]})}, "wrong", "pad left lies outside its link: 4.0 mm off"),
        ({}, {"pads": pads({"u": [-0.018, 0.025]})}, "doubtful", "parts of it are 5.0 mm off the surface of left"),
        ({}, {"pads": pads({"normal": [0.0, 0.0, 1.0], "x_axis": [1.0, 0.0, 0.0]})}, "wrong", "pads never face each"),
        (
            {'<origin xyz="0 0 0.2"/><axis xyz="1 0 0"/>': '<origin xyz="0 0 0.2" rpy="0 0.5 0"/><axis xyz="1 0 0"/>'},
            {},
            "doubtful",
            "nearer than 29 degrees to facing each other",
        ),
        ({'xyz="0 0 -0.05"': 'xyz="0.03 0 0.22"'}, {}, "doubtful", "in mid-range, base and left collide"),
        ({LONG: LONGER}, {"srdf": "none.srdf"}, "wrong", "arm and base are nearer than 5 mm in every posture"),
        ({'<box size="0.1 0.1 0.04"/>': '<box size="100 100 40"/>'}, {}, "doubtful", "link base is 100 m large"),
        (FAR, {}, "doubtful", "joints that are far from their parent links: shoulder (200 m)"),
        ({'<box size="0.1 0.1 0.04"/>': '<mesh filename="a.stl"/>'}, {}, "wrong", "mesh a.stl was not found"),
        (
            {'<link name="base">': '<link name="base"><visual><geometry><mesh filename="a.dae"/></geometry></visual>'},
            {},
            "doubtful",
            "link base is not drawn as it is to be shown: a.dae was not found",
        ),
        (
            {"</robot>": '<link name="cup"><visual><geometry><sphere radius="0.1"/></geometry></visual></link>'
             + ANOTHER_JOINT.replace('<link name="lid"/>', "").replace("lid", "cup")},
            {},
            "doubtful",
            "link cup has no collision geometry",
        ),
    ],
    ids=lambda value: value[:50] if isinstance(value, str) else "",
)  # fmt: skip
def test_what_is_found(
    check: Check, tmp_path: Path, urdf: dict[str, str], changes: dict[str, Any], level: str, words: str
) -> None:
    (tmp_path / "none.srdf").write_text('<robot name="toy"/>')
    report = check(urdf, **changes)
    found = [finding for finding in report.findings if finding.level == level and words in finding.what]
    assert found, report.findings
    assert all(finding.remedy for finding in found)
    assert report.wrong == (level == "wrong" or bool(said(report, "wrong")))


def test_all_joints_without_limits_are_named(check: Check) -> None:
    report = check({'"-1.5" upper="1.5"': '"0" upper="0"', 'upper="0.06"': 'upper="0"'})
    assert [words.split()[1] for words in said(report, "wrong")] == ["shoulder", "slide_left"]
    given = check(
        {'"-1.5" upper="1.5"': '"0" upper="0"', 'upper="0.06"': 'upper="0"'},
        arm=TOY_ROBOT["arm"] | {"limits": {"shoulder": [-1, 1]}},
        hand={"synergies": [{"joint": "slide_left", "limits": [0.0, 0.06]}]},
    )
    assert not given.wrong


def test_whole_turns_with_few_digits_are_no_wide_limits(check: Check) -> None:
    assert said(check({'"-1.5" upper="1.5"': '"-6.2832" upper="6.2832"'}), "doubtful") == []


def test_links_that_collide_in_one_posture_are_one_finding(check: Check) -> None:
    (what,) = (what for what in said(check({'xyz="0 0 -0.05"': 'xyz="0.0 0 0.22"'}), "doubtful") if "at zero" in what)
    assert what.endswith("at zero or, where that is far off, in mid-range, base and left, base and right collide")


def test_limits_in_other_units_are_asked_about(check: Check) -> None:
    report = check({'"-1.5" upper="1.5"': '"-170" upper="170"'})
    told = {f.what: f.remedy or "" for f in report.findings if f.level == "doubtful" and "limits of" in f.what}
    assert "Are they in degrees?" in told["the limits of shoulder are -170 .. 170 rad"]


def test_a_urdf_without_links_is_said(check: Check) -> None:
    report = check({TOY_URDF: '<robot name="x"/>'})
    assert any("has no links" in what for what in said(report, "wrong"))


def test_a_mesh_without_a_file_is_said(check: Check) -> None:
    (what,) = said(check({'<box size="0.1 0.1 0.04"/>': "<mesh/>"}), "wrong")
    assert what.endswith("toy.urdf: link base: a <mesh> names no file")


def test_where_a_mesh_was_looked_for(check: Check, tmp_path: Path) -> None:
    (finding,) = check({'<box size="0.1 0.1 0.04"/>': '<mesh filename="package://parts/a.stl"/>'}).findings
    assert "toy.urdf: link base: mesh package://parts/a.stl was not found" in finding.what
    assert str(tmp_path) in finding.remedy
    assert "cmeel.prefix/share" in finding.remedy


BROKEN = {
    "a mesh": ('<mesh filename="{}"/>', "v.stl", b"no mesh", "cannot be read as STL"),
    "a cut mesh": ('<mesh filename="{}"/>', "v.dae", b"<COLLADA>", "cannot be read as DAE"),
    "a pointer": (
        '<mesh filename="{}"/>',
        "v.stl",
        b"version https://git-lfs.github.com/spec/v1",
        "pointer of Git LFS",
    ),
    "an endless corner": ('<mesh filename="{}"/>', "v.obj", b"v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
    "a mesh of no file": ("<mesh/>", "v.stl", b"", "names no file"),
    "a shape of no size": ("<box/>", "v.stl", b"", "size of a <box> has 0 numbers"),
    "an unknown shape": ('<torus radius="1"/>', "v.stl", b"", "a visual is a <torus>"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_broken_and_only_shown_ends_no_check(
    case: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    shape, name, content, words = BROKEN[case]
    shown = shape.format(name)
    write_toy(tmp_path, {'<link name="base">': f'<link name="base"><visual><geometry>{shown}</geometry></visual>'})
    (tmp_path / name).write_bytes(content)
    report = check_robot(tmp_path / "robot.yaml")
    (finding,) = (finding for finding in report.findings if finding.level != "ok")
    assert finding.level == "doubtful"
    assert finding.what.startswith("link base is not drawn as it is to be shown: ")
    assert words in finding.what
    assert report.robot is not None
    (drawn,) = read_shown(report.robot, "base")
    assert drawn.find("geometry/box") is not None  # as it collides
    write_robot_html(report.robot, tmp_path / "page.html", report.findings)
    assert "urdf_parser" not in capfd.readouterr().err  # which complains of shapes that it does not know


def test_a_texture_that_is_missing_is_said(tmp_path: Path) -> None:
    """The viewer draws a COLLADA file with all of its textures or not at all."""
    visual = '<visual><geometry><mesh filename="v.dae"/></geometry></visual>'
    write_toy(tmp_path, {'<link name="base">': f'<link name="base">{visual}'})
    content = trimesh.creation.box([0.1, 0.1, 0.04]).export(file_type="dae").decode()
    texture = "<library_images><image id='wood'><init_from>wood.png</init_from></image></library_images>"
    (tmp_path / "v.dae").write_text(content.replace("<library_geometries>", texture + "<library_geometries>"))
    report = check_robot(tmp_path / "robot.yaml")
    (what,) = said(report, "doubtful")
    assert what.endswith("v.dae names a texture that was not found, wood.png")
    (tmp_path / "wood.png").write_bytes(b"")
    assert said(check_robot(tmp_path / "robot.yaml"), "doubtful") == []
    assert report.robot is not None
    write_robot_html(report.robot, tmp_path / "page.html")


def read_shown(robot: Robot, name: str) -> list[ET.Element]:
    """Return what is shown of a link."""
    link = robot.urdf.composed.tree.find(f"link[@name='{name}']")
    assert link is not None
    return shown_of(link, robot.description.urdf_file, coal.CachedMeshLoader()).elements


def test_a_joint_at_rest_on_purpose_is_not_doubtful(check: Check) -> None:
    hand = {"synergies": [{"joint": "slide_left"}], "rest": {"hinge": 0.5}}
    assert said(check({"</robot>": ANOTHER_JOINT}, hand=hand), "doubtful") == []


def test_meshes_that_leak(check: Check, tmp_path: Path) -> None:
    """Half the sides of a box: nothing tells inside from outside. A box that lacks a sliver: nobody minds."""
    box = trimesh.creation.box([0.1, 0.1, 0.04])
    box.update_faces(np.arange(12) < 6)
    box.export(tmp_path / "base.stl")
    ball = trimesh.creation.icosphere(4, 0.05)
    ball.update_faces(np.arange(len(ball.faces)) > 0)
    ball.export(tmp_path / "arm.stl")
    report = check(
        {
            '<box size="0.1 0.1 0.04"/>': '<mesh filename="base.stl"/>',
            '<box size="0.04 0.04 0.16"/>': '<mesh filename="arm.stl"/>',
        }
    )
    (leaks,) = (words for words in said(report, "doubtful") if "watertight" in words)
    assert leaks == "the mesh of base is not watertight: inside and outside cannot be told"
    assert [link.closed for link in report.links] == [False, False, True, True]


def test_pieces_that_stand_off_their_mesh(check: Check, tmp_path: Path) -> None:
    """An angle bracket: its hull is 35 mm off in the corner; two pieces fit."""
    corner = [
        trimesh.creation.box(bounds=[[0, 0, 0.02], [0.1, 0.02, 0.04]]),
        trimesh.creation.box(bounds=[[0, 0.02, 0.02], [0.02, 0.1, 0.04]]),
    ]
    trimesh.util.concatenate(corner).export(tmp_path / "arm.stl")
    urdf = {'<box size="0.04 0.04 0.16"/>': '<mesh filename="arm.stl"/>'}
    hull = check(urdf, collision={"pieces": 1})
    (words,) = (words for words in said(hull, "doubtful") if "stand off" in words)
    assert re.match(r"the pieces of arm stand off its mesh by \d+\.\d mm", words)
    (bracket,) = (link for link in hull.links if link.link == "arm")
    assert bracket.pieces == 1
    assert 0.015 < bracket.excess < bracket.most < 0.04
    assert not any("stand off its" in words for words in said(check(urdf), "doubtful"))


def test_progress_of_a_check(tmp_path: Path) -> None:
    seen: list[Progress] = []
    check_robot(write_toy(tmp_path, {}), seen.append)
    pieces = [progress for progress in seen if progress.stage == "convex pieces"]
    assert pieces == [Progress("convex pieces", done, 4) for done in range(4)]


def test_the_urdf_is_read_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """For the check and the page."""
    read: list[str] = []
    parse = urdf.parse
    monkeypatch.setattr(urdf, "parse", lambda file, tag: (read.append(file.name), parse(file, tag))[1])
    report = check_robot(write_toy(tmp_path, {}))
    assert report.robot is not None
    write_robot_html(report.robot, tmp_path / "page.html")
    assert read == ["toy.urdf"]


# ---- the page


def test_command(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["pinograsp", "robot", "check", *arguments])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        return int(ended.value.code or 0), *capsys.readouterr()

    write_toy(tmp_path, {})
    code, output, errors = run("robot.yaml", "--out", "some where")
    assert (code, errors) == (0, "")
    assert "toy: findings" in output
    assert "0 wrong, 0 doubtful, " in output
    assert "written: some where/toy_check.html\n" in output
    assert "<html" in (tmp_path / "some where" / "toy_check.html").read_text()[:1000]
    write_toy(tmp_path, {}, pads=pads({"normal": [1.0, 0.0, 0.0]}))
    code, output, _ = run("robot.yaml")
    assert code == 1
    assert "the normal points into left" in output
    assert "Turn the normal round" in output
    assert (tmp_path / "out" / "toy_check.html").exists()  # to look at
    write_toy(tmp_path, {'"-1.5" upper="1.5"': '"0" upper="0"'})
    (tmp_path / "out" / "toy_check.html").unlink()
    code, output, _ = run("robot.yaml")
    assert code == 1
    assert "written" not in output  # there is no robot to show
    (tmp_path / "robot.yaml").write_text("format: 1")
    code, output, errors = run("robot.yaml")
    assert (code, output) == (2, "")
    assert "robot.yaml:1: urdf: this key is missing" in errors


def page_data(page: str) -> dict[str, Any]:
    """Return what the script of the page knows of the robot."""
    found = re.search(r"^const robot = (\{.*\});$", page, flags=re.MULTILINE)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data


def placed(data: dict[str, Any], posture: Array) -> dict[str, Array]:
    """Return the poses of what is drawn as the page's script computes them."""
    q = np.array(data["B"]) @ posture + data["q0"]
    poses = [np.eye(4)]
    for joint in data["joints"]:
        turn, motion = np.array(joint["turn"]), np.eye(4)
        skew = np.cross(turn, np.eye(3)).T
        angle = q[joint["row"]]
        motion[:3, :3] += np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew
        motion[:3, 3] = angle * np.array(joint["slide"])
        poses.append(poses[joint["parent"]] @ np.reshape(joint["placement"], (4, 4)).T @ motion)
    return {path: poses[joint] @ np.reshape(local, (4, 4)).T for path, joint, local in data["nodes"]}


@pytest.mark.parametrize("name", ["toy", "gen3"])
def test_sliders_move_what_is_drawn(name: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    robot: Robot = request.getfixturevalue(name)
    file = tmp_path / "page.html"
    write_robot_html(robot, file)
    page = file.read_text()
    data = page_data(page)
    for i, joint in enumerate(robot.posture_names):
        slider = re.search(rf'<input type="range" id="slider{i}" min="([^"]*)" max="([^"]*)"', page)
        assert slider
        assert (float(slider[1]), float(slider[2])) == (robot.lower[i], robot.upper[i])
        assert f"<label>{joint}: " in page
    posture = np.random.default_rng(0).uniform(robot.lower, robot.upper)
    model_data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, model_data, robot.joint_positions(posture))
    found = placed(data, posture)
    for number, pad in enumerate(robot.description.pads):
        T = model_data.oMf[robot.model.getFrameId(pad.link, pin.BODY)].homogeneous
        expected = np.column_stack([T[:3, :3] @ pad.patch.rotation, T[:3, :3] @ pad.patch.origin + T[:3, 3]])
        np.testing.assert_allclose(found[f"/meshcat/robot_file/pads/{number}"][:3], expected, atol=1e-9)
    wrist = model_data.oMf[robot.wrist_frame].homogeneous
    np.testing.assert_allclose(found["/meshcat/robot_file/wrist"], wrist, atol=1e-9)
    links = {path.rsplit("/", 1)[1].rsplit("_", 1)[0] for path in found if "/visuals/" in path}
    assert links == ({"base", "arm", "left", "right"} if name == "toy" else links)
    assert len(links) >= 4
    np.testing.assert_allclose(data["postures"]["middle"], 0.5 * (robot.lower + robot.upper))


def test_surfaces_of_pads(curved_gen3: Robot, paper: Robot) -> None:
    """Every corner of what is drawn is as far above the patch as it is lifted off it."""
    for pad in (*curved_gen3.description.pads, *paper.description.pads):
        vertices, faces = surface(pad.patch)
        assert faces.max() == len(vertices) - 1
        kind = pad.patch.type
        heights = {
            "cylinder": lambda p: np.hypot(p[:, 1], p[:, 2]) - pad.patch.radius,  # noqa: B023
            "sphere": lambda p: np.linalg.norm(p, axis=1) - pad.patch.radius,  # noqa: B023
            "line": lambda p: p[:, 2],
        }[kind](vertices)
        np.testing.assert_allclose(heights, 6e-4, atol=1e-12)
