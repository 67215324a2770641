"""The hold test: forces that are known by hand, negative controls, links in the way, files.

Most of it with the toy: a jaw whose right finger moves 1.25 times as far as the left one, and 2 mm more.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from conftest import TOY_SCENE, TOY_URDF, RobotFactory, SceneFactory
from PIL import Image

import pinograsp
from pinograsp import HoldOptions, HoldOutcome, InputError, MissingExtraError, Progress, cli, hold_test
from pinograsp.descriptions import Scene
from pinograsp.descriptions.scene import STANDARD_GRAVITY as GRAVITY
from pinograsp.hold import film
from pinograsp.hold.film import write_film
from pinograsp.hold.library import pillow
from pinograsp.hold.mjcf import BEHIND, OBJECT, HandAndObject
from pinograsp.hold.simulation import Simulation
from pinograsp.hold.write import write_mjcf
from pinograsp.kinematics.robot import Robot
from pinograsp.results import Contact, Cost, Grasp, Result, Setup
from pinograsp.verification import Certificate, Figure

SQUEEZE, WEIGHT, FRICTION, RADIUS = 3.0, 2.0, 0.9, 0.025
LEFT = (2 * RADIUS - 0.002) / 2.25
"""Where the left finger touches a ball of this radius that the right one touches too, m."""
RIGHT = 1.25 * LEFT + 0.002
CENTER = (LEFT - RIGHT) / 2
SOFT = {"model": "soft_finger", "torsion_radius": 0.005, "torsional_stiffness": 1.0}
SHAPES: dict[str, dict[str, Any]] = {
    "sphere": {"type": "sphere", "radius": RADIUS},
    "cylinder": {"type": "cylinder", "radius": RADIUS, "height": 0.03},
    "box": {"type": "box", "size": [2 * RADIUS, 0.03, 0.03]},
}
PATCHES: dict[str, dict[str, Any]] = {
    "line": {"type": "line", "u": [-0.018, 0.018], "width": 0.01},
    "sphere": {"type": "sphere", "radius": 0.01, "u": [-0.5, 0.5], "v": [-0.5, 0.5]},
    "cylinder": {"type": "cylinder", "radius": 0.01, "u": [-0.018, 0.018], "v": [-0.5, 0.5]},
}

MakeGrasp = Callable[..., Grasp]


@pytest.fixture(scope="module")
def make_grasp(toy: Robot, make_toy_scene: SceneFactory) -> MakeGrasp:
    """Return a function that makes a grasp by hand: the fingers press with SQUEEZE and share the weight."""

    def make(robot: Robot = toy, shape: str = "sphere", contact: Any = SOFT, **changes: Any) -> Grasp:
        body = {"shape": SHAPES[shape], "pose": {"position": [CENTER, 0.0, 0.22]}}
        task = TOY_SCENE["tasks"]["ball"] | {"contact_model": contact, "desired_contacts": None} | changes
        scene = make_toy_scene(objects={"ball": body}, tasks={"ball": task})
        sides = (("left", 1.0), ("right", -1.0))
        contacts = tuple(
            Contact(
                pad=name,
                link=name,
                point=np.array([CENTER + side * RADIUS, 0.0, 0.22]),
                normal=np.array([side, 0.0, 0.0]),
                force=np.array([-side * SQUEEZE, 0.0, WEIGHT / 2]),
                spin_torque=0.0,
                desired_point=None,
                T_world_pad=np.eye(4),
            )
            for name, side in sides
        )
        angles = {"slide_left": LEFT, "slide_right": RIGHT}
        stiffness = robot.description.stiffness
        yielding = SQUEEZE * (1.0 / stiffness.joint + 1.0 / stiffness.contact)
        return Grasp(
            start=7,
            count=1,
            joints={"shoulder": 0.0, **angles},
            q_arm=np.zeros(1),
            synergy=np.array([LEFT]),
            contact_parameters=np.zeros(4),
            internal_forces=np.zeros(1),
            q_r={name: angle - yielding for name, angle in angles.items()},
            cost=Cost(0.0, 0.0, 0.0),
            contacts=contacts,
            certificate=Certificate((Figure("Q_force", 16.7, 0.0, "m/s^2", "at least"),)),
            T_world_wrist=np.eye(4),
            setup=Setup(robot.description, scene, "ball"),
        )

    return make


@pytest.fixture(scope="module")
def grasp(make_grasp: MakeGrasp) -> Grasp:
    return make_grasp()


@pytest.fixture(scope="module")
def result(grasp: Grasp) -> Result:
    assert grasp.setup is not None
    counts, grasps = {"converged": 2}, tuple(replace(grasp, start=start) for start in range(2))
    return Result(grasp.setup, grasps, starts=2, counts=counts, verified=2, refuted=0, blocked={})


@pytest.fixture(scope="module")
def outcome(grasp: Grasp) -> HoldOutcome:
    options = HoldOptions(controls=True, first_slip=True)
    (found,) = hold_test(grasp, workers=1, options=options)
    return found


def simulated(grasp: Grasp, **options: Any) -> HoldOutcome:
    (found,) = hold_test(grasp, workers=1, options=HoldOptions(**options))
    return found


# What holds, and what does not.


def test_a_grasp_of_the_ball_holds(outcome: HoldOutcome) -> None:
    assert outcome.held
    assert outcome.failed == ()
    assert outcome.touching == ()
    assert outcome.distance < 1e-4
    assert [pad.pad for pad in outcome.pads] == ["left", "right"]
    assert [pad.planned for pad in outcome.pads] == [SQUEEZE, SQUEEZE]
    assert outcome.force_error < 0.01
    assert (outcome.grasp, outcome.start, outcome.predicted) == (1, 7, 16.7)


def test_json_has_the_attributes(outcome: HoldOutcome) -> None:
    data = json.loads(json.dumps(outcome.to_json(), allow_nan=False))
    assert data.keys() == {field.name for field in fields(outcome)}
    assert data["controls"] == {"no squeeze": False, "no friction": False}
    assert data["pads"] == [{"pad": pad.pad, "planned": pad.planned, "measured": pad.measured} for pad in outcome.pads]
    assert outcome.first_slip is not None
    assert data["first_slip"]["acceleration"] == outcome.first_slip.acceleration
    assert (data["start"], data["held"], data["failed"]) == (7, True, [])
    with pytest.raises(TypeError, match="item assignment"):
        outcome.controls["no squeeze"] = True  # type: ignore[index]


def test_the_controls_drop_it(outcome: HoldOutcome) -> None:
    assert outcome.controls == {"no squeeze": False, "no friction": False}


def test_first_slip_is_that_of_coulomb(outcome: HoldOutcome) -> None:
    """Upwards the weight helps: 2 mu N = m (g + a). What is above are the moments until it has moved by 1 mm."""
    expected = 2 * FRICTION * SQUEEZE / (WEIGHT / GRAVITY) - GRAVITY
    assert outcome.first_slip is not None
    assert outcome.first_slip.slipped
    assert outcome.first_slip.direction == "+z"
    assert 1.0 < outcome.first_slip.acceleration / expected < 1.08
    assert outcome.first_slip.touching == ()


def test_hard_fingers_do_not_stop_a_spin_about_their_line(make_grasp: MakeGrasp) -> None:
    found = simulated(make_grasp(contact=None))
    assert found.failed == ("spin +x", "spin -x")
    assert not found.held


def test_a_shake_that_is_too_strong_is_found(grasp: Grasp) -> None:
    found = simulated(grasp, acceleration=20.0, spin=0.0)
    assert "shake +z" in found.failed
    assert "shake -z" not in found.failed  # the weight holds against it
    assert not any(phase.startswith("spin") for phase in found.failed)


@pytest.mark.parametrize("shape", ["cylinder", "box"])
def test_lines_and_areas_of_contact(make_grasp: MakeGrasp, shape: str) -> None:
    found = simulated(make_grasp(shape=shape, contact=None), acceleration=3.0)
    assert found.held
    assert found.force_error < 0.01


@pytest.mark.parametrize("kind", PATCHES)
def test_patches(make_toy: RobotFactory, make_grasp: MakeGrasp, toy: Robot, kind: str) -> None:
    """Curved pads touch where the flat one does: in the middle of its face."""
    pads = toy.description.model_dump()["pads"]
    for pad, side in zip(pads, (1.0, -1.0), strict=True):
        frame = {key: pad["patch"][key] for key in ("normal", "x_axis")}
        inwards = PATCHES[kind].get("radius", 0.0)
        pad["patch"] = frame | PATCHES[kind] | {"origin": [side * inwards, 0.0, 0.02]}
    found = simulated(make_grasp(make_toy(pads=_plain(pads))), acceleration=3.0, spin=3.0)
    assert found.failed == ()
    assert found.force_error < 0.01


def test_servos_at_the_reference_press_as_planned(make_toy: RobotFactory, make_grasp: MakeGrasp) -> None:
    """q_r - q is what joints and pads give way under the planned forces, each with its own stiffness."""
    robot = make_toy(stiffness={"joint": 5000.0, "contact": 10000.0})
    found = simulated(make_grasp(robot), control="position", acceleration=2.0)
    assert "gravity" not in found.failed
    assert found.force_error < 0.03
    assert found.sag > 0.5 * WEIGHT / 2 / 10000.0


def test_driver_torque_is_that_of_virtual_work(grasp: Grasp) -> None:
    assert grasp.setup is not None
    model = HandAndObject(grasp.setup, HoldOptions()).model(grasp)
    np.testing.assert_allclose(model.slack, [SQUEEZE * (1.0 + 1.25)], rtol=1e-12)
    np.testing.assert_allclose(model.gravity, [0.0, 0.0, -GRAVITY], atol=1e-12)
    np.testing.assert_allclose(model.inertia, 0.4 * WEIGHT / GRAVITY * RADIUS**2 * np.eye(3), atol=1e-12)


def test_a_link_in_the_way_is_reported(make_toy: RobotFactory, make_grasp: MakeGrasp) -> None:
    top = 0.22 - RADIUS + 1e-4
    box = f'<collision><origin xyz="0 0 {top / 2}"/><geometry><box size="0.04 0.04 {top}"/></geometry></collision>'
    robot = make_toy(TOY_URDF.replace('<link name="arm">', f'<link name="arm">{box}'))
    found = simulated(make_grasp(robot))
    assert found.touching == ("arm",)
    slip = simulated(make_grasp(robot), first_slip=True).first_slip
    assert slip is not None
    assert slip.touching == ("arm",)
    assert "settle" not in simulated(make_grasp(robot), squeeze=False).failed  # without a squeeze the ball lies on it


def test_the_pad_is_in_front_of_its_link(grasp: Grasp) -> None:
    assert grasp.setup is not None
    model = Simulation(HandAndObject(grasp.setup, HoldOptions()).model(grasp), HoldOptions()).model
    names = [model.geom(k).name for k in range(model.ngeom)]
    assert {name.split(":")[0] for name in names} == {"object", "pad", "link"}
    left = model.mesh("link:left:0")
    vertices = model.mesh_vert[left.vertadr[0] : left.vertadr[0] + left.vertnum[0]]
    assert vertices[:, 0].max() - vertices[:, 0].min() == pytest.approx(0.01 - BEHIND, abs=1e-6)


def test_a_planned_grasp_of_the_real_robot(gen3: Robot, glovebox: Scene) -> None:
    best = pinograsp.plan(gen3, glovebox, "sphere", starts=3, workers=1).best
    assert best is not None
    found = simulated(best, controls=True, spin=0.0)
    assert found.failed == ()
    assert found.force_error < 0.03
    assert found.controls == {"no squeeze": False, "no friction": False}


# Runs.


def test_outcomes_do_not_depend_on_the_run(result: Result, outcome: HoldOutcome) -> None:
    seen: list[Progress] = []
    options = HoldOptions(controls=True, first_slip=True)
    found = hold_test(result, workers=2, options=options, progress=seen.append)
    assert found == (replace(outcome, start=0), replace(outcome, grasp=2, start=1))
    assert seen == [Progress("grasps", number, 2, {"held": number}) for number in (1, 2)]
    assert len(hold_test(result, 1, workers=1)) == 1


def test_ctrl_c_gives_what_is_done(result: Result) -> None:
    def interrupt(_: object) -> None:
        raise KeyboardInterrupt

    assert [done.grasp for done in hold_test(result, workers=1, progress=interrupt)] == [1]


def test_without_mujoco(grasp: Grasp, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r"^the hold test needs MuJoCo. Run pip install 'pinograsp\[hold\]'$"):
        hold_test(grasp)


def test_without_pillow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(MissingExtraError, match=r"^a film needs Pillow. Run pip install 'pinograsp\[hold\]'$"):
        pillow()


@pytest.mark.parametrize(
    ("wrong", "key"),
    [
        ({"slip_angle": 0.0}, "slip_angle"),
        ({"ramp": math.nan}, "ramp"),
        ({"acceleration": -1.0}, "acceleration"),
        ({"friction": 0.0}, "friction"),
        ({"control": "voltage"}, "control"),
    ],
)
def test_options_that_make_no_sense(wrong: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError, match=rf"^{key}: "):
        HoldOptions(**wrong)


def test_input_that_cannot_be_used(grasp: Grasp, make_grasp: MakeGrasp) -> None:
    with pytest.raises(InputError, match="best"):
        hold_test(grasp, 0)
    with pytest.raises(InputError, match=r"^grasp: belongs to no result"):
        hold_test(replace(grasp, setup=None))
    with pytest.raises(InputError, match=r"objects\.ball\.mass"):
        hold_test(make_grasp(wrench={"force": [0.0, 0.0, 0.0]}), workers=1)


# Files.


def test_the_model_opens_and_holds(grasp: Grasp, tmp_path: Path) -> None:
    """As a viewer runs it: no controls, gravity on from the beginning."""
    write_mjcf(grasp, tmp_path / "hold.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "hold.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    before = data.body(OBJECT).xpos.copy()
    np.testing.assert_allclose(before, [CENTER, 0.0, 0.22], atol=1e-9)
    mujoco.mj_step(model, data, 1000)
    assert np.linalg.norm(data.body(OBJECT).xpos - before) < 1e-3


def test_a_film(grasp: Grasp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, seen = tmp_path / "hold.gif", list[Progress]()
    monkeypatch.setattr(film, "_RATE", 4.0)
    try:
        write_film(grasp, file, HoldOptions(acceleration=2.0), progress=seen.append)
    except InputError as error:
        pytest.skip(str(error))
    assert seen == [Progress("film", done, 14) for done in range(15)]  # settle, gravity, 6 shakes, 6 spins
    with Image.open(file) as image:
        assert image.n_frames > 5
        colours = [image.convert("RGB").getpixel((k, 240)) for k in range(0, 640, 8)]
    assert len(set(colours)) > 5


def test_no_film(grasp: Grasp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"\.gif"):
        write_film(grasp, tmp_path / "hold.mp4")
    monkeypatch.setattr(film, "_BACKENDS", ("pencil",))
    monkeypatch.setenv("MUJOCO_GL", "pencil")
    with pytest.raises(InputError, match=r"no film can be drawn on this machine \(pencil: ModuleNotFoundError"):
        write_film(grasp, tmp_path / "hold.gif")


def test_command_line(
    result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pinograsp.write_json(result, tmp_path / "result.json")
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> tuple[int, str]:
        monkeypatch.setattr(sys, "argv", ["pinograsp", "hold", "result.json", "--workers", "1", *arguments])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        captured = capsys.readouterr()
        return int(ended.value.code or 0), captured.out + captured.err

    names = f"{result.scene}_{result.task}_{result.robot}"
    code, output = run("--controls", "--mjcf", "--out", "out")
    assert code == 0
    assert "2 of 2 grasps hold" in output
    assert output.count("3.00  3.00") == 4  # of two grasps, measured and planned
    assert "control with no squeeze: drops every object" in output
    assert f"written: out/{names}_grasp1.xml\n" in output
    assert (tmp_path / "out" / f"{names}_grasp1.xml").exists()
    written = json.loads((tmp_path / "out" / f"{names}_hold.json").read_text())
    code, output = run("--controls", "--json")
    assert code == 0
    found = json.loads(output)
    for outcome in (*found["outcomes"], *written["outcomes"]):
        assert outcome.pop("seconds") > 0.0
    assert found == written
    assert [outcome["grasp"] for outcome in found["outcomes"]] == [1, 2]
    code, output = run("--grasp", "2", "--acceleration", "20", "--spin", "0")
    assert code == 1
    assert "0 of 1 grasps hold" in output
    assert "grasp 2 does not: " in output
    code, output = run("--grasp", "3")
    assert code == 2
    assert "--grasp: no grasp 3: there are 2, numbered from 1" in output
    code, output = run("--grasp", "1", "--best", "1")
    assert code == 2
    assert "--grasp: is given with --best. Give one of them" in output
    monkeypatch.setattr(pinograsp, "hold_test", lambda *_, **__: ())  # Ctrl-C before the first outcome
    code, output = run()
    assert code == 130
    assert output == "interrupted before the first outcome: nothing is known of any grasp\n"
    code, output = run("--film")
    assert code == 2
    assert "--film: is a file to write. Give its folder with --out" in output
    assert "grasps hold" not in output  # nothing was simulated for it
    code, output = run("--spin", "inf")
    assert code == 2
    assert "--spin: must be a finite number, not inf" in output


def _plain(data: Any) -> Any:
    """Return data with lists for tuples, as YAML has them."""
    if isinstance(data, dict):
        return {key: _plain(value) for key, value in data.items()}
    return [_plain(value) for value in data] if isinstance(data, (list, tuple)) else data
