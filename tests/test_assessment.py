"""Assessments: a hand that closes again on a displaced object, verdicts, margins that can be computed by hand."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import TOY_URDF, Array, RobotFactory, SceneFactory, differences
from scipy.spatial.transform import Rotation

import pinograsp
from pinograsp import Errors, InputError, Progress, assess, cli
from pinograsp.assessment import closing
from pinograsp.assessment.closing import Closing, moved
from pinograsp.assessment.errors import FRICTION as FRICTION_PARTS
from pinograsp.assessment.errors import SAMPLES, draws
from pinograsp.assessment.judge import Judge
from pinograsp.assessment.margins import KINDS, margin_of
from pinograsp.assessment.outcome import wilson
from pinograsp.assessment.verdict import LOST, OFF_PAD, SLIPS, TOUCHES
from pinograsp.geometry.shapes import surface_of
from pinograsp.kinematics.robot import Robot
from pinograsp.results import Contact, Cost, Grasp, Result, Setup, write_json
from pinograsp.verification import Certificate
from pinograsp.verification.balance import BalanceProblem
from pinograsp.verification.check import Verifier

RADIUS, SQUEEZE, WEIGHT, FRICTION, TORSION = 0.025, 3.0, 2.0, 0.9, 0.005
OPENING = (2 * RADIUS - 0.002) / 2.25
"""Of the toy's jaw on something 50 mm wide: the right finger slides 1.25 times as far as the left one and 2 mm more."""
MIDDLE = OPENING - RADIUS
"""Where the middle between the pads is along x."""
SOFT = {"model": "soft_finger", "torsion_radius": TORSION, "torsional_stiffness": 1.0}
BALL = {"type": "sphere", "radius": RADIUS}
BOX = {"type": "box", "size": [2 * RADIUS, 0.03, 0.02]}
CAN = {"type": "cylinder", "radius": RADIUS, "height": 0.03}

NAMES = "toy_room_ball_toy"
"""How files about the toy in its scene begin."""

Make = Callable[..., Grasp]


@pytest.fixture
def make_grasp(toy: Robot, make_toy_scene: SceneFactory) -> Make:
    """Return a function that puts something between the middles of the toy's pads, x across, the pads' u along z."""

    def make(shape: dict[str, Any] = BALL, contact_model: dict[str, Any] | None = SOFT, **task: Any) -> Grasp:
        scene = make_toy_scene(
            objects={"ball": {"shape": shape, "pose": {"position": [MIDDLE, 0.0, 0.22]}}},
            tasks={
                "ball": {
                    "object": "ball",
                    "desired_contacts": [[RADIUS, 0.0, 0.0], [-RADIUS, 0.0, 0.0]],
                    "wrench": {"force": [0.0, 0.0, -WEIGHT]},
                    "contact": {"friction": FRICTION},
                    "contact_model": contact_model,
                }
                | task
            },
        )
        return grasp_of(toy, Setup(toy.description, scene, "ball"))

    return make


def grasp_of(toy: Robot, setup: Setup) -> Grasp:
    contacts = tuple(
        Contact(
            pad=side,
            link=side,
            point=np.array([MIDDLE + sign * RADIUS, 0.0, 0.22]),
            normal=np.array([sign, 0.0, 0.0]),
            force=np.array([-sign * SQUEEZE, 0.0, 0.5 * WEIGHT]),
            spin_torque=0.0,
            desired_point=np.array([MIDDLE + sign * RADIUS, 0.0, 0.22]),
            T_world_pad=np.eye(4),
        )
        for side, sign in (("left", 1.0), ("right", -1.0))
    )
    posture = np.array([0.0, OPENING, RADIUS - MIDDLE])[: toy.posture_size]
    return Grasp(
        start=0,
        count=1,
        joints=toy.joints_by_name(posture),
        q_arm=posture[:1],
        synergy=posture[1:],
        contact_parameters=np.zeros(4),
        internal_forces=np.zeros(1),
        q_r={},
        cost=Cost(0.0, 0.0, 0.0),
        contacts=contacts,
        certificate=Certificate(()),
        T_world_wrist=np.eye(4),
        setup=setup,
    )


