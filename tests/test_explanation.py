"""Why a task finds no grasp: refusals before any start, causes, the nearest miss, and remedies that work."""

from __future__ import annotations

import copy
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from conftest import TOY_ROBOT, RobotFactory, SceneFactory

import pinograsp
from pinograsp import (
    Band,
    Body,
    Box,
    Cylinder,
    Explanation,
    Mesh,
    Object,
    Planner,
    Pose,
    Remedy,
    Scene,
    Sphere,
    TaskError,
)
from pinograsp.geometry.contact_faces import widest_room
from pinograsp.geometry.shapes import surface_of
from pinograsp.kinematics.robot import Robot
from pinograsp.mechanics import ContactModels, ForceLimits, carried, greatest_force, greatest_force_parallel
from pinograsp.planning.relaxations.variant import place
from pinograsp.problem import TaskModel
from pinograsp.problem.loads import check_load
from pinograsp.verification.certificate import Certificate, Figure
from pinograsp.visualization import colors
from pinograsp.visualization.offenders import offenders
from pinograsp.visualization.scene import draw_scene
from pinograsp.visualization.viewer import Recorder, Visualizer

UP, LIMITS = (0.0, 0.0, 0.222), ForceLimits(0.5, 0.0, 10.0, 0.01)
TWO = np.array([[0.0, 0.02, 0.0], [0.0, -0.02, 0.0]])
INWARD = np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])


@pytest.fixture(scope="module")
def room(make_toy_scene: SceneFactory) -> Scene:
    return make_toy_scene()


def odd(robot: Robot, scene: Scene) -> tuple[str, ...]:
    """Return the warnings that a task gets before it is solved."""
    with Planner(robot, scene, workers=1) as planner:
        return planner._models.checked("ball")[1]


def refused(robot: Robot, scene: Scene) -> TaskError:
    with pytest.raises(TaskError) as caught:
        odd(robot, scene)
    return caught.value


def explained(robot: Robot, scene: Scene) -> Explanation:
    return pinograsp.explain(robot, scene, "ball", starts=6, workers=1, deadline=300.0)


def boxed(room: Scene, size: tuple[float, float, float], contacts: Any, center: tuple[float, float, float]) -> Scene:
    """Return the room with a box in place of the ball."""
    box = Object(shape=Box(size=size), pose=Pose(position=center))
    return room.with_object("ball", box).with_task("ball", desired_contacts=contacts)


def test_a_torque_that_no_contacts_carry_is_refused_with_what_they_can(toy: Robot, room: Scene) -> None:
    """Of 5 N each at most, at the ball's radius and, of soft fingers, within their friction besides."""
    model = TaskModel(toy, room, "ball")
    radius = model.surface.radius_about(np.zeros(3))
    most = 5.0 * float((radius + 0.9 * model.contact_models.torsion_radius).sum())
    error = refused(toy, room.with_task("ball", wrench={"force": (0.0, 0.0, -0.1), "torque": (0.0, 1.01 * most, 0.0)}))
    assert "2 contacts on the object carry a torque of less than" in error.problem
    assert error.key == "tasks.ball.wrench"
    below = room.with_task("ball", wrench={"force": (0.0, 0.0, -0.1), "torque": (0.0, 0.99 * most, 0.0)})
    check_load(TaskModel(toy, below, "ball"))


def test_a_load_that_two_parallel_pads_cannot_carry_is_refused_with_what_they_can(toy: Robot, room: Scene) -> None:
    error = refused(toy, room.with_task("ball", wrench={"force": (0.0, 0.0, -30.0)}))
    # 2 sin(atan 0.9) 5 N
    assert "two pads that are parallel carry less than 6.69 N (max_force 5 N, friction 0.9)" in error.problem
    assert "the load is 30 N" in error.problem
    assert error.key == "tasks.ball.wrench"
    assert "a load of less than 6.68 N" in (error.remedy or "")


def test_a_mass_that_is_too_heavy_is_refused_at_its_own_key(toy: Robot, room: Scene) -> None:
    heavy = room.objects["ball"].model_copy(update={"mass": 3.0})
    error = refused(toy, room.with_object("ball", heavy).with_task("ball", wrench=None))
    assert error.key == "objects.ball.mass"
    assert "a mass of less than 0.682 kg" in (error.remedy or "")  # 6.69 N


