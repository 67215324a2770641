"""Names of any kind: written so that they are read as they are, and never part of a path that leads elsewhere."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest
import yaml
from conftest import TOY_ROBOT, TOY_SCENE, Run
from hypothesis import example, given, settings
from hypothesis import strategies as st
from jaws import arm, parallel_jaw

import pinograsp
from pinograsp import InputError, Scene
from pinograsp.cli.folders import file_name
from pinograsp.descriptions.yaml_core import Yaml
from pinograsp.disk import write_whole
from pinograsp.onboarding.new import new_robot_file
from pinograsp.onboarding.yaml_text import text, texts
from pinograsp.visualization import scene as scene_drawing
from pinograsp.visualization.viewer import Recorder, Visualizer

ODD = (
    "0",
    "on",
    "null",
    "1e3",
    "~",
    "a: b",
    "#a",
    "jaw left/1",
    "kleště π",
    "../../x",
    "[a, b]",
    "- 'q' \"",
    "a\\b",
    "y",
)


@given(st.text(st.characters(exclude_categories=["Cs"]), min_size=1))
@example("2026-11-28")
@example("😀\u200b")
@example("package://wheel/arm.urdf")
def test_a_name_is_read_as_it_is(name: str) -> None:
    """By YAML 1.1 and 1.2, alone, in a list and as a key."""
    for loader in (yaml.SafeLoader, Yaml):
        written = f"- {text(name)}    # so\n- {texts([name, name])}\n- {{{text(name)}: 1.0}}\n- {text(name)}: 1.0"
        assert yaml.load(written, loader) == [name, [name, name], {name: 1.0}, {name: 1.0}]


@pytest.mark.parametrize("name", ODD)
def test_a_robot_file_keeps_names_of_the_urdf(name: str, tmp_path: Path) -> None:
    """Of an arm joint, the hand's joint, the wrist and a pad's link."""
    urdf = arm(parallel_jaw(mimic=f"<mimic joint={quoteattr(name + ' slide')}/>"))
    for old in ("a3", "slide_l", "palm", "finger_l"):
        odd = {"a3": name, "slide_l": f"{name} slide", "palm": name, "finger_l": f"{name} finger"}[old]
        urdf = urdf.replace(f'"{old}"', quoteattr(odd))
    (tmp_path / "arm.urdf").write_text(urdf)
    file = tmp_path / "r" / "robot.yaml"
    write_whole(file, new_robot_file(tmp_path / "arm.urdf", file).text)
    robot = pinograsp.load_robot(file)
    assert robot.posture_names == ("a1", "a2", name, "a4", "a5", "a6", f"{name} slide")
    assert robot.description.arm.wrist == name
    assert [pad.link for pad in robot.description.pads] == [f"{name} finger", "finger_r"]
    if name == "jaw left/1":  # of a joint and of a link
        assert [finding for finding in pinograsp.check_robot(file).findings if finding.level != "ok"] == []


@pytest.mark.parametrize("name", ["on", "0", "a: b", "..."])
def test_a_folder_of_any_name_names_the_robot(name: str, run: Run, tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(arm(parallel_jaw()))
    assert run("robot", "new", "arm.urdf", "--out", name)[0] == 0
    assert pinograsp.load_robot(tmp_path / name).description.name == name
    code, output, _ = run("robot", "check", tmp_path / name)
    assert (code, f"written: out/{name}_check.html" in output) == (0, True)


def test_a_folder_whose_name_is_none_for_files_is_refused(run: Run, tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(arm(parallel_jaw()))
    code, _, errors = run("robot", "new", "arm.urdf", "--out", "a\\b")
    assert code == 2
    assert "--out: the folder's name, 'a\\\\b', becomes the robot's: " in errors
    assert not (tmp_path / "a\\b").exists()


def test_a_urdf_that_is_called_like_a_folder_above(run: Run, tmp_path: Path) -> None:
    (tmp_path / "...urdf").write_text(arm(parallel_jaw()))
    code, output, _ = run("robot", "new", "...urdf")
    assert (code, "written: robots/robot/robot.yaml" in output) == (0, True)


@pytest.mark.parametrize("key", ["name", "scene", "task"])
def test_names_that_lead_elsewhere_are_refused(key: str, tmp_path: Path) -> None:
    """Of robots, scenes and tasks: they become parts of names of files."""
    if key == "name":
        (tmp_path / "robot.yaml").write_text(yaml.safe_dump(TOY_ROBOT | {"name": "../../x"}))
        with pytest.raises(InputError, match="name: a slash is not allowed"):
            pinograsp.check_robot(tmp_path)
        return
    content = TOY_SCENE | ({"name": "../x"} if key == "scene" else {"tasks": {"../x": TOY_SCENE["tasks"]["ball"]}})
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(InputError, match="a slash is not allowed"):
        pinograsp.load_scene(tmp_path / "scene.yaml")


@settings(max_examples=30)
@given(st.lists(st.text(), min_size=1, max_size=3))
@example(["../../x", "a"])
def test_no_part_of_a_file_name_leads_elsewhere(parts: list[str]) -> None:
    """Objects may be called anything, and proposed contacts are written under their names."""
    name = file_name(*parts, suffix="json")
    assert not set(name) & {"/", "\\", "\0"}
    assert Path("out", name).parent == Path("out")


def test_names_of_objects_stay_in_the_folder(run: Run, tmp_path: Path, toy: pinograsp.Robot) -> None:
    scene = TOY_SCENE | {"objects": {"../../x": TOY_SCENE["objects"]["ball"]}, "tasks": {}}
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "scene.yaml").write_text(yaml.safe_dump(scene))
    robot = toy.description.source
    code, output, _ = run("contacts", "in/scene.yaml", "--object", "../../x", "--robot", robot, "--out", "in/out")
    assert code == 0
    assert "written: in/out/toy_room_..%2F..%2Fx_toy_contacts.json" in output
    assert [file.name for file in tmp_path.iterdir()] == ["in"]
    assert len(list((tmp_path / "in" / "out").iterdir())) == 2


def test_bodies_whose_names_have_slashes_are_drawn_where_they_are() -> None:
    """Not below the node, and the pose, of another one, nor beside all others."""
    box = {"type": "box", "size": (0.1, 0.1, 0.1)}
    bodies = {
        name: {"shape": box, "pose": {"position": (x, 0.0, 0.0)}} for name, x in (("a", 0.1), ("a/b", 0.2), ("/c", 0.3))
    }
    task = {"object": "ball", "wrench": {"force": (0.0, 0.0, -1.0)}, "contact": {"friction": 0.5}}
    scene = Scene(
        name="s",
        enclosure={"min": (-1.0, -1.0, -1.0), "max": (1.0, 1.0, 1.0)},
        obstacles=bodies,
        objects={"ball": {"shape": {"type": "sphere", "radius": 0.1}, "pose": {"position": (0.0, 0.5, 0.0)}}},
        tasks={"t": task},
    )
    recorder = Recorder()
    scene_drawing.draw_scene(Visualizer(window=recorder)["world"], scene, scene.task("t"))
    paths = {command["path"] for command in recorder.commands if "obstacles" in command["path"]}
    assert paths == {f"/meshcat/world/obstacles/{name}" for name in ("a", "a%2Fb", "%2Fc")}