def closed(judge: Judge, **errors: Any) -> Array:
    """Return the pose of the object after the hand has closed."""
    draw = replace(judge.no_errors, **{name: np.array(value) for name, value in errors.items()})
    T, _ = moved(judge.T_world_object, draw.position, draw.orientation)
    return judge.closing.closed(judge.grasp.q_arm + draw.joints, T).T_world_object


def judged(judge: Judge, **errors: Any) -> Any:
    arrays = {name: np.array(value) if isinstance(value, list) else value for name, value in errors.items()}
    return judge.verdict(replace(judge.no_errors, **arrays))


# The hand that closes again.


def test_steps_where_the_damping_is_lost_in_rounding() -> None:
    """As between the faces of a thin sheet, which the hand may turn about as it likes."""
    H = np.diag([1e12, 1e12, 0.0])
    np.testing.assert_allclose(closing._solution(H, np.array([2e12, 0.0, 0.0])), [2.0, 0.0, 0.0], atol=1e-9)
    regular = np.array([[2.0, 1.0], [1.0, 3.0]])
    np.testing.assert_allclose(regular @ closing._solution(regular, np.array([1.0, 2.0])), [1.0, 2.0])


def test_planned_grasp_is_what_the_verification_takes_it_for(make_grasp: Make) -> None:
    grasp = make_grasp()
    assert grasp.setup is not None
    certificate = Verifier(grasp.setup.robot, grasp.setup.scene, "ball").check(grasp.claim)
    assert certificate.verified, certificate.refuted_by


@pytest.mark.parametrize("offset", [0.004, -0.01])
def test_jaw_pushes_the_ball_back(make_grasp: Make, offset: float) -> None:
    judge = Judge(make_grasp())
    T = closed(judge, position=[offset, 0.0, 0.0])
    np.testing.assert_allclose(T, judge.T_world_object, atol=1e-7)
    assert judged(judge, position=[offset, 0.0, 0.0]).margin == pytest.approx(judged(judge).margin, abs=1e-5)


def test_ball_stays_where_the_jaw_does_not_push(make_grasp: Make) -> None:
    judge = Judge(make_grasp())
    T = closed(judge, position=[0.003, 0.005, -0.004], orientation=[0.1, 0.2, -0.3])
    expected, _ = moved(judge.T_world_object, np.array([0.0, 0.005, -0.004]), np.array([0.1, 0.2, -0.3]))
    np.testing.assert_allclose(T, expected, atol=3e-6)


def test_box_turns_until_it_is_flush(make_grasp: Make) -> None:
    judge = Judge(make_grasp(BOX))
    T = closed(judge, orientation=[0.0, 0.05, 0.08])
    np.testing.assert_allclose(T[:3, :3], np.eye(3), atol=1e-5)
    about_x = closed(judge, orientation=[0.06, 0.0, 0.0])  # the jaw does not feel it
    np.testing.assert_allclose(about_x[:3, :3], Rotation.from_rotvec([0.06, 0.0, 0.0]).as_matrix(), atol=1e-6)


def test_can_is_pushed_and_turned_by_the_least_motion(make_grasp: Make) -> None:
    """Its axis ends in the plane between the pads, at its projection on that plane, and turns the shortest way."""
    judge, offset, turn = Judge(make_grasp(CAN)), np.array([0.003, 0.002, -0.004]), np.array([0.05, 0.09, -0.3])
    displaced, _ = moved(judge.T_world_object, offset, turn)
    axis = displaced[:3, 2]
    flush = np.array([0.0, axis[1], axis[2]])
    across = np.cross(axis, flush)
    angle = math.asin(np.linalg.norm(across) / np.linalg.norm(flush))
    expected, _ = moved(displaced, np.array([-offset[0], 0.0, 0.0]), angle * across / np.linalg.norm(across))
    np.testing.assert_allclose(closed(judge, position=offset, orientation=turn), expected, atol=1e-5)