def test_greatest_forces() -> None:
    assert greatest_force(3, LIMITS) == 30.0
    assert greatest_force_parallel(LIMITS) == 10.0  # along the normal: 2 sin(atan 0.5) is less than 1
    assert greatest_force_parallel(ForceLimits(1.0, 0.0, 10.0, 0.01)) == pytest.approx(10.0 * np.sqrt(2.0))


def test_what_two_contacts_carry() -> None:
    hard = ContactModels.hard(2, 1.0)
    weight = np.array([0.0, 0.0, -4.0, 0.0, 0.0, 0.0])
    # Each carries f sin(atan 0.5) across its normal.
    assert carried(TWO, INWARD, hard, LIMITS, weight) == pytest.approx(20.0 * np.sin(np.arctan(0.5)) / 4.0, rel=1e-5)
    # Contacts beside the centre of mass: hard fingers resist no torque about the line between them.
    aside = TWO + np.array([0.03, 0.0, 0.0])
    assert carried(aside, INWARD, hard, LIMITS, weight) == pytest.approx(0.0, abs=1e-6)
    soft = ContactModels(np.full(2, 0.01), np.ones(8))
    some = carried(aside, INWARD, soft, LIMITS, weight)
    assert some is not None
    # 2 m = 0.03 m g with norm(F, m / e) = 2 F_n and F_n at most f_max cos: m / e = 3 F across.
    assert 0.2 < some < 1.0


def test_desired_contacts_that_do_not_carry_the_load_are_warned_of(toy: Robot, room: Scene) -> None:
    off = room.objects["ball"].model_copy(update={"center_of_mass": (0.0, 0.02, 0.0)})
    (warning,) = odd(toy, room.with_object("ball", off))
    assert "forces within friction and force limits carry nothing of the 2 N" in warning


def test_desired_contacts_farther_apart_than_the_jaw_opens_are_warned_of(toy: Robot, room: Scene) -> None:
    scene = boxed(room, (0.16, 0.02, 0.02), [[0.08, 0.0, 0.0], [-0.08, 0.0, 0.0]], UP)
    (warning,) = odd(toy, scene)
    assert warning.startswith("the desired contacts are 160 mm apart, the pads open to 137 mm")


def test_desired_contacts_nearer_than_the_jaw_closes_are_warned_of(toy: Robot, room: Scene) -> None:
    scene = boxed(room, (0.02, 0.02, 0.02), [[0.01, 0.0, 0.0], [-0.01, 0.0, 0.0]], UP)
    (warning,) = odd(toy, scene.with_task("ball", joint_ranges={"slide_left": (0.03, 0.05)}))
    # 30 mm and 1.25 of them and 2 mm.
    assert warning.startswith("the desired contacts are 20 mm apart, the pads close to 69.5 mm")


def test_a_jaw_of_parallel_pads_that_closes_a_tenth_of_a_millimetre_too_little_is_told(toy: Robot, room: Scene) -> None:
    """The table of the hand has its ends."""
    for size, warned in ((0.0694, True), (0.06951, False)):
        scene = boxed(room, (size, 0.02, 0.02), [[0.5 * size, 0.0, 0.0], [-0.5 * size, 0.0, 0.0]], UP)
        found = odd(toy, scene.with_task("ball", joint_ranges={"slide_left": (0.03, 0.05)}))
        told = [warning for warning in found if "the desired contacts are 69.4 mm apart" in warning]
        assert (len(told) == 1) == warned


@pytest.mark.parametrize(("width", "warned"), [(0.0001, True), (0.0009, True), (0.0011, False)])
def test_desired_contacts_on_faces_too_narrow_for_the_rim_are_warned_of(
    width: float, warned: bool, toy: Robot, room: Scene
) -> None:
    """Half a millimetre from edges needs a face of a whole one."""
    scene = boxed(room, (0.04, width, 0.04), [[0.02, 0.0, 0.0], [-0.02, 0.0, 0.0]], UP)
    found = [warning for warning in odd(toy, scene) if "(reserve.rim)" in warning]
    shown = f"is on a face {1e3 * width:g} mm wide, and contacts keep 0.5 mm from edges"
    assert [warning.startswith(f"desired_contacts[{number}] {shown}") for number, warning in enumerate(found)] == (
        [True, True] if warned else []
    )


