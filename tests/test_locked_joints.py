"""Locked joints, and joint ranges of no width: from the task to the starts, the solver and the certificate."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import TOY_ROBOT, TOY_SCENE, TOY_URDF, RobotFactory

from pinograsp import Planner, Result, Robot, Scene, SolverOptions, Verifier, load_scene, plan
from pinograsp.database.build import build_database
from pinograsp.database.cache import cached_database
from pinograsp.database.query import spread_configurations
from pinograsp.database.store import Database
from pinograsp.descriptions.task import JointInterval
from pinograsp.errors import InputError, TaskError, UnknownNameError
from pinograsp.problem import GraspProblem, TaskModel
from pinograsp.solve.local import LocalSolver
from pinograsp.solve.projection import initial_guesses
from pinograsp.solve.recorder import Recorder, program_from
from pinograsp.solve.start_index import HeldHand, StartIndex
from pinograsp.solve.starts import LOCK_SLACKS, starts_near
from pinograsp.verification.claim import Claim
from pinograsp.verification.preferences import ranges_figure

STARTS = 20
TURN = 2.0 * math.pi
KNUCKLE = "robotiq_85_left_knuckle_joint"


def model_of(robot: Robot, scene: Scene, **changes: Any) -> TaskModel:
    return TaskModel(robot, scene.with_task("sphere", **changes), "sphere")


@pytest.fixture(scope="module")
def database(gen3: Robot, glovebox: Scene) -> Database:
    return cached_database(gen3, glovebox, glovebox.tasks["sphere"].margin, workers=2)


@pytest.fixture(scope="module")
def locked(gen3: Robot, glovebox: Scene) -> Result:
    """joint_7 is continuous, 7.0 is 0.72 and a turn."""
    return plan(gen3, glovebox.with_task("sphere", lock={"joint_7": 7.0}), "sphere", starts=STARTS, workers=1)


# ---- bounds


@pytest.mark.parametrize(
    ("name", "value", "bound"),
    [
        ("joint_6", 0.5, 0.5),
        ("joint_6", -2.07, -2.07),  # at the end of the reserve
        ("joint_6", 2.09 - 0.02, 2.07),  # there but for rounding
        ("joint_1", 0.0, 0.0),
        ("joint_1", 3.5, 3.5 - TURN),
        ("joint_7", -40.0, -40.0 + 6 * TURN),
        (KNUCKLE, 0.0, 0.0),
        (KNUCKLE, 0.8, 0.8),
    ],
)
def test_a_lock_and_a_range_of_no_width_are_the_same(
    gen3: Robot, glovebox: Scene, name: str, value: float, bound: float
) -> None:
    i = gen3.posture_names.index(name)
    for task in ({"lock": {name: value}}, {"joint_ranges": {name: (value, value)}}):
        model = model_of(gen3, glovebox, **task)
        assert model.lower[i] == model.upper[i] == pytest.approx(bound, abs=1e-12)
        others = np.arange(len(gen3.posture_names)) != i
        assert (model.lower < model.upper)[others].all()
        np.testing.assert_array_equal(GraspProblem(model, (0, 1)).free[:8], others)


@pytest.mark.parametrize(
    ("ranges", "lock", "bound"),
    [
        ({"joint_6": (0.0, 1.0)}, {"joint_6": 0.5}, 0.5),
        ({"joint_6": (0.5, 1.0)}, {"joint_6": 0.5}, 0.5),
        ({"joint_7": (3.0, 3.6)}, {"joint_7": 3.1}, 3.1 - TURN),  # both a turn lower
        ({"joint_7": (3.0, 3.6)}, {"joint_7": 3.1 + TURN}, 3.1 - TURN),
        ({"joint_7": (3.0, 3.6)}, {"joint_7": -3.0}, -3.0),
    ],
)
def test_a_lock_within_the_range_of_its_joint(
    gen3: Robot, glovebox: Scene, ranges: dict[str, Any], lock: dict[str, float], bound: float
) -> None:
    model, i = model_of(gen3, glovebox, joint_ranges=ranges, lock=lock), gen3.posture_names.index(next(iter(lock)))
    assert model.lower[i] == model.upper[i] == pytest.approx(bound)


@pytest.mark.parametrize(
    ("task", "key", "kind", "words"),
    [
        (
            {"lock": {"joint_6": 2.5}},
            "lock.joint_6",
            TaskError,
            ["2.5 is outside the limits [-2.07, 2.07] of the robot, less the task's reserve of 0.02. Give"],
        ),
        (
            {"lock": {"joint_6": 2.08}},
            "lock.joint_6",
            TaskError,
            ["2.08 is outside the limits [-2.07, 2.07]", "Give a value within them, or a smaller reserve.joint"],
        ),
        (
            {"lock": {KNUCKLE: 0.81}},
            f"lock.{KNUCKLE}",
            TaskError,
            ["0.81 is outside the limits [0, 0.8] of the robot. "],
        ),
        (
            {"lock": {"joint_6": 0.5}, "joint_ranges": {"joint_6": (-1.0, 0.4)}},
            "lock.joint_6",
            TaskError,
            ["0.5 is outside joint_ranges.joint_6, [-1, 0.4]. Give the lock alone, or a range that holds it"],
        ),
        (
            {"lock": {"joint_7": 0.5}, "joint_ranges": {"joint_7": (3.0, 3.6)}},
            "lock.joint_7",
            TaskError,
            ["0.5 is outside joint_ranges.joint_7, [3, 3.6]"],
        ),
        (
            {"lock": {"joint_8": 0.0}},
            "lock.joint_8",
            UnknownNameError,
            ["no arm joint or synergy", "Did you mean joint_"],
        ),
        (
            {"lock": {"robotiq_85_mimic_left_finger_tip_joint": 0.0}},
            "lock.robotiq_85_mimic_left_finger_tip_joint",
            UnknownNameError,
            [f"It mimics {KNUCKLE}"],
        ),
        ({"joint_ranges": {"joint_6": (2.2, 2.2)}}, "joint_ranges.joint_6", TaskError, ["[2.2, 2.2] does not meet"]),
    ],
)
def test_lock_that_does_not_suit_the_robot(
    gen3: Robot, glovebox: Scene, task: dict[str, Any], key: str, kind: type[InputError], words: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        model_of(gen3, glovebox, **task)
    assert (type(caught.value), caught.value.key, caught.value.file) == (kind, f"tasks.sphere.{key}", None)
    for word in words:
        assert word in str(caught.value)


def test_a_lock_in_a_file(gen3: Robot, tmp_path: Path) -> None:
    text = Path(str(load_scene("glovebox").source)).read_text()
    file = tmp_path / "scene.yaml"
    file.write_text(text.replace("    object: sphere\n", "    object: sphere\n    lock: {joint_6: 3, joint_7: 0}\n"))
    assert load_scene(file).tasks["sphere"].lock == {"joint_6": 3.0, "joint_7": 0.0}
    with pytest.raises(TaskError) as caught:
        TaskModel(gen3, load_scene(file), "sphere")
    assert (caught.value.file, caught.value.key) == (file, "tasks.sphere.lock.joint_6")


def test_a_smaller_reserve_lets_a_lock_nearer_to_the_limit(gen3: Robot, glovebox: Scene) -> None:
    model = model_of(gen3, glovebox, lock={"joint_6": 2.08}, reserve={"joint": 0.01})
    assert model.lower[5] == model.upper[5] == 2.08


# ---- starts


def test_starts_come_from_near_the_value_and_are_set_to_it(database: Database, gen3: Robot, glovebox: Scene) -> None:
    model = model_of(gen3, glovebox, lock={"joint_3": 3.5, "joint_6": 1.0})
    few, many = (starts_near(database, model, count, 0) for count in (5, 2000))
    center, radius = model.load.center_of_mass, model.task.start_radius
    rows = spread_configurations(database, center, radius, 10**6).q
    assert len(few) == 5
    assert len(many) == min(2000, len(rows))  # as many as the region has, however far from the value
    for starts in (few, many):
        assert (starts[:, 2] == 3.5 - TURN).all()
        assert (starts[:, 5] == 1.0).all()
    off = np.array([distance(start, rows) for start in (*few, *many)])
    assert off[:5].max() <= LOCK_SLACKS[0]
    steps = np.searchsorted(LOCK_SLACKS, off[5:])
    assert (np.diff(steps) >= 0).all()  # the nearest first
    assert steps[-1] > 1


def distance(start: Any, rows: Any) -> float:
    """Return how far the row that a start was made from is from the values of joint_3 and joint_6, rad."""
    [same] = np.flatnonzero((rows[:, [0, 1, 3, 4, 6]] == start[[0, 1, 3, 4, 6]]).all(axis=1))
    off = rows[same][[2, 5]] - [3.5, 1.0]
    return float(max(abs(math.remainder(off[0], TURN)), abs(off[1])))


def test_starts_in_memory_are_set_to_the_value(database: Database, gen3: Robot, glovebox: Scene) -> None:
    model = model_of(gen3, glovebox, lock={"joint_3": 3.5, KNUCKLE: 0.3})
    index, hand = StartIndex(database, gen3.mounted(glovebox.mounting.matrix)), HeldHand(model)
    assert hand.synergies.tolist() == [0.3]
    starts = index.starts(model, hand, model.desired_points[None], 100)
    assert len(starts) == 100
    assert (starts[:, 2] == 3.5 - TURN).all()
    assert (starts[:, 7] == 0.3).all()
    misses = hand.misses(starts[:, :7], model.desired_points)
    assert (np.diff(misses) >= 0.0).all()  # by where the pads are with the joint at its value
    assert misses[0] < 0.15**2


SLIDER = TOY_URDF.replace('name="shoulder" type="revolute"', 'name="shoulder" type="prismatic"')


def test_a_slider_is_locked(make_toy: RobotFactory, tmp_path: Path) -> None:
    """Its slack is a tenth, in metres: the room is 0.6 m along y."""
    toy = make_toy(SLIDER.replace('lower="-1.5" upper="1.5"', 'lower="-0.25" upper="0.25"'))
    task = TOY_SCENE["tasks"]["ball"] | {"lock": {"shoulder": 0.05}, "start_radius": 1.0}
    scene = Scene.from_dict(TOY_SCENE | {"tasks": {"ball": task}})
    with build_database(toy, scene, tmp_path / "toy.duckdb", size=2000, workers=1) as rows:
        model = TaskModel(toy, scene, "ball")
        assert model.robot.step_units[0] == 0.1
        starts = starts_near(rows, model, 50, 0)
        assert len(starts) == 50
        assert (starts[:, 0] == 0.05).all()


# ---- the solver


def test_a_locked_variable_is_none_of_the_program(gen3: Robot, glovebox: Scene) -> None:
    model = model_of(gen3, glovebox, lock={"joint_3": 0.4, KNUCKLE: 0.3})
    problem = GraspProblem(model, (0, 1))
    x = 0.5 * (problem.lower + problem.upper)
    program = program_from(Recorder(problem, 1e-4), x)
    assert len(program.start) == len(program.lower) == len(x) - 2
    assert (program.lower < program.upper).all()
    z = program.start + 0.01
    value, gradient = program.cost(z)
    (_, equal_jacobian), (unequal, jacobian) = program.equalities(z), program.inequalities(z)
    assert gradient.shape == z.shape
    assert equal_jacobian.shape == (program.equality_count, len(z))
    assert jacobian.shape == (program.inequality_count, len(z))
    full = x.copy()
    full[problem.free] += 0.01 * model.robot.step_units[problem.free]
    evaluation = problem.evaluate(full)
    assert value == pytest.approx(evaluation.cost, rel=1e-12)
    np.testing.assert_allclose(unequal, evaluation.inequalities.values, atol=1e-12)


@pytest.mark.parametrize("lock", [{"joint_3": 0.4}, {"joint_1": 0.3, KNUCKLE: 0.3}])
def test_the_projection_leaves_locked_joints_where_they_are(gen3: Robot, glovebox: Scene, lock: Any) -> None:
    """And its steps count on the others alone: it gets there in few steps."""
    problem = GraspProblem(model_of(gen3, glovebox, lock=lock), (0, 1))
    start = 0.5 * (problem.lower + problem.upper)
    start[:7] = np.clip([0.1, 0.6, 0.4, 1.6, 0.0, 0.9, 1.5], problem.lower[:7], problem.upper[:7])
    for guess in initial_guesses(problem, start, "contacts and clearance"):
        for name, value in lock.items():
            assert guess[gen3.posture_names.index(name)] == value
        assert (guess >= problem.lower).all()
        assert (guess <= problem.upper).all()


def test_cobyla_keeps_a_locked_joint(gen3: Robot, glovebox: Scene) -> None:
    model = model_of(gen3, glovebox, lock={"joint_7": 0.7})
    start = np.array([0.1, 0.6, 0.4, 1.6, 0.0, 0.9, 0.7, 0.3])
    options = SolverOptions(algorithm="LN_COBYLA", max_evaluations=40, tries=1)
    assert LocalSolver(model, options).solve(0, start).x[6] == 0.7


# ---- grasps


def test_grasps_have_the_joint_at_its_value(locked: Result) -> None:
    assert locked.verified >= 0.8 * STARTS
    assert locked.refuted == 0
    for grasp in locked.grasps:
        assert grasp.joints["joint_7"] == pytest.approx(7.0 - TURN, abs=1e-12)
        figure = grasp.certificate["joint ranges"]
        assert figure.value == pytest.approx(0.0, abs=1e-12)
        assert (figure.where, figure.limit, figure.unit) == ("joint_7", -1e-9, "rad")
        assert figure.holds


@pytest.mark.parametrize(
    "lock", [{"joint_1": 0.0}, {"joint_4": 1.5}, {"joint_6": 2.07}, {"joint_3": 0.0, "joint_7": 1.5}]
)
def test_any_joint_may_be_locked(gen3: Robot, glovebox: Scene, lock: dict[str, float]) -> None:
    """At the end of its limits less the reserve, too."""
    result = plan(gen3, glovebox.with_task("sphere", lock=lock), "sphere", starts=10, workers=1)
    assert result.verified >= 5
    assert result.refuted == 0
    for grasp in result.grasps:
        for name, value in lock.items():
            assert grasp.joints[name] == pytest.approx(value, abs=1e-12)
        assert grasp.certificate["joint reserve"].value >= 0.02 - 1e-9


def test_the_hand_alone_moves_where_the_arm_is_locked(gen3: Robot, glovebox: Scene, locked: Result) -> None:
    [grasp, *_] = locked.grasps
    arm = {name: grasp.joints[name] for name in gen3.description.arm.joints}
    scene = glovebox.with_task("sphere", lock=arm)
    again = plan(gen3, scene, "sphere", starts=2, workers=1)
    assert again.verified == 2
    assert pytest.approx(grasp.cost.U, rel=1e-3) == again.grasps[0].cost.U
    np.testing.assert_allclose(again.grasps[0].q_arm, grasp.q_arm, atol=1e-12)


def test_a_planner_gives_locked_grasps_at_once_and_checks_others(gen3: Robot, glovebox: Scene, locked: Result) -> None:
    [grasp, *_] = locked.grasps
    scene = glovebox.with_task("sphere", lock={KNUCKLE: grasp.joints[KNUCKLE], "joint_7": 0.7})
    with Planner(gen3, scene, workers=1) as planner:
        found = list(planner.grasps("sphere", most=2))
        assert found  # the first may be as good as any can be: then it is the last
        for other in found:
            assert other.joints[KNUCKLE] == pytest.approx(grasp.joints[KNUCKLE], abs=1e-12)
            assert other.joints["joint_7"] == pytest.approx(0.7, abs=1e-12)
        check = planner.check("sphere", {**grasp.joints, "joint_7": 0.6})
        assert check.certificate["joint ranges"].value == pytest.approx(-0.1)
        assert not check.verified


# ---- the certificate


@pytest.mark.parametrize(
    ("intervals", "endless", "depth", "where"),
    [
        ([("lock", "a", 1.0, 1.0)], (), 0.0, "a"),
        ([("lock", "a", 0.9, 0.9)], (), -0.1, "a"),
        ([("lock", "a", 1.0 - TURN, 1.0 - TURN)], (), -TURN, "a"),
        ([("lock", "a", 1.0 - TURN, 1.0 - TURN)], ("a",), 0.0, "a"),
        ([("joint_ranges", "a", 0.0, 0.7), ("lock", "a", 1.0, 1.0)], (), -0.3, "a"),  # one of both is not kept
        ([("lock", "a", 1.2, 1.2), ("joint_ranges", "a", 0.0, 2.0)], (), -0.2, "a"),
        ([("lock", "a", 1.0, 1.0), ("joint_ranges", "b", 0.0, 1.5)], (), -0.5, "b"),
    ],
)
def test_depth_of_locks_and_ranges(intervals: Any, endless: Any, depth: float, where: str) -> None:
    figure = ranges_figure([JointInterval(*interval) for interval in intervals], {"a": 1.0, "b": 2.0}, endless)
    assert figure.value == pytest.approx(depth, abs=1e-12)
    assert figure.where == where
    assert figure.holds == (depth == 0.0)


def test_a_grasp_off_the_value_is_refuted(gen3: Robot, glovebox: Scene, locked: Result) -> None:
    [grasp, *_] = locked.grasps
    for off, holds in ((0.0, True), (5e-10, True), (1e-8, False)):
        scene = glovebox.with_task("sphere", lock={"joint_7": 7.0 + off})
        certificate = Verifier(gen3.description, scene, "sphere").check(grasp.claim)
        assert [figure.name for figure in certificate.refuted_by] == ([] if holds else ["joint ranges"])


def test_verifier_refuses_a_lock_of_no_joint(gen3: Robot, glovebox: Scene) -> None:
    with pytest.raises(UnknownNameError, match=r"lock\.joint_8: the URDF has no movable joint 'joint_8'"):
        Verifier(gen3.description, glovebox.with_task("sphere", lock={"joint_8": 0.0}), "sphere")


def test_a_synergy_of_several_joints_is_locked(make_toy: RobotFactory) -> None:
    """By its own name, in its own units."""
    hand = {"synergies": [{"name": "close", "joints": {"slide_left": 0.5}, "limits": [0.0, 0.1]}]}
    toy = make_toy(**{key: value for key, value in TOY_ROBOT.items() if key == "stiffness"}, hand=hand)
    scene = Scene.from_dict(TOY_SCENE).with_task("ball", lock={"close": 0.05})
    model = TaskModel(toy, scene, "ball")
    assert model.lower[1] == model.upper[1] == 0.05
    joints = toy.joints_by_name(np.array([0.0, 0.05]))
    assert joints["slide_left"] == pytest.approx(0.025)
    points = np.zeros((2, 3))

    certificate = Verifier(toy.description, scene, "ball").check(Claim(joints, points, points, np.zeros(2)))
    assert certificate["joint ranges"].value == pytest.approx(0.0, abs=1e-12)