def test_hand_of_many_synergies_yields_before_the_object(make_toy: RobotFactory, make_grasp: Make) -> None:
    """Fingers that slide on their own reach a ball where it is, as far as they go; then it gives way."""
    urdf = TOY_URDF.replace('<mimic joint="slide_left" multiplier="1.25" offset="0.002"/>', "")
    toy = make_toy(urdf, hand={"synergies": [{"joint": "slide_left"}, {"joint": "slide_right"}]})
    setup = make_grasp().setup
    assert setup is not None
    judge = Judge(grasp_of(toy, replace(setup, robot=toy.description)))
    np.testing.assert_allclose(closed(judge, position=[0.004, 0.0, 0.0])[0, 3], MIDDLE + 0.004, atol=5e-6)
    np.testing.assert_allclose(closed(judge, position=[-0.025, 0.0, 0.0])[0, 3], -RADIUS, atol=1e-7)


def test_arm_error_moves_the_ball_along_the_jaw_alone(make_grasp: Make) -> None:
    """The shoulder turns about y at the world's origin, 220 mm below the ball."""
    judge, angle = Judge(make_grasp()), 0.01
    T = closed(judge, joints=[angle])
    R = Rotation.from_rotvec([0.0, angle, 0.0]).as_matrix()
    pushed = R.T @ T[:3, 3]  # in the frame of the arm
    assert pushed[0] == pytest.approx(MIDDLE, abs=1e-7)
    along_pads = R.T @ judge.T_world_object[:3, 3]
    np.testing.assert_allclose(pushed[1:], along_pads[1:], atol=1e-6)


@pytest.mark.parametrize("shape", [BALL, BOX, CAN])
def test_derivatives(mixed_toy: Robot, shape: dict[str, Any]) -> None:
    """Flat, curved and line pads, from 3 mm above the surface: a box's corners and edges have no derivatives."""
    surface = surface_of(pinograsp.descriptions.scene.Body.model_validate({"shape": shape}).shape)
    T, _ = moved(np.eye(4), np.array([MIDDLE, 0.001, 0.219]), np.array([0.1, -0.2, 0.3]))
    hand = np.concatenate([[OPENING], mixed_toy.parameter_limits.mean(axis=1)])
    closing = Closing(mixed_toy, surface, np.zeros(1), hand, T)
    z = np.concatenate([[0.001, -0.002, 0.0005, 0.003, 0.002, -0.004], closing._as_planned[6:]])
    jacobian = closing._place(np.array([0.1]), T, z).jacobian
    numeric = differences(lambda z: closing._place(np.array([0.1]), T, z).values, z, 1e-7)
    np.testing.assert_allclose(jacobian, numeric, atol=1e-6 * np.abs(numeric).max())


# Verdicts.


def test_contact_at_the_rim(make_grasp: Make) -> None:
    """The pads end 8 mm from their middle along y and 18 mm along z."""
    judge = Judge(make_grasp())
    assert judged(judge, position=[0.0, 0.0079, 0.0]).holds
    assert judged(judge, position=[0.0, 0.0081, 0.0]).cause == OFF_PAD
    assert judged(judge, position=[0.0, 0.0, 0.0179]).holds
    assert judged(judge, position=[0.0, 0.0, 0.0181]).cause == OFF_PAD


def test_contact_slides_along_its_footprint(make_grasp: Make) -> None:
    """The side of the box, 20 mm high, is on the pads, 36 mm high, until it is 28 mm too high."""
    judge = Judge(make_grasp(BOX))
    for z in (0.015, 0.027):
        verdict = judged(judge, position=[0.0, 0.0, z])
        assert verdict.holds, verdict
        np.testing.assert_allclose(closed(judge, position=[0.0, 0.0, z])[:3, 3], [MIDDLE, 0.0, 0.22 + z], atol=1e-5)
    assert judged(judge, position=[0.0, 0.0, 0.029]).cause in {OFF_PAD, LOST}


