"""What is guessed and mended in mesh files is told by whatever plans with them, not by plans alone."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import pytest
import trimesh
import yaml
from conftest import Run

import pinograsp
from pinograsp import Pose, Robot

GUESSED = "mesh of 'sphere': taken as millimetres: it is 60 mm large, in metres it would be 60 m"
TOLD = f"warning: {GUESSED}"


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a scene file with a box in millimetres whose mesh file does not say so."""
    folder = tmp_path_factory.mktemp("guessed")
    trimesh.creation.box(extents=(60.0, 40.0, 20.0)).export(folder / "box.stl")
    content = pinograsp.load_scene("glovebox").to_dict()
    content["objects"]["sphere"]["shape"] = {"type": "mesh", "file": "box.stl"}
    content["tasks"]["sphere"].pop("desired_contacts")
    (folder / "scene.yaml").write_text(yaml.safe_dump(content))
    return folder / "scene.yaml"


@pytest.mark.parametrize("way", ["task", "object"])
def test_contacts_tell_it(way: str, file: Path, gen3: Robot, run: Run) -> None:
    code, _, err = run("contacts", file, f"--{way}", "sphere", "--most", 1)
    assert (code, err.count(TOLD)) == (0, 1)
    code, out, err = run("contacts", file, f"--{way}", "sphere", "--most", 1, "--json")
    assert (code, json.loads(out)["warnings"], "warning:" in err) == (0, [GUESSED], False)
    scene = pinograsp.load_scene(file)
    task, object = ("sphere", None) if way == "task" else (None, "sphere")
    pairs = pinograsp.contacts(gen3, scene, task=task, object=object, most=1)
    assert pairs.warnings == (GUESSED,)
    assert pickle.loads(pickle.dumps(pairs)).warnings == pairs.warnings


def test_contacts_of_what_is_certain_tell_nothing(gen3: Robot) -> None:
    assert pinograsp.contacts(gen3, pinograsp.load_scene("glovebox"), object="sphere", most=1).warnings == ()


def test_contacts_and_plans_tell_the_same(file: Path, gen3: Robot) -> None:
    turned = pinograsp.load_scene(file)
    turned = turned.with_object_pose("sphere", Pose(position=(0.8, 0.02, -0.1), rpy=(0.0, 0.0, 90.0)))
    with pinograsp.Planner(gen3, turned, workers=1) as planner:
        told = planner.contacts("sphere", most=1).warnings
        assert told == planner.first("sphere", most=1, deadline=0.0).warnings[: len(told)]
    assert [warning.split(":")[0] for warning in told] == [
        "objects.sphere.pose.rpy has an angle of 90 rad, more than a turn",
        "mesh of 'sphere'",
    ]


def test_checks_of_configurations_tell_it(file: Path, gen3: Robot, run: Run) -> None:
    joints = dict.fromkeys(gen3.posture_names, 0.1)
    values = [word for name, value in joints.items() for word in ("--joints", f"{name}={value}")]
    code, _, err = run("check", file, "--task", "sphere", *values)
    assert (code, err.count(TOLD)) == (1, 1)
    found = pinograsp.check(gen3, pinograsp.load_scene(file), "sphere", joints)
    assert found.warnings == (GUESSED,)
    assert found.to_json()["warnings"] == [GUESSED]
    assert "taken as millimetres" in found._repr_html_()


def test_why_tells_it_of_a_task_that_is_refused(file: Path, gen3: Robot) -> None:
    scene = pinograsp.load_scene(file).with_object_pose("sphere", Pose(position=(50.0, 0.0, 0.0)))
    found = pinograsp.explain(gen3, scene, "sphere", deadline=0.0)
    assert "is outside the enclosure" in (found.refusal or "")
    assert found.warnings == (GUESSED,)
