"""Errors about a scene name what says it: its file, the option that changed it, or the result that has it."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from conftest import Run

import pinograsp
from pinograsp import Cone, InputError, Robot, Scene, TaskError
from pinograsp.descriptions.scene_keys import scene_keys

OUTSIDE = ("--object-pose", "sphere", 5, 0, 0, 0, 0, 0)
INSIDE = ("--object-pose", "sphere", 0.8, 0.02, -0.1, 0, 0, 0)
POSTURE = ("--joints", "posture.json")


def refused(outcome: tuple[int, str, str]) -> str:
    """Return the line of the error of a command that refuses its input."""
    code, out, err = outcome
    assert (code, out) == (2, "")
    return err.splitlines()[-1]


@pytest.fixture
def cone(glovebox: Scene, tmp_path: Path) -> Path:
    """Return a scene file with a pointed cone, which has no opposite faces."""
    content = glovebox.to_dict()
    shape = Cone(bottom_radius=0.03, top_radius=0.0, height=0.06)
    content["objects"]["sphere"]["shape"] = shape.model_dump(mode="json")
    content["tasks"]["sphere"].pop("desired_contacts")
    file = tmp_path / "cone.yaml"
    file.write_text(yaml.safe_dump(content))
    return file


@pytest.mark.parametrize("asked", [("--task", "sphere"), ("--object", "sphere")])
@pytest.mark.parametrize("pose", [(), INSIDE])
def test_contacts_name_the_file(asked: tuple[str, ...], pose: tuple[object, ...], cone: Path, run: Run) -> None:
    message = refused(run("contacts", "cone.yaml", *asked, *pose))
    assert message.startswith("error: cone.yaml: objects.sphere.shape: no contacts can be proposed for 'sphere'")


def test_contacts_in_python_name_the_file(cone: Path, gen3: Robot) -> None:
    with pytest.raises(TaskError) as caught:
        pinograsp.contacts(gen3, pinograsp.load_scene(cone), object="sphere")
    assert (caught.value.file, caught.value.key) == (cone, "objects.sphere.shape")


@pytest.mark.parametrize("command", ["plan", "contacts"])
def test_a_pose_on_the_command_line_is_an_option(command: str, cone: Path, run: Run) -> None:
    message = refused(run(command, cone, "--task", "sphere", *OUTSIDE))
    assert message.startswith("error: --object-pose: the object 'sphere' is outside the enclosure")


@pytest.mark.parametrize("command", ["plan", "check", "why"])
def test_a_lock_on_the_command_line_is_an_option(command: str, cone: Path, run: Run, tmp_path: Path) -> None:
    (tmp_path / "posture.json").write_text("{}")
    own = POSTURE if command == "check" else ()
    message = refused(run(command, cone, "--task", "sphere", "--lock", "elbow=0", *own))
    assert message.startswith("error: --lock elbow: 'elbow' is no arm joint or synergy of gen3_2f85")


def test_what_the_scene_says_beside_a_lock_is_that_of_its_file(cone: Path, run: Run) -> None:
    content = yaml.safe_load(cone.read_text())
    content["tasks"]["sphere"]["lock"] = {"elbow": 0.0}
    cone.write_text(yaml.safe_dump(content))
    message = refused(run("plan", "cone.yaml", "--task", "sphere", "--lock", "joint_7=0.5"))
    assert message.startswith("error: cone.yaml: tasks.sphere.lock.elbow: 'elbow' is no arm joint")


def test_a_result_is_named(glovebox: Scene, gen3: Robot, run: Run, tmp_path: Path) -> None:
    massless = glovebox.with_task("sphere", wrench={"force": [0.0, 0.0, 0.0], "torque": [0.0, 0.0, 0.01]})
    result = pinograsp.plan(gen3, massless, "sphere", starts=8, workers=1)
    assert result.grasps
    pinograsp.write_json(result, tmp_path / "result.json")
    message = refused(run("hold", "result.json", "--best", 1, "--workers", 1))
    assert message.startswith("error: result.json: objects.sphere.mass: is not given")


@pytest.mark.parametrize(
    ("key", "named"),
    [
        ("objects.sphere.pose", True),
        ("tasks.sphere.contact.friction", True),
        ("objects", True),
        ("mounting.rpy", True),
        ("tasks.contacts.wrench", False),
        ("objects.sphere2.pose", False),
        ("seed", False),
        ("", False),
    ],
)
def test_only_what_the_scene_has_is_of_its_file(key: str, named: bool, glovebox: Scene) -> None:
    with pytest.raises(TaskError) as caught, scene_keys(glovebox, Path("a.yaml")):
        raise TaskError("is wrong", key=key or None, remedy="Mend it")
    assert (caught.value.file, caught.value.problem, caught.value.remedy) == (
        Path("a.yaml") if named else None,
        "is wrong",
        "Mend it",
    )


def test_another_file_that_is_named_stays(glovebox: Scene) -> None:
    with pytest.raises(InputError) as caught, scene_keys(glovebox, Path("a.yaml")):
        raise InputError("is wrong", key="objects.sphere.pose", file="b.yaml", line=3)
    assert str(caught.value) == "b.yaml:3: objects.sphere.pose: is wrong"
