"""Mass and gravity instead of a force: one load and one mass for everybody who asks, wherever things fall."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from test_reverify import sealed

import pinograsp
from pinograsp import (
    Cone,
    Cylinder,
    FileError,
    InputError,
    Object,
    Pose,
    Result,
    Robot,
    Scene,
    Setup,
    Sphere,
    Task,
    Wrench,
    load_scene,
    plan,
    read_json,
    verify,
    write_json,
)
from pinograsp.assessment.judge import Judge
from pinograsp.descriptions.scene import STANDARD_GRAVITY
from pinograsp.errors import TaskError, UnknownNameError
from pinograsp.geometry.filled import center_of_mass, center_of_mass_world
from pinograsp.hold.mjcf import HandAndObject
from pinograsp.hold.options import HoldOptions
from pinograsp.problem import TaskModel, check_task
from pinograsp.verification.check import Verifier
from pinograsp.visualization.forces import LONGEST_ARROW, draw_forces

MASS = 0.2
G = STANDARD_GRAVITY
TILTED = (G * math.sin(0.5), 0.0, -G * math.cos(0.5))
"""World of a bench that leans by 0.5 rad."""


@pytest.fixture(scope="module")
def bare(glovebox: Scene) -> Scene:
    """The glovebox with a ball of MASS, and no wrench in the task."""
    ball = glovebox.objects["sphere"].model_copy(update={"mass": MASS})
    return glovebox.with_object("sphere", ball).with_task("sphere", wrench=None)


def falling(scene: Scene, gravity: Any) -> Scene:
    return scene.model_copy(update={"gravity": gravity})


def planned(robot: Robot, scene: Scene) -> Result:
    return plan(robot, scene, "sphere", starts=3, workers=1)


@pytest.fixture(scope="module")
def hanging(gen3: Robot, bare: Scene) -> Result:
    """A result of the leaning glovebox."""
    return planned(gen3, falling(bare, TILTED))


# ---- the load


def test_gravity_is_standard_gravity_down_z_if_a_scene_says_nothing(glovebox: Scene) -> None:
    assert glovebox.gravity == (0.0, 0.0, -9.80665)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, -G), TILTED, (0.0, 0.0, 1.62), (0.0, 0.0, 0.0)], ids=str)
def test_without_a_wrench_it_is_the_weight(bare: Scene, gravity: Any) -> None:
    scene = falling(bare, gravity)
    found = scene.wrench_of(scene.task("sphere"))
    np.testing.assert_allclose(found.force, MASS * np.array(gravity), rtol=1e-15)
    assert found.torque == (0.0, 0.0, 0.0)


def test_a_wrench_takes_the_place_of_the_weight(bare: Scene) -> None:
    wrench = Wrench(force=(1.0, 0.0, -5.0), torque=(0.0, 0.02, 0.0))
    scene = bare.with_task("sphere", wrench=wrench)
    assert scene.wrench_of(scene.task("sphere")) == wrench


def test_everybody_asks_for_the_same_load(gen3: Robot, hanging: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    """Problem, verification, assessment, hold test and picture."""
    setup, best = hanging.setup, hanging.grasps[0]
    weight = MASS * np.array(TILTED)
    wrench = np.concatenate([weight, np.zeros(3)])
    np.testing.assert_allclose(TaskModel(gen3, setup.scene, "sphere").load.wrench, wrench, rtol=1e-15)
    np.testing.assert_allclose(Judge(best).wrench, wrench, rtol=1e-15)
    held = HandAndObject(setup, HoldOptions()).model(best)
    np.testing.assert_allclose(held.gravity, TILTED, rtol=1e-14)
    assert f'mass="{MASS!r}"' in held.xml
    arrows: list[NDArray[np.float64]] = []
    monkeypatch.setattr("pinograsp.visualization.forces.draw_contact", lambda *_: None)
    monkeypatch.setattr("pinograsp.visualization.forces.draw_arrow", lambda _, tail, tip, __: arrows.append(tip - tail))
    draw_forces(
        {"contacts": {"left": None, "right": None}, "wrench": None}, best, setup.scene, setup.scene.task("sphere")
    )  # type: ignore[arg-type]
    greatest = max(float(np.linalg.norm(force)) for force in (weight, *(c.force for c in best.contacts)))
    np.testing.assert_allclose(arrows, [LONGEST_ARROW / greatest * weight], rtol=1e-12)
    assert f"({weight[0]:g}, 0, {weight[2]:g})" in setup.scene._repr_html_()


# ---- the mass


@pytest.mark.parametrize(
    ("mass", "force", "gravity", "expected"),
    [
        (0.3, None, (0.0, 0.0, -G), 0.3),
        (0.3, (0.0, 0.0, -2.0), (0.0, 0.0, -G), 0.3),
        (0.3, (0.0, 0.0, -2.0), (0.0, 0.0, 0.0), 0.3),
        (None, (0.0, 0.0, -2.0), (0.0, 0.0, -G), 2.0 / G),
        (None, (0.0, -1.2, 1.6), (0.0, 0.0, -1.6), 1.25),
        (None, (0.0, 0.0, 0.0), (0.0, 0.0, -G), None),
        (None, (0.0, 0.0, -2.0), (0.0, 0.0, 0.0), None),
    ],
)
def test_the_mass_is_the_objects_or_what_the_force_weighs(
    mass: float | None, force: Any, gravity: Any, expected: float | None, bare: Scene
) -> None:
    task = bare.task("sphere").model_copy(update={"wrench": None if force is None else Wrench(force=force)})
    ball = bare.objects["sphere"].model_copy(update={"mass": mass})
    changes = {"objects": {"sphere": ball}, "tasks": {"sphere": task}, "gravity": gravity}
    assert bare.model_copy(update=changes).mass_of(task) == pytest.approx(expected)


def test_in_another_gravity_a_force_is_another_mass(gen3: Robot, glovebox: Scene) -> None:
    """The certificate's accelerations go with it; without gravity there are none, and none can be asked for."""
    grasp = planned(gen3, glovebox).grasps[0]
    moon, orbit = falling(glovebox, (0.0, 0.0, -G / 6)), falling(glovebox, (0.0, 0.0, 0.0))
    on_earth, on_the_moon = (
        Verifier(gen3, scene, "sphere").certify(grasp.claim)["Q_force"].value for scene in (glovebox, moon)
    )
    assert on_the_moon == pytest.approx(on_earth / 6, rel=1e-6)
    assert Verifier(gen3, orbit, "sphere").resistance(grasp.claim) == ()
    with pytest.raises(TaskError, match=r"tasks\.sphere\.withstand: .*mass.*objects\.sphere\.mass"):
        Verifier(gen3, orbit.with_task("sphere", withstand=1.0), "sphere")
    with pytest.raises(TaskError, match=r"objects\.sphere\.mass: .*gravity"):
        HandAndObject(Setup(gen3.description, orbit, "sphere"), HoldOptions())