def test_palm_touches(make_grasp: Make) -> None:
    """The arm ends 15 mm below the ball."""
    judge = Judge(make_grasp())
    assert judged(judge, position=[0.0, 0.0, -0.0149]).holds
    verdict = judged(judge, position=[0.0, 0.0, -0.0151])
    assert verdict.cause == TOUCHES
    assert verdict.where == "arm / ball"


def test_object_out_of_reach(make_grasp: Make) -> None:
    verdict = judged(Judge(make_grasp()), position=[0.0, 0.1, 0.0])
    assert (verdict.cause, verdict.margin) == (OFF_PAD, -math.inf)


def test_jaw_that_cannot_close(make_toy: RobotFactory, make_grasp: Make) -> None:
    """A jaw that ends 2.25 mm before the ball."""
    toy = make_toy(TOY_URDF.replace('lower="0.0" upper="0.06"', f'lower="{OPENING + 0.001}" upper="0.06"'))
    setup = make_grasp().setup
    assert setup is not None
    verdict = judged(Judge(grasp_of(toy, replace(setup, robot=toy.description))))
    assert (verdict.cause, verdict.margin) == (LOST, -math.inf)


def test_sphere_slips_below_its_least_friction(make_grasp: Make) -> None:
    judge = Judge(make_grasp())
    assert judged(judge, friction=1.01 / 3.0).holds
    verdict = judged(judge, friction=0.99 / 3.0)
    assert verdict.cause == SLIPS
    assert -0.05 < verdict.margin < 0.0


