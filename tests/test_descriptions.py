"""Robot and scene files: what is accepted, and how everything else is refused."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import FrozenInstanceError
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from conftest import TOY_ROBOT, TOY_URDF

import pinograsp
from pinograsp import InputError, load_robot, load_scene
from pinograsp.descriptions import load_robot_description, schema, shipped_robots, shipped_scenes
from pinograsp.descriptions.yaml_core import Yaml

ROBOT = shipped_robots()["gen3_2f85"].read_text()
SCENE = shipped_scenes()["glovebox"].read_text()
SHIPPED = [("robot", file) for file in shipped_robots().values()] + [
    ("scene", file) for file in shipped_scenes().values()
]


def line_of(text: str, part: str) -> int:
    """Number of the last line that holds `part`."""
    return text[: text.rindex(part)].count("\n") + 1


def refused(kind: str, file: Path, content: str | bytes) -> InputError:
    """Write a file, load it, and return the error."""
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError) as caught:
        (load_scene if kind == "scene" else load_robot)(file)
    assert caught.value.file == file
    assert str(caught.value).startswith(str(file))
    assert "\n" not in str(caught.value)
    return caught.value


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


# Files that are fine.


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("010", 10),
        ("-08", -8),
        ("0x1F", 31),
        ("0o17", 15),
        ("1e-3", 0.001),
        ("-.5E+3", -500.0),
        ("1.", 1.0),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("~", None),
        ("", None),
        ("true", True),
        ("FALSE", False),
        *((text, text) for text in ("1:30", "1_0", "0b1", "yes", "on", "no", "2020-01-01", "0.0.5", "1e", "-0x1", ".")),
    ],
)
def test_yaml_has_the_words_and_numbers_of_1_2(text: str, value: object) -> None:
    read = yaml.load(f"key: {text}", Loader=Yaml)["key"]
    assert (read, type(read)) == (value, type(value))


def test_yaml_has_texts_in_quotation_marks_and_repetitions() -> None:
    content = yaml.load("one: &one {a: '1', b: 2}\nother: {<<: *one, b: no}", Loader=Yaml)
    assert content["other"] == {"a": "1", "b": "no"}


@pytest.mark.parametrize(("kind", "file"), SHIPPED, ids=lambda value: getattr(value, "name", value))
def test_shipped_file_loads_and_keeps_its_hash(kind: str, file: Path) -> None:
    description = load_robot_description(file) if kind == "robot" else load_scene(file)
    assert description.source == file
    assert description.digest == hashlib.sha256(file.read_bytes()).hexdigest()


@pytest.mark.parametrize("robot", shipped_robots())
def test_shipped_robot_becomes_a_model(robot: str) -> None:
    model = load_robot(robot)
    assert model.posture_size == len(model.description.arm.joints) + len(model.description.hand.synergies)


@pytest.mark.parametrize("name", ["glovebox", "glovebox.yaml", "scenes/glovebox.yaml"])
def test_scene_is_found_by_name_from_anywhere(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert load_scene(name).source == shipped_scenes()["glovebox"]


@pytest.mark.parametrize("name", ["gen3_2f85", "robots/gen3_2f85", "robots/gen3_2f85/robot.yaml"])
def test_robot_is_found_by_name_from_anywhere(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert load_robot_description(name).source == shipped_robots()["gen3_2f85"]


def test_robot_is_found_by_its_folder() -> None:
    file = shipped_robots()["gen3_2f85"]
    assert load_robot_description(file.parent).source == file


def test_own_file_hides_the_shipped_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "glovebox.yaml").write_text(changed(SCENE, "name: glovebox", "name: mine"))
    assert load_scene("glovebox.yaml").name == "mine"


def test_number_without_a_dot_before_its_exponent(tmp_path: Path) -> None:
    # YAML 1.1 reads 1e-2 as a text, YAML 1.2 and everybody else as a number.
    file = tmp_path / "scene.yaml"
    file.write_text(changed(SCENE, "friction: 0.9", "friction: 9e-1"))
    assert load_scene(file).tasks["sphere"].contact.friction == 0.9


def test_descriptions_cannot_be_changed() -> None:
    with pytest.raises(FrozenInstanceError, match=r"Scene cannot be changed: make another one with model_copy"):
        load_scene("glovebox").name = "other"  # type: ignore[misc]


# Files that are refused: (kind, old text, new text, key, text of the line, words of the message).

BAD_VALUES: list[tuple[str, str, str, str, str, list[str]]] = [
    # unknown, missing, repeated keys
    (
        "scene",
        "force_weight:",
        "force_wieght:",
        "tasks.sphere.force_wieght",
        "force_wieght",
        ["unknown key", "force_w"],
    ),
    ("scene", "radius:", "raduis:", "objects.sphere.shape.raduis", "raduis", ["unknown key", "Did you mean radius"]),
    ("scene", "tasks:", "taks:", "taks", "taks", ["unknown key", "tasks"]),
    ("robot", "normal: [-1", "noraml: [-1", "pads[0].patch.noraml", "noraml", ["unknown key", "Did you mean normal"]),
    ("scene", "format: 1", "format: 1\nsource: here", "source", "source: here", ["unknown key"]),
    ("scene", "format: 1\n", "", "format", "name: glovebox", ["missing"]),
    ("scene", "    object: sphere\n", "", "tasks.sphere.object", "  sphere:", ["missing"]),
    ("scene", "{type: sphere, ", "{", "objects.sphere.shape.type", "shape:", ["missing"]),
    ("robot", "torsion_radius: 0.0022, ", "", "pads[0].contact.torsion_radius", "finger, torsional", ["missing"]),
    (
        "scene",
        "force_weight: 1.0",
        "force_weight: 1.0\n    force_weight: 2",
        "tasks.sphere.force_weight",
        "force_weight: 2",
        ["twice"],
    ),
    # numbers
    ("scene", "0.0373}", "0.0.5}", "objects.sphere.shape.radius", "radius", ["a number is wanted", "'0.0.5'"]),
    ("scene", "0.0373}", "true}", "objects.sphere.shape.radius", "radius", ["a number is wanted"]),
    ("scene", "0.0373}", ".nan}", "objects.sphere.shape.radius", "radius", ["finite"]),
    ("scene", "0.0373}", "-.inf}", "objects.sphere.shape.radius", "radius", ["finite"]),
    ("scene", "0.0373}", "}", "objects.sphere.shape.radius", "radius", ["a number is wanted", "nothing"]),
    ("scene", "0.0373}", "0}", "objects.sphere.shape.radius", "radius", ["must be greater than 0 (given: 0)"]),
    ("scene", "0.0373}", "9e-6}", "objects.sphere.shape.radius", "radius", ["1e-05 m or more", "(given: 9e-06)"]),
    ("scene", "0.0373}", "1:30}", "objects.sphere.shape.radius", "radius", ["a number is wanted", "'1:30'"]),
    ("scene", "0.0373}", "1_0}", "objects.sphere.shape.radius", "radius", ["a number is wanted", "'1_0'"]),
    ("scene", "0.0373}", "'0.0373'}", "objects.sphere.shape.radius", "radius", ["a number is wanted", "'0.0373'"]),
    ("scene", "0.0373}", "1e10}", "objects.sphere.shape.radius", "radius", ["between -1e+09 and 1e+09"]),
    ("scene", "0.0, 0.0373, 0.0]", "0.0, x, 0.0]", "tasks.sphere.desired_contacts[0][1]", "0.0, x", ["number", "'x'"]),
    ("scene", "format: 1", "format: 2", "format", "format: ", ["must be 1", "2"]),
    ("scene", "format: 1", "format: true", "format", "format: ", ["number"]),
    # lists, blocks and texts
    ("scene", "[1.10, 0.42, 0.363]", "[1.10, 0.42]", "enclosure.max", "max: ", ["3 values are wanted (2 given)"]),
    ("scene", "[1.10, 0.42, 0.363]", "[]", "enclosure.max", "max: ", ["3 values are wanted (0 given)"]),
    ("scene", "[0.0, 0.0373, 0.0]", "[0.1]", "tasks.sphere.desired_contacts[0]", "[0.1]", ["3 values", "1 given"]),
    ("scene", "[1.10, 0.42, 0.363]", "[1, 1, 1, 1]", "enclosure.max", "max: ", ["3 values", "4 given"]),
    ("scene", "[1.10, 0.42, 0.363]", "1.10", "enclosure.max", "max: ", ["list"]),
    (
        "scene",
        "      - [0.0, 0.0373, 0.0]\n",
        "",
        "tasks.sphere.desired_contacts",
        "desired",
        ["at least 2", "1 given"],
    ),
    ("scene", "objects:\n", "obstacles:\nobjects:\n", "obstacles", "obstacles", ["block of keys"]),
    ("scene", "name: glovebox", "name: 3", "name", "name: 3", ["text", "3"]),
    ("scene", "name: glovebox", "name: a/b", "name", "a/b", ["slash"]),
    ("scene", "name: glovebox", 'name: "a\\0b"', "name", "name:", ["U+0000"]),
    ("scene", "name: glovebox", "name: " + 300 * "a", "name", "name:", ["300 bytes", "64 are allowed"]),
    ("robot", "name: gen3_2f85", "name: a/b", "name", "a/b", ["slash"]),
    ("scene", "tasks:\n  sphere", "tasks:\n  1", "tasks.1", "  1:", ["text", "1"]),
    # values that contradict each other
    ("scene", "min: [0.0,", "min: [2.0,", "enclosure.min[0]", "min: [2.0", ["below", "along x"]),
    (
        "scene",
        "object: sphere",
        "object: shpere",
        "tasks.sphere.object",
        "shpere",
        ["no object 'shpere'", "mean sphere"],
    ),
    (
        "scene",
        "objects:\n",
        "obstacles: {sphere: {shape: {type: sphere, radius: 1}}}\nobjects:\n",
        "obstacles.sphere",
        "obstacles",
        ["same name"],
    ),
    (
        "scene",
        "min_normal_force: 0.001",
        "min_normal_force: 6",
        "tasks.sphere.contact.min_normal_force",
        "force: 6",
        ["below max_force"],
    ),
    ("scene", "type: sphere", "type: spere", "objects.sphere.shape.type", "spere", ["'spere'", "mean sphere"]),
    *(
        ("scene", "    wrench:", f"    {text}\n    wrench:", f"tasks.sphere.{key}", text, words)
        for text, key, words in [
            ("approach: {direction: [0, 0, -2], angle: 1}", "approach.direction", ["length 1", "not 2"]),
            ("approach: {direction: [0, 0, 0], angle: 1}", "approach.direction", ["length 1", "not 0"]),
            ("approach: {direction: [0, 0, -1], angle: 0}", "approach.angle", ["greater than 0"]),
            ("approach: {direction: [0, 0, -1], angle: 3.2}", "approach.angle", ["less than or equal to 3.14"]),
            ("approach: {direction: [0, 0, -1]}", "approach.angle", ["missing"]),
            ("approach: {direction: [0, 0, -1], angle: 1, frame: wrist}", "approach.frame", ["'world' or 'object'"]),
            ("approach: {direction: [0, 0, -1], angel: 1}", "approach.angel", ["unknown key", "mean angle"]),
            ("joint_ranges: {joint_6: [0.5, -1.5]}", "joint_ranges.joint_6", ["0.5 is above", "-1.5"]),
            ("joint_ranges: {joint_6: [0.5]}", "joint_ranges.joint_6", ["2 values are wanted (1 given)"]),
            ("joint_ranges: {joint_6: 0.5}", "joint_ranges.joint_6", ["a list in [brackets]"]),
            ("joint_ranges: [joint_6]", "joint_ranges", ["block of keys"]),
            ("lock: {joint_6: [0, 0]}", "lock.joint_6", ["a number is wanted", "[0, 0]"]),
            ("lock: {joint_6: .nan}", "lock.joint_6", ["finite"]),
            ("lock: {joint_6: true}", "lock.joint_6", ["a number is wanted"]),
            ("lock: joint_6", "lock", ["block of keys"]),
            ("locked: {joint_6: 0}", "locked", ["unknown key", "Did you mean lock"]),
            ("allowed_contacts: {type: band, z: [0, 1], x: 2}", "allowed_contacts.x", ["unknown key", "z"]),
            ("allowed_contacts: {type: band, z: [1, 0]}", "allowed_contacts.z", ["1 is not below", "end 0"]),
        ]
    ),
    ("robot", "link\n", "link\n  limits: {joint_1: [1, -1]}\n", "arm.limits.joint_1", "limits", ["not below"]),
    ("robot", "link\n", "link\n  limits: {joint_9: [-1, 1]}\n", "arm.limits.joint_9", "limits", ["joint_9", "arm"]),
    ("robot", "joint_6, joint_7", "joint_6, joint_6", "arm.joints[6]", "joint_6", ["'joint_6'", "twice"]),
    ("robot", "name: right", "name: left", "pads[1].name", "name: left", ["'left'", "twice"]),
    ("robot", "u: [-0.018, 0.018]", "u: [0.018, -0.018]", "pads[0].patch.u", "u: [0.018", ["not below"]),
    ("robot", "normal: [-1.0,", "normal: [-1.1,", "pads[0].patch.normal", "normal: [-1.1", ["length 1", "1.1"]),
    (
        "robot",
        "x_axis: [0.0, 0.0, 1.0]",
        "x_axis: [1.0, 0.0, 0.0]",
        "pads[0].patch.x_axis",
        "x_axis: [1.0",
        ["perpendicular"],
    ),
    ("robot", "joint: 100.0", "joint: -1", "stiffness.joint", "joint: -1", ["greater than 0"]),
]


@pytest.mark.parametrize(
    ("kind", "old", "new", "key", "line", "words"), BAD_VALUES, ids=[f"{case[3]} {case[5][0]}" for case in BAD_VALUES]
)
def test_bad_value(kind: str, old: str, new: str, key: str, line: str, words: list[str], tmp_path: Path) -> None:
    text = changed(ROBOT if kind == "robot" else SCENE, old, new)
    error = refused(kind, tmp_path / "file.yaml", text)
    assert error.key == key
    assert error.line == line_of(text, line)
    for word in words:
        assert word in str(error)


def test_two_synergies_of_one_joint(tmp_path: Path) -> None:
    text = changed(ROBOT, "  synergies:\n", "  synergies:\n    - joint: robotiq_85_left_knuckle_joint\n")
    error = refused("robot", tmp_path / "robot.yaml", text)
    assert (error.key, error.line) == ("hand.synergies[1].joint", line_of(text, "- joint: robotiq"))


CLOSE = {"name": "close", "joints": {"slide_left": 1.0}}
SYNERGY = ["a synergy is one joint, or has a name and joints", "Write `joint: finger`, or `name: close`"]


@pytest.mark.parametrize(
    ("synergies", "rest", "key", "words"),
    [
        ([[1.0, 0.5], [1.0]], {}, "hand.synergies[0]", SYNERGY),  # a matrix: its numbers belong to no joints
        (["slide_left"], {}, "hand.synergies[0]", SYNERGY),
        ([{"name": "close"}], {}, "hand.synergies[0]", SYNERGY),
        ([{"joints": {"slide_left": 1.0}}], {}, "hand.synergies[0]", SYNERGY),
        ([{"joint": "slide_left", "name": "close"}], {}, "hand.synergies[0]", SYNERGY),
        ([CLOSE | {"joints": [1.0, 0.5]}], {}, "hand.synergies[0].joints", ["with the names of joints", "{finger: 1"]),
        ([CLOSE | {"joints": {"slide_left": [1.0, 2.0]}}], {}, "hand.synergies[0].joints.slide_left", ["a number"]),
        ([CLOSE | {"joints": {"slide_left": 0}}], {}, "hand.synergies[0].joints.slide_left", ["moves nothing"]),
        ([CLOSE | {"joints": {"slide_rigt": 1}}], {}, "hand.synergies[0].joints.slide_rigt", ["mean slide_right"]),
        ([CLOSE | {"joints": {"slide_right": 1}}], {}, "hand.synergies[0].joints.slide_right", ["Name 'slide_left'"]),
        ([CLOSE | {"joints": {"shoulder": 1}}], {}, "hand.synergies[0].joints.shoulder", ["already an arm joint"]),
        ([CLOSE | {"name": "shoulder"}], {}, "hand.synergies[0].name", ["a joint has this name", "Use another one"]),
        ([CLOSE, CLOSE], {}, "hand.synergies[1].name", ["'close' is given twice"]),
        ([{"joint": "slide_left"}, CLOSE], {}, "hand.synergies[1].joints.slide_left", ["a synergy of its own"]),
        ([{"joint": "slide_left"}], {"slide_left": 0.01}, "hand.rest.slide_left", ["has no rest"]),
        ([CLOSE], {"slide_lft": 0.01}, "hand.rest.slide_lft", ["is not in toy.urdf. Did you mean slide_left"]),
        ([CLOSE, CLOSE | {"name": "more"}], {}, "hand.synergies", ["'close' has no usable limits", "Give them"]),
        ([], {}, "hand.synergies", ["at least 1"]),
    ],
    ids=str,
)
def test_synergies_that_are_refused(
    synergies: list[Any], rest: dict[str, float], key: str, words: list[str], tmp_path: Path
) -> None:
    error = refused_urdf(tmp_path, hand={"synergies": synergies, "rest": rest})
    assert (error.file, error.key) == (tmp_path / "robot.yaml", key)
    for word in words:
        assert word in str(error)


@pytest.mark.parametrize(("pads", "count"), [([], 0), (TOY_ROBOT["pads"][:1], 1), (None, 0)])
def test_hand_without_contacts(pads: list[Any] | None, count: int, tmp_path: Path) -> None:
    error = refused_urdf(tmp_path, pads=pads)
    assert (error.file, error.key) == (tmp_path / "robot.yaml", "pads")
    assert error.line is not None
    assert f"two pads or more, not with {count}. Describe the finger surfaces" in str(error)


@pytest.mark.parametrize(
    ("content", "words", "line"),
    [
        ("", "empty", None),
        ("# only a comment\n", "empty", None),
        ("- 1\n- 2\n", "not a mapping", None),
        ("format: 1\nname: [a,\n", "not valid YAML", 3),
        ("format: 1\n\tname: a\n", "not valid YAML", 2),
        ("format: 1\n---\nformat: 1\n", "another document", 2),
        ("name: !!python/object:os.system x\n", "not valid YAML", 1),
        ("? {a: b}\n: 1\n", "unhashable key", 1),
        ("[" * 3000, "exceeded maximum nesting depth", 1),
        ("name: &a [*a]\n", "not valid YAML", 1),
        ("name: a\0b\n", "not valid YAML", None),
        (b"\x89PNG\r\n\x1a\n\x00\xff", "not a text file", None),
    ],
    ids=[
        "empty",
        "comment",
        "list",
        "open bracket",
        "tab",
        "two documents",
        "Python object",
        "block as key",
        "deep",
        "contains itself",
        "null",
        "binary",
    ],
)
@pytest.mark.parametrize("kind", ["robot", "scene"])
def test_not_a_description(kind: str, content: str | bytes, words: str, line: int | None, tmp_path: Path) -> None:
    error = refused(kind, tmp_path / "file.yaml", content)
    assert words in str(error)
    assert error.line == line


@pytest.mark.parametrize(
    "name", ["glovebx", "scenes/glovebx.yaml", "nowhere/glovebx.yaml", "~nobody_at_all/glovebx.yaml"]
)
def test_missing_scene(name: str) -> None:
    with pytest.raises(InputError, match=r"no such scene file.*Did you mean glovebox\b") as caught:
        load_scene(name)
    assert caught.value.file == Path(name)


def test_missing_robot(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no such robot file.*Did you mean gen3_2f85\b"):
        load_robot("gen3_2f58")
    with pytest.raises(InputError, match=r"is a folder without robot\.yaml"):
        load_robot(tmp_path)  # a folder without robot.yaml


def test_unreadable_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(SCENE)

    def refuse(_: Path, mode: str) -> bytes:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)  # chmod does not stop root
    with pytest.raises(InputError, match="cannot be read: permission denied"):
        load_scene(file)


def test_task_that_does_not_exist() -> None:
    with pytest.raises(InputError, match="Did you mean sphere") as caught:
        load_scene("glovebox").task("spher")
    assert caught.value.key == "tasks"


# The URDF behind a robot file.

MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'


def write_toy(folder: Path, xml: str = TOY_URDF, mesh: str | None = None, **changes: Any) -> Path:
    """Write a toy robot, one collision mesh added to its base if wanted, and return its robot file."""
    if mesh is not None:
        xml = changed(xml, '<link name="base">', '<link name="base">' + MESH.format(mesh))
    (folder / "toy.urdf").write_text(xml)
    file = folder / "robot.yaml"
    file.write_text(yaml.safe_dump(TOY_ROBOT | changes))
    return file


def refused_urdf(folder: Path, xml: str = TOY_URDF, mesh: str | None = None, **changes: Any) -> InputError:
    file = write_toy(folder, xml, mesh, **changes)
    with pytest.raises(InputError) as caught:
        load_robot(file)
    return caught.value


def put_mesh(file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("solid nothing\nendsolid nothing\n")  # its content is not read here


@pytest.mark.parametrize(
    "address", ["package://parts/base.stl", "files/parts/base.stl", "../robot/files/parts/base.stl"]
)
def test_mesh_is_found(address: str, tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    mesh = folder / "files" / "parts" / "base.stl"
    put_mesh(mesh)
    model = load_robot(write_toy(folder, mesh=address, packages=["files"]))
    assert f'filename="{mesh}"' in model.urdf.xml


def test_package_is_found_beside_the_robot_file_wherever_one_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put_mesh(tmp_path / "files" / "parts" / "base.stl")
    (tmp_path / "robot").mkdir()
    file = write_toy(tmp_path / "robot", mesh="package://parts/base.stl", packages=["../files"])
    monkeypatch.chdir("/")
    assert load_robot(file).joint_names == ("shoulder", "slide_left", "slide_right")


@pytest.mark.parametrize(
    "address",
    [
        "package://../../outside.stl",
        "../outside.stl",
        "file://{outside}",
        "{outside}",
        "package://{outside}",
        "link.stl",
    ],
)
def test_mesh_outside_the_allowed_folders_is_refused(address: str, tmp_path: Path) -> None:
    outside = tmp_path / "outside.stl"
    put_mesh(outside)
    folder = tmp_path / "robot"
    (folder / "files").mkdir(parents=True)
    (folder / "link.stl").symlink_to(outside)
    error = refused_urdf(folder, mesh=address.format(outside=outside), packages=["files"])
    assert (error.file, error.key) == (folder / "toy.urdf", "link base")
    assert address.format(outside=outside) in str(error)
    assert "packages" in str(error)


def test_mesh_that_does_not_exist(tmp_path: Path) -> None:
    error = refused_urdf(tmp_path, mesh="package://parts/base.stl")
    assert (error.file, error.key) == (tmp_path / "toy.urdf", "link base")
    assert "package://parts/base.stl was not found" in str(error)


@pytest.mark.parametrize("key", ["urdf", "srdf"])
@pytest.mark.parametrize("address", ["other.urdf", "package://nowhere/other.urdf", "/etc/hostname", "."])
def test_urdf_or_srdf_that_does_not_exist(key: str, address: str, tmp_path: Path) -> None:
    error = refused_urdf(tmp_path, **{key: address})
    assert (error.file, error.key) == (tmp_path / "robot.yaml", key)
    assert f"{address} was not found" in str(error)
    assert str(tmp_path) in str(error.remedy)


@pytest.mark.parametrize(
    ("changes", "key", "words"),
    [
        (
            {"arm": {"joints": ["sholder"], "wrist": "arm"}},
            "arm.joints[0]",
            "'sholder' is not in toy.urdf. Did you mean shoulder",
        ),
        ({"arm": {"joints": ["shoulder"], "wrist": "amr"}}, "arm.wrist", "'amr' is not in toy.urdf. Did you mean arm"),
        ({"hand": {"synergies": [{"joint": "slide_lft"}]}}, "hand.synergies[0].joint", "Did you mean slide_left"),
        ({"hand": {"synergies": [{"joint": "shoulder"}]}}, "hand.synergies[0].joint", "already an arm joint"),
        (
            {"pads": [TOY_ROBOT["pads"][0], TOY_ROBOT["pads"][1] | {"link": "rihgt"}]},
            "pads[1].link",
            "Did you mean right",
        ),
        (
            {"pads": [TOY_ROBOT["pads"][0], TOY_ROBOT["pads"][1] | {"link": "base"}]},
            "pads[1].link",
            "not moved by the hand",
        ),
    ],
)
def test_name_that_is_not_in_the_urdf(changes: dict[str, Any], key: str, words: str, tmp_path: Path) -> None:
    error = refused_urdf(tmp_path, **changes)
    assert (error.file, error.key) == (tmp_path / "robot.yaml", key)
    assert words in str(error)


@pytest.mark.parametrize(
    ("old", "new", "file", "key", "words"),
    [
        ("</robot>", "", "toy.urdf", None, "not valid XML"),
        (TOY_URDF, "<sdf/>", "toy.urdf", None, "xacro"),
        (
            '"shoulder" type="revolute"',
            '"shoulder" type="floating"',
            "toy.urdf",
            "shoulder",
            "a floating joint is moved by nothing",
        ),
        ('lower="-1.5" upper="1.5" ', "", "robot.yaml", "arm.limits", "'shoulder' has no usable limits"),
        ('lower="-1.5" upper="1.5"', 'lower="1.5" upper="-1.5"', "robot.yaml", "arm.limits", "no usable limits"),
    ],
)
def test_urdf_that_cannot_be_used(old: str, new: str, file: str, key: str | None, words: str, tmp_path: Path) -> None:
    error = refused_urdf(tmp_path, changed(TOY_URDF, old, new))
    assert (error.file, error.key) == (tmp_path / file, key)
    assert words in str(error)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('lower="-1.5"', 'lower="1a"'),
        ('multiplier="1.25"', 'multiplier="x"'),
        ('<mimic joint="slide_left"', '<mimic joint="slide_lft"'),
        ('xyz="0 0 0.2"', 'xyz="0 0 ${height}"'),
        ('<link name="base">', '<link name="orphan"/><link name="base">'),
        ('<link name="base">', '<link name="arm"/><link name="base">'),
        ('<parent link="base"/><child link="arm"/>', '<parent link="base"/>'),
        ('<parent link="base"/>', '<parent link="left"/>'),
        ('<robot name="toy">', '<robot name="toy"><xacro:macro xmlns:xacro="http://www.ros.org/wiki/xacro"/>'),
    ],
    ids=[
        "limit is no number",
        "multiplier is no number",
        "mimics nothing",
        "origin is no number",
        "two roots",
        "two links of one name",
        "no child",
        "loop",
        "xacro",
    ],
)
def test_malformed_urdf(old: str, new: str, tmp_path: Path) -> None:
    error = refused_urdf(tmp_path, changed(TOY_URDF, old, new))
    assert error.file == tmp_path / "toy.urdf"


def test_srdf_that_is_no_xml(tmp_path: Path) -> None:
    error = refused_urdf(tmp_path, srdf="robot.yaml")
    assert "not valid XML" in str(error)


def test_limits_in_the_robot_file_replace_those_of_the_urdf(tmp_path: Path) -> None:
    urdf = changed(TOY_URDF, 'lower="-1.5" upper="1.5" ', "")
    arm = TOY_ROBOT["arm"] | {"limits": {"shoulder": [-0.5, 0.25]}}
    hand = {"synergies": [{"joint": "slide_left", "limits": [0.0, 0.04]}]}
    model = load_robot(write_toy(tmp_path, urdf, arm=arm, hand=hand))
    assert model.lower.tolist() == [-0.5, 0.0]
    assert model.upper.tolist() == [0.25, 0.04]


# JSON Schema.


@pytest.mark.parametrize("kind", ["robot", "scene"])
def test_published_schema_is_up_to_date(kind: str) -> None:
    file = Path(pinograsp.__file__).parents[1] / f"{kind}s" / f"{kind}.schema.json"
    assert json.loads(file.read_text()) == schema(kind), f"write it again: pinograsp schema {kind} > {file}"  # type: ignore[arg-type]


@pytest.mark.parametrize(("kind", "file"), SHIPPED, ids=lambda value: getattr(value, "name", value))
def test_shipped_file_fits_its_schema(kind: str, file: Path) -> None:
    first, _, address = file.read_text().splitlines()[0].partition("$schema=")
    assert first == "# yaml-language-server: "
    published = json.loads((file.parent / address).read_text())
    validator = jsonschema.Draft202012Validator(published)
    validator.check_schema(published)
    content = yaml.safe_load(file.read_text())
    validator.validate(content)
    assert "source" not in published["properties"]
    for wrong in (content | {"unknown": 1}, content | {"format": 2}, content | {"name": 3}):
        assert not validator.is_valid(wrong)


@pytest.mark.parametrize("kind", ["robot", "scene"])
def test_schema_says_what_every_key_is(kind: str) -> None:
    """But for tags and the format, which can have one value only."""
    whole = schema(kind)  # type: ignore[arg-type]
    for name, block in {kind: whole, **whole["$defs"]}.items():
        for key, value in block["properties"].items():
            assert value.get("description") or "const" in value, f"{name}.{key}"
    task = schema("scene")["$defs"]["Task"]["properties"]
    assert task["start_radius"]["description"].endswith("object's centre of mass, m.")
    assert task["wrench"]["anyOf"] == [{"$ref": "#/$defs/Wrench"}, {"type": "null"}]
    assert "that the contacts are to balance" in task["wrench"]["description"]


FOR_EDITORS = [case for case in BAD_VALUES if case[5][0] in {"unknown key", "missing", "a number is wanted"}]


@pytest.mark.parametrize("case", FOR_EDITORS, ids=lambda case: str(case[3]))
def test_schema_refuses_it_too(case: tuple[str, str, str, str, str, list[str]]) -> None:
    kind, old, new, *_ = case
    content = yaml.load(changed(ROBOT if kind == "robot" else SCENE, old, new), Loader=Yaml)
    assert not jsonschema.Draft202012Validator(schema(kind)).is_valid(content)  # type: ignore[arg-type]


def test_keys_that_come_from_elsewhere_are_named_with_the_line_of_their_block(tmp_path: Path) -> None:
    """YAML's `<<` takes keys from another block: they have no line of their own where they count."""
    text = changed(SCENE, "tasks:\n", "tasks:\n  other: {<<: {object: sphere, wrnch: 1}}\n")
    error = refused("scene", tmp_path / "scene.yaml", text)
    assert (error.key, error.line) == ("tasks.other.wrnch", line_of(text, "  other:"))


def test_a_copy_with_changes_forgets_what_was_computed(glovebox: Any) -> None:
    pose = glovebox.objects["sphere"].pose
    assert pose.matrix[0, 3] == 0.801
    assert pose.model_copy(update={"position": (0.5, 0.0, 0.0)}).matrix[0, 3] == 0.5