# ---- results


def test_mass_and_its_force_give_the_same_grasps(gen3: Robot, bare: Scene) -> None:
    by_mass = planned(gen3, bare)
    by_force = planned(gen3, bare.with_task("sphere", wrench=Wrench(force=(0.0, 0.0, -MASS * G))))
    assert by_mass.verified >= 2
    assert [grasp.to_json() for grasp in by_mass] == [grasp.to_json() for grasp in by_force]


def test_a_grasp_in_tilted_gravity_is_proven_from_its_file_alone(hanging: Result, tmp_path: Path) -> None:
    assert hanging.verified >= 2
    for grasp in hanging:
        force = sum(contact.force for contact in grasp.contacts)
        np.testing.assert_allclose(force, -MASS * np.array(TILTED), atol=1e-9)
    write_json(hanging, tmp_path / "result.json")
    again = read_json(tmp_path / "result.json")
    assert not again.altered
    assert again.setup.scene.gravity == TILTED
    assert verify(again) == ()


@pytest.mark.parametrize(
    ("path", "value"), [(("gravity", 2), -G), (("objects", "sphere", "mass"), 0.21)], ids=["gravity", "mass"]
)
def test_mass_and_gravity_of_a_file_count(path: Any, value: float, hanging: Result, tmp_path: Path) -> None:
    """Where no digest tells of it, the check does: a scene that was made in Python has one of its content, too."""
    file = tmp_path / "result.json"
    write_json(hanging, file)
    content = json.loads(file.read_text())
    block = content["setup"]["scene"]
    for key in path[:-1]:
        block = block[key]
    block[path[-1]] = value
    file.write_text(json.dumps(content))
    with pytest.raises(FileError, match=r"setup\.scene\.digest: is damaged") as caught:
        read_json(file)
    (content["setup"]["scene"]["digest"],) = re.findall(r'"([0-9a-f]{64})" follows', str(caught.value))
    content["provenance"]["sha256"]["scene"] = content["setup"]["scene"]["digest"]
    file.write_text(json.dumps(content))
    assert read_json(file).altered
    file.write_text(json.dumps(sealed(content)))
    assert "certificate.figures.force balance.value" in {found.what for found in verify(read_json(file))}