def test_how_wide_faces_are() -> None:
    cylinder, box = surface_of(Cylinder(radius=0.02, height=0.05)), surface_of(Box(size=(0.02, 0.03, 0.05)))
    assert widest_room(cylinder.contact_face(np.array([0.02, 0.0, 0.01]))) == pytest.approx(0.025)
    assert widest_room(cylinder.contact_face(np.array([0.01, 0.0, 0.025]))) == pytest.approx(0.02)
    assert widest_room(box.contact_face(np.array([0.01, 0.004, 0.01]))) == pytest.approx(0.015)
    assert widest_room(surface_of(Sphere(radius=0.02)).contact_face(np.array([0.02, 0.0, 0.0]))) == math.inf


def test_desired_contacts_that_parallel_pads_cannot_both_face_are_warned_of(toy: Robot, room: Scene) -> None:
    scene = boxed(room, (0.04, 0.04, 0.04), [[0.02, 0.0, 0.0], [0.0, 0.02, 0.0]], UP)
    warnings = odd(toy, scene)
    assert warnings[0].startswith(
        "the surface at the desired contacts is 90 ° from opposite, and the pads are parallel"
    )


def test_opposite_points_of_a_faceted_ball_are_opposite(toy: Robot, room: Scene, tmp_path: Path) -> None:
    """Facets beside them are turned by some degrees; pads feel the surface around."""
    trimesh.creation.icosphere(subdivisions=3, radius=0.025).export(tmp_path / "ball.stl")
    ball = room.objects["ball"].model_copy(update={"shape": Mesh(file=tmp_path / "ball.stl"), "center_of_mass": None})
    assert (
        odd(toy, room.with_object("ball", ball).with_task("ball", desired_contacts=[[0, 0.025, 0], [0, -0.025, 0]]))
        == ()
    )


def test_pads_that_face_away_in_every_posture_of_the_hand_are_told_so(make_toy: RobotFactory, room: Scene) -> None:
    """A warning where contacts are desired: other points might do; a refusal where pairs would have to be proposed."""
    pads = copy.deepcopy(TOY_ROBOT["pads"])
    for pad in pads:
        pad["patch"]["normal"][0] *= -1.0
    away, wanted = make_toy(pads=pads), "the two pads face each other in no posture of the hand that the task allows"
    assert wanted in odd(away, room)
    with pytest.raises(TaskError) as caught:
        pinograsp.plan(away, room.with_task("ball", desired_contacts=None), "ball", starts=1, workers=1)
    assert (caught.value.key, caught.value.problem) == ("tasks.ball.desired_contacts", wanted)
    assert caught.value.remedy == "Give a desired contact for each pad"


def test_a_plate_on_the_floor_has_no_faces_for_two_pads(toy: Robot, room: Scene) -> None:
    plate = boxed(room, (0.1, 0.1, 0.003), None, (0.0, 0.1, -0.1985))
    error = refused(toy, plate)
    assert "no opposite faces are far enough from other things; pads keep 5 mm" in error.problem
    assert "margin.enclosure" in (error.remedy or "")
    odd(toy, boxed(room, (0.1, 0.1, 0.02), None, (0.0, 0.1, -0.19)))  # of a thicker one the sides are far enough


def test_what_is_beyond_the_arm_is_refused_with_how_far(toy: Robot, room: Scene) -> None:
    error = refused(toy, room.with_object_pose("ball", Pose(position=(0.37, 0.2, 0.37))))
    distance = np.linalg.norm((0.37, 0.2, 0.37)) - 0.025
    assert f"is {distance:.2f} m from the first arm joint" in error.problem
    assert "towards the arm" in (error.remedy or "")


def test_an_object_that_weighs_and_hangs_a_little_above_something_is_remarked_on(toy: Robot, room: Scene) -> None:
    def shelf(gap: float) -> Scene:
        below = Pose(position=(0.0, 0.0, 0.222 - 0.025 - gap - 0.001))
        return heavy.with_obstacle("shelf", Body(shape=Box(size=(0.2, 0.2, 0.002)), pose=below))

    weighing = room.objects["ball"].model_copy(update={"mass": 0.2})
    heavy = room.with_object("ball", weighing).with_task("ball", wrench=None)
    assert odd(toy, heavy) == ()  # nothing is near: something holds it that the scene leaves out
    assert odd(toy, shelf(0.0)) == ()
    (warning,) = odd(toy, shelf(0.02))
    assert warning == "'ball' stands on nothing: it is 20.0 mm above 'shelf'"
    assert odd(toy, shelf(0.02).model_copy(update={"gravity": (0.0, 0.0, 0.0)})) == ()
    assert odd(toy, shelf(0.02).with_task("ball", wrench={"force": (0.0, 0.0, -2.0)})) == ()  # held by what is not said