def test_balance_where_the_cone_solver_gives_up(make_grasp: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    judge = Judge(make_grasp())
    assert judged(judge).holds
    monkeypatch.setattr(BalanceProblem, "margin", lambda *_: math.nan)
    assert judged(judge).cause == SLIPS


def test_region_is_counted_and_holds(make_grasp: Make) -> None:
    judge = Judge(make_grasp(BOX, allowed_contacts={"type": "half_space", "normal": [0.0, 0.0, 1.0], "offset": -0.009}))
    verdict = judged(judge)
    assert verdict.holds
    assert verdict.off_region
    allowed = {"type": "half_space", "normal": [0.0, 0.0, 1.0], "offset": -0.011}
    assert not judged(Judge(make_grasp(BOX, allowed_contacts=allowed))).off_region


# Margins.


def test_least_friction_by_hand(make_grasp: Make) -> None:
    margin = margin_of(Judge(make_grasp()), "friction")
    assert margin.size == pytest.approx((WEIGHT / 2) / SQUEEZE, rel=2e-3)
    assert margin.size >= (WEIGHT / 2) / SQUEEZE * (1.0 - 1e-6)  # it holds at what is reported


def test_largest_weight_by_hand(make_grasp: Make) -> None:
    assert margin_of(Judge(make_grasp()), "weight").size == pytest.approx(2 * FRICTION * SQUEEZE / WEIGHT, rel=1e-5)


def test_center_of_mass_by_hand(make_grasp: Make) -> None:
    """Across the jaw: two spin torques e sqrt((mu N)^2 - (w / 2)^2) carry w times the offset."""
    margin = margin_of(Judge(make_grasp()), "center of mass")
    spin = TORSION * math.sqrt((FRICTION * SQUEEZE) ** 2 - (WEIGHT / 2) ** 2)
    assert margin.size == pytest.approx(2 * spin / WEIGHT, rel=1e-5)
    assert margin.where in {"+y", "-y"}
    judge = Judge(make_grasp())
    assert judged(judge, center_of_mass=[0.0, 0.99 * margin.size, 0.0]).holds
    assert judged(judge, center_of_mass=[0.0, 1.01 * margin.size, 0.0]).cause == SLIPS


def test_hard_fingers_do_not_resist_a_spin(make_grasp: Make) -> None:
    assert margin_of(Judge(make_grasp(contact_model=None)), "center of mass").size == 0.0


def test_position_margin_is_the_distance_from_the_rim(make_grasp: Make) -> None:
    """The rim of the pads is 8 mm away, the arm 15 mm, and along the jaw the ball gives way."""
    margin = margin_of(Judge(make_grasp()), "position")
    assert margin.size == pytest.approx(0.008, rel=0.02)
    assert margin.size <= 0.008 + 1e-3 * RADIUS  # by how much a pad may be tilted
    assert margin.cause == OFF_PAD
    assert margin.where in {"+y", "-y"}


def test_joint_margin(make_grasp: Make) -> None:
    """A turn of the shoulder slides the ball along the pads by what cosine and sine say, until the arm touches it."""
    margin = margin_of(Judge(make_grasp()), "joint")
    assert margin.where in {"+shoulder", "-shoulder"} or margin.capped
    judge = Judge(make_grasp())
    for sign in (1.0, -1.0):
        assert judged(judge, joints=[sign * margin.size]).holds


# Whole assessments.


def test_no_errors(make_grasp: Make) -> None:
    found = assess(make_grasp(), replace(Errors.none(), friction=(FRICTION, FRICTION)), samples=3, workers=1)
    assert found.share == 1.0
    assert [margin.kind for margin in found.margins] == list(KINDS)
    assert all(margin.size > 0.0 for margin in found.margins)
    assert found.causes == {}
    margins = {sample.verdict.margin for sample in found.samples}
    assert margins == {found.without_errors.margin}


@pytest.mark.parametrize("friction", [0.0, 0.05])
def test_slippery(make_grasp: Make, friction: float) -> None:
    found = assess(make_grasp(), Errors(friction=(friction, friction)), samples=6, workers=1)
    assert found.share == 0.0
    assert found.causes == {SLIPS: 6}
    assert found.worst is not None
    assert found.worst.verdict.margin == min(sample.verdict.margin for sample in found.samples) < 0.0


def test_share_of_a_known_probability(make_grasp: Make) -> None:
    """Friction alone, uniform in 0.2 .. 0.6, is enough from a third on: two thirds hold."""
    found = assess(make_grasp(), replace(Errors.none(), friction=(0.2, 0.6)), samples=150, seed=3, workers=1)
    low, high = found.interval
    assert low < 2.0 / 3.0 < high
    assert found.holding == sum(sample.errors.friction >= 1.0 / 3.0 for sample in found.samples)


def test_seed_and_workers(make_grasp: Make) -> None:
    grasp = make_grasp()
    errors = Errors(position=0.006, orientation=0.3, friction=(0.2, 0.6))
    one = assess(grasp, errors, samples=20, seed=4, workers=1).to_json()
    assert one == assess(grasp, errors, samples=20, seed=4, workers=2).to_json()
    assert one != assess(grasp, errors, samples=20, seed=5, workers=1).to_json()
    assert 0 < one["holding"] < 20
    assert json.loads(json.dumps(one, allow_nan=False)) == one


def test_json_has_the_attributes(make_grasp: Make) -> None:
    found = assess(make_grasp(), Errors(position=0.006, friction=(0.2, 0.6)), samples=12, seed=4, workers=1)
    data = found.to_json()
    properties = {"done", "holding", "share", "interval", "causes", "off_region", "worst"}
    assert data.keys() == {field.name for field in fields(found)} | properties
    assert data["errors"] == {"friction": [0.2, 0.6], "position": 0.006} | {
        name: found.to_json()["errors"][name] for name in ("orientation", "weight", "center_of_mass", "joint")
    }
    assert (data["asked"], data["done"], data["holding"]) == (12, 12, found.holding)
    assert data["interval"] == list(found.interval)
    assert data["causes"] == found.causes
    assert [sample["verdict"]["holds"] for sample in data["samples"]] == [s.verdict.holds for s in found.samples]
    assert data["samples"][3]["errors"]["position"] == found.samples[3].errors.position.tolist()
    assert found.worst is not None
    assert data["worst"]["number"] == found.worst.number
    assert [margin["size"] for margin in data["margins"]] == [margin.size for margin in found.margins]
    assert data["without_errors"]["holds"] is True
    for margin in found.margins:
        assert found.margin(margin.kind) is margin
    with pytest.raises(KeyError, match=r"there is no 'positions'\. Did you mean position"):
        found.margin("positions")
    with pytest.raises(ValueError, match="read-only"):
        found.samples[0].errors.position[0] = 0.0


def test_interrupted(make_grasp: Make) -> None:
    def stop(progress: Progress) -> None:
        if progress == Progress("samples", 4, 10):
            raise KeyboardInterrupt

    found = assess(make_grasp(), samples=10, workers=1, progress=stop)
    assert found.interrupted
    assert found.done == 4
    assert found.margins == ()
    whole = assess(make_grasp(), samples=10, workers=1)
    assert [sample.to_json() for sample in found.samples] == [sample.to_json() for sample in whole.samples[:4]]


def test_grasp_that_fails_without_errors(make_grasp: Make) -> None:
    grasp = make_grasp()
    loose = tuple(replace(c, force=c.force * np.array([0.1, 1.0, 1.0])) for c in grasp.contacts)
    found = assess(replace(grasp, contacts=loose), samples=2, workers=1)
    assert found.without_errors.cause == SLIPS
    assert found.margins == ()


def test_draws_are_as_large_as_they_may_be() -> None:
    errors = Errors(0.003, 0.2, (0.5, 0.7), (0.9, 1.3), 0.001, 0.01)
    drawn = draws(errors, 400, 3, 0)
    for name, size in (("position", 0.003), ("orientation", 0.2), ("center_of_mass", 0.001)):
        lengths = np.array([np.linalg.norm(getattr(draw, name)) for draw in drawn])
        assert 0.97 * size < lengths.max() <= size
        assert np.mean(lengths < 0.5 * size) == pytest.approx(1 / 8, abs=0.05)  # uniform in the ball
    joints = np.array([draw.joints for draw in drawn])
    assert joints.shape == (400, 3)
    assert 0.0099 < joints.max() <= 0.01
    assert -0.01 <= joints.min() < -0.0099
    assert all(0.5 <= draw.friction <= 0.7 and 0.9 <= draw.weight <= 1.3 for draw in drawn)
    first = draws(errors, 5, 3, 0)
    assert [draw.to_json() for draw in first] == [draw.to_json() for draw in drawn[:5]]


def test_wilson() -> None:
    assert wilson(9, 10) == pytest.approx((0.59585, 0.98212), abs=1e-5)
    assert wilson(0, 20) == pytest.approx((0.0, 0.16113), abs=1e-5)
    assert wilson(20, 20) == pytest.approx((0.83887, 1.0), abs=1e-5)
    assert wilson(0, 0) == (0.0, 1.0)


# Hostile input.


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("position", -1e-3),
        ("position", math.nan),
        ("position", math.inf),
        ("position", "2 mm"),
        ("position", True),
        ("orientation", 4.0),
        ("friction", (0.9, 0.1)),
        ("friction", 0.5),
        ("friction", (0.1, 0.2, 0.3)),
        ("weight", (0.5, math.nan)),
        ("weight", (-1.0, 1.0)),
        ("weight", None),
        ("center_of_mass", 2.0),
        ("joint", -0.1),
    ],
)
def test_bad_errors(key: str, value: Any) -> None:
    with pytest.raises(InputError) as refused:
        Errors(**{key: value})
    assert refused.value.key == key