@pytest.mark.parametrize("made", [False, True], ids=["from a file", "made in Python"])
def test_files_from_before_there_was_gravity(made: bool, gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    """They are read, nothing in them counts as changed, and they are proven again."""
    centred = glovebox.objects["sphere"].model_copy(update={"center_of_mass": (0.0, 0.0, 0.0)})
    result = planned(gen3, glovebox.with_object("sphere", centred) if made else glovebox)
    file = tmp_path / "result.json"
    write_json(result, file)
    content = json.loads(file.read_text())
    del content["setup"]["scene"]["gravity"]
    content["setup"]["scene"]["objects"]["sphere"]["center_of_mass"] = [0.0, 0.0, 0.0]
    file.write_text(json.dumps(sealed(content)))
    again = read_json(file)
    assert not again.altered
    assert again.setup.scene.gravity == (0.0, 0.0, -G)
    assert verify(again) == ()


def test_where_nothing_falls(gen3: Robot, bare: Scene) -> None:
    """Nothing to balance: two pads that press against each other."""
    result = planned(gen3, falling(bare, (0.0, 0.0, 0.0)))
    assert result.verified >= 2
    left, right = result.grasps[0].contacts
    np.testing.assert_allclose(left.force, -right.force, atol=1e-12)
    assert result.grasps[0].certificate["Q_force"].value > 1.0


# ---- the centre of mass


def test_the_centre_of_mass_is_that_of_the_shape_if_none_is_given(glovebox: Scene) -> None:
    """Of a cone from its ends: h (r^2 + 2 r R + 3 R^2) / (4 (r^2 + r R + R^2)) above the end of radius r."""
    pose = Pose(position=(0.5, 0.1, 0.0), rpy=(math.pi / 2, 0.0, 0.0))
    funnel = Object(shape=Cone(bottom_radius=0.01, top_radius=0.03, height=0.08), pose=pose)
    above = 0.08 * (0.01**2 + 2 * 0.01 * 0.03 + 3 * 0.03**2) / (4 * (0.01**2 + 0.01 * 0.03 + 0.03**2)) - 0.04
    np.testing.assert_allclose(center_of_mass(funnel), [0.0, 0.0, above], atol=1e-15)
    np.testing.assert_allclose(center_of_mass_world(funnel), [0.5, 0.1 - above, 0.0], atol=1e-15)
    given = funnel.model_copy(update={"center_of_mass": (0.0, 0.0, 0.0)})
    np.testing.assert_allclose(center_of_mass_world(given), [0.5, 0.1, 0.0], atol=1e-15)
    tip = Cone(bottom_radius=0.01, top_radius=0.0, height=0.08)
    np.testing.assert_allclose(tip.centroid, [0.0, 0.0, -0.02], atol=1e-15)
    for shape in (Sphere(radius=0.1), Cylinder(radius=0.1, height=0.3)):
        assert shape.centroid == (0.0, 0.0, 0.0)


def test_an_error_of_the_centre_of_mass_is_from_where_it_is_by_default(hanging: Result) -> None:
    assert hanging.setup.scene.objects["sphere"].center_of_mass is None
    judge = Judge(hanging.grasps[0])
    assert judge.balances(judge.no_errors)
    assert not judge.balances(replace(judge.no_errors, center_of_mass=np.array([0.1, 0.1, 0.1])))


# ---- refused


def test_a_task_without_a_load_is_refused_where_it_stands(glovebox: Scene, tmp_path: Path) -> None:
    lines = glovebox.source.read_text().splitlines() if glovebox.source else []
    file = tmp_path / "scene.yaml"
    file.write_text("\n".join(line for line in lines if "wrench:" not in line) + "\n")
    with pytest.raises(InputError) as caught:
        load_scene(file)
    assert (caught.value.file, caught.value.key) == (file, "tasks.sphere")
    assert caught.value.line == lines.index("tasks:") + 2
    assert caught.value.problem == "no wrench is given, and object 'sphere' has no mass that would weigh"
    assert caught.value.remedy == "Give `objects.sphere.mass` in kg, or a wrench"


@pytest.mark.parametrize(
    ("update", "key", "words"),
    [
        ({"gravity": (0.0, 0.0)}, "gravity", "3 values are wanted"),
        ({"gravity": -9.81}, "gravity", "a list is wanted"),
        ({"gravity": (0.0, 0.0, math.nan)}, "gravity[2]", "finite"),
        ({"gravity": None}, "gravity", "a list is wanted"),
        ({"gravity": (0.0, 0.0, -1e9), "mass": 2.0}, "tasks.sphere", "weighs more than 1e+09 N"),
        ({"mass": -1.0}, "objects.sphere.mass", "greater than 0"),
        ({"mass": None}, "tasks.sphere", "no mass that would weigh"),
    ],
)
def test_bad_values(update: dict[str, Any], key: str, words: str, bare: Scene) -> None:
    content = yaml.safe_load(yaml.safe_dump(bare.to_dict()))
    if "mass" in update:
        content["objects"]["sphere"]["mass"] = update["mass"]
    with pytest.raises(InputError) as caught:
        Scene.from_dict(content | {name: value for name, value in update.items() if name != "mass"})
    assert caught.value.key == key
    assert words in str(caught.value)


def test_tasks_of_other_scenes(bare: Scene, glovebox: Scene) -> None:
    task = bare.task("sphere")
    with pytest.raises(TaskError, match=r"objects\.sphere\.mass: no wrench is given.* Give `objects\.sphere\.mass`"):
        glovebox.wrench_of(task)
    other: Task = task.model_copy(update={"object": "shpere"})
    for ask in (bare.wrench_of, bare.mass_of):
        with pytest.raises(UnknownNameError, match="sphere"):
            ask(other)


def test_a_centre_of_mass_far_outside_is_odd(gen3: Robot, glovebox: Scene) -> None:
    """Millimetres that are given for metres."""
    sphere = glovebox.objects["sphere"]
    assert check_task(TaskModel(gen3, glovebox, "sphere")) == []
    far = glovebox.with_object("sphere", sphere.model_copy(update={"center_of_mass": (1.0, 0.0, 0.0)}))
    odd, *_ = check_task(TaskModel(gen3, far, "sphere"))
    assert odd.startswith("the centre of mass of 'sphere' is at least 962.7 mm outside of it")


def test_a_list_of_points_has_an_end() -> None:
    points = [(0.0, 0.0, 0.001 * i) for i in range(1001)]
    assert len(pinograsp.Near(points=points[:1000], radius=0.01).points) == 1000
    with pytest.raises(InputError, match=r"no more than 1000 values are wanted \(1001 given\)"):
        pinograsp.Near(points=points, radius=0.01)