@pytest.fixture(scope="module")
def narrow(toy: Robot, room: Scene) -> tuple[Scene, Explanation]:
    """Contact on a cap of the ball where no two points are opposite: 20 mm lower they are."""
    scene = room.with_task("ball", allowed_contacts=Band(z=(0.020, 0.024)))
    return scene, pinograsp.explain(toy, scene, "ball", starts=6, workers=1, deadline=0.0)


def test_a_failed_plan_has_causes_and_a_nearest_miss(narrow: tuple[Scene, Explanation]) -> None:
    _, explanation = narrow
    assert sum(cause.starts for cause in explanation.causes) == explanation.done == 6
    assert sum(cause.share for cause in explanation.causes) == pytest.approx(1.0)
    missed = explanation.nearest_miss
    assert missed is not None
    assert not missed.certificate.verified
    assert missed.setup is not None
    assert explanation.interrupted  # no time for remedies


def test_an_explanation_survives_the_file_of_its_result(
    toy: Robot, narrow: tuple[Scene, Explanation], tmp_path: Path
) -> None:
    scene, _ = narrow
    result = pinograsp.plan(toy, scene, "ball", starts=6, workers=1)
    file = tmp_path / "result.json"
    pinograsp.write_json(result, file)
    again = pinograsp.read_json(file)
    assert again == result
    assert not again.altered
    assert again.explanation is not None
    assert again.explanation.nearest_miss is not None
    assert again.explanation.nearest_miss.setup is again.setup
    content = json.loads(file.read_text())
    content["explanation"]["nearest_miss"]["q_arm"].append(0.0)
    damaged = tmp_path / "damaged.json"
    damaged.write_text(json.dumps(content))
    with pytest.raises(pinograsp.DamagedError) as caught:
        pinograsp.read_json(damaged)
    assert caught.value.key == "explanation.nearest_miss.q_arm"
    pinograsp.visualization.write_html(again, tmp_path / "miss.html")
    page = (tmp_path / "miss.html").read_text()
    assert "<h1>Nearest miss</h1>" in page
    assert "Not verified." in page
    assert "What kept starts from a grasp" in page


def test_results_with_grasps_have_no_explanation(toy: Robot, room: Scene, tmp_path: Path) -> None:
    result = pinograsp.plan(toy, room, "ball", starts=2, workers=1)
    assert result.explanation is None
    pinograsp.write_json(result, tmp_path / "result.json")
    assert "explanation" not in json.loads((tmp_path / "result.json").read_text())
    works = explained(toy, room)
    assert (works.verified, works.remedies, works.causes) == (6, (), ())


def test_a_remedy_is_for_the_scene_that_was_explained(room: Scene) -> None:
    remedy = Remedy("move object", "", 0.1, "m", {place("objects", "cube", "pose"): {"position": [0, 0, 0]}}, 1, 1)
    with pytest.raises(pinograsp.InputError, match=r"objects\.cube\.pose: this key is missing"):
        remedy.apply(room)


def test_offenders_are_what_figures_that_do_not_hold_are_about() -> None:
    figures = (
        Figure("obstacle clearance", 0.002, 0.005, "m", "at least", "left / post"),
        Figure("contact gap", 0.002, 0.00002, "m", "at most", "right"),
        Figure("enclosure clearance", 0.1, 0.005, "m", "at least", "arm / wall z=0"),
    )
    assert offenders(Certificate(figures)) == {"left", "post"}


def test_an_offender_has_its_colour_in_the_scene(room: Scene) -> None:
    scene = room.with_obstacle("post", Body(shape=Sphere(radius=0.02), pose=Pose(position=(0.0, 0.06, 0.12))))
    wall = next(iter(scene.enclosure.walls))
    for marked in ((), ("post", wall)):
        recorder = Recorder()
        draw_scene(Visualizer(window=recorder), scene, scene.task("ball"), marked)
        red = [command for command in recorder.commands if str(colors.OFFENDER) in str(command)]
        assert len(red) == len(marked)