@pytest.mark.parametrize(
    ("key", "arguments"),
    [
        ("samples", {"samples": 0}),
        ("samples", {"samples": 1.5}),
        ("seed", {"seed": -1}),
        ("workers", {"workers": 0}),
        ("errors", {"errors": {"position": 0.1}}),
    ],
)
def test_bad_arguments(make_grasp: Make, key: str, arguments: dict[str, Any]) -> None:
    with pytest.raises(InputError) as refused:
        assess(make_grasp(), **arguments)
    assert refused.value.key == key


def test_grasp_without_setup(make_grasp: Make) -> None:
    with pytest.raises(InputError, match="belongs to no result"):
        assess(replace(make_grasp(), setup=None))


# The command line.


@pytest.fixture
def run(
    make_grasp: Make, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Callable[..., tuple[int, str, str]]:
    """Return a function that runs `pinograsp assess` on a result of one grasp."""
    grasp = make_grasp()
    assert grasp.setup is not None
    result = Result(grasp.setup, (grasp,), 1, {"converged": 1}, verified=1, refuted=0, blocked={})
    write_json(result, tmp_path / "result.json")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "160")

    def run_once(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["pinograsp", "assess", "result.json", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        captured = capsys.readouterr()
        return int(ended.value.code or 0), captured.out, captured.err

    return run_once


def test_command(run: Any, tmp_path: Path) -> None:
    options = ["--samples", 8, "--workers", 1, "--position", 9, "--friction", 0.05, 0.6, "--out", "out"]
    code, output, errors = run("--grasp", 1, *options)
    assert (code, errors) == (0, "")
    found = json.loads((tmp_path / "out" / f"{NAMES}_grasp1_assessment.json").read_text())
    assert found["errors"]["position"] == pytest.approx(0.009)
    assert found["errors"]["friction"] == [0.05, 0.6]
    assert found["number"] == 1
    assert f"{found['holding']} of 8 samples hold" in output
    for cause, count in found["causes"].items():
        assert any(cause in line and str(count) in line for line in output.splitlines())
    assert "from 0.33" in output
    assert "mm" in output
    assert f"written: out/{NAMES}_grasp1_assessment.json\n" in output


@pytest.mark.parametrize("number", [0, 2, -1])
def test_grasp_out_of_range(run: Any, number: int) -> None:
    code, output, errors = run("--grasp", number)
    assert (code, output) == (2, "")
    assert f"result.json: --grasp: no grasp {number}: there are 1, numbered from 1" in errors
    assert errors.count("\n") == 1


def test_json_is_what_python_has(run: Any, make_grasp: Make) -> None:
    code, output, errors = run("--samples", 4, "--workers", 1, "--json")
    assert (code, errors) == (0, "")
    names = {"robot": "toy", "scene": "toy_room", "task": "ball", "number": 1}
    assert json.loads(output) == names | assess(make_grasp(), samples=4, workers=1).to_json()


def test_defaults_in_the_help_are_those_of_errors(run: Any) -> None:
    _, output, _ = run("--help")
    words = " ".join(output.split())
    errors = Errors()
    assert f"sets of errors that are drawn. [default: ({SAMPLES})" in words.lower()
    assert f"position, mm. [default: ({1e3 * errors.position:g})" in words
    assert f"orientation, degrees. [default: ({math.degrees(errors.orientation):g})" in words
    assert f"Factors of the load. [default: ({errors.weight[0]} and {errors.weight[1]})" in words
    assert f"centre of mass, mm. [default: ({1e3 * errors.center_of_mass:g})" in words
    assert f"sliding ones, mm. [default: ({1e3 * errors.joint:g})" in words
    assert f"[default: ({FRICTION_PARTS[0]} and {FRICTION_PARTS[1]} times the task's)]" in words


def test_bad_size_on_the_command_line(run: Any) -> None:
    code, _, errors = run("--position", -1)
    assert code == 2
    assert errors == "error: --position -1.0 mm: must be at least 0 m, not -0.001\n"


def test_ctrl_c_gives_what_is_done(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    verdict = Judge.verdict

    def stopped(judge: Judge, draw: Any) -> Any:
        seen.append(1)
        if len(seen) == 5:  # the planned grasp and three samples are done
            raise KeyboardInterrupt
        return verdict(judge, draw)

    monkeypatch.setattr(Judge, "verdict", stopped)
    code, output, _ = run("--samples", 20, "--workers", 1)
    assert code == 130
    assert "of 3 samples hold" in output
    assert "interrupted" in output
