"""What a task may prefer: a cone of approach directions and joint ranges, from the file to the certificate."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from conftest import TOY_ROBOT, TOY_SCENE, Array, RobotFactory, SceneFactory

from pinograsp import DirectionCone, InputError, Result, Robot, SolverOptions, plan
from pinograsp.database.build import build_database
from pinograsp.database.store import Database
from pinograsp.descriptions import Scene
from pinograsp.descriptions.pose import Pose
from pinograsp.descriptions.task import ApproachCone, JointInterval
from pinograsp.problem import GraspProblem, TaskModel, Violation
from pinograsp.problem.constraints.approach import Approach
from pinograsp.results import Grasp
from pinograsp.solve.local import LocalSolver
from pinograsp.solve.starts import RANGE_SLACK, starts_near
from pinograsp.verification import Certificate, Claim
from pinograsp.verification.check import Verifier
from pinograsp.verification.preferences import approach_figure, ranges_figure

STARTS = 20
DOWN = {"direction": (0.0, 0.0, -1.0), "angle": 0.3}
KNUCKLE = "robotiq_85_left_knuckle_joint"


def preferring(scene: Scene, **keys: Any) -> Scene:
    """Return the glovebox with keys of the task replaced."""
    content = scene.model_dump()
    content["tasks"]["sphere"] |= keys
    return Scene.model_validate(content)


def approach_of(grasp: Grasp, robot: Robot, scene: Scene) -> Array:
    """Return the wrist's z axis at a grasp, world, by Pinocchio from the URDF as it is on disk."""
    model = pin.buildModelFromUrdf(str(robot.description.urdf_file))
    q = pin.neutral(model)
    for name, angle in grasp.joints.items():
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = angle if joint.nq == 1 else (math.cos(angle), math.sin(angle))
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    wrist = data.oMf[model.getFrameId(robot.description.arm.wrist)].rotation[:, 2]
    return np.asarray(scene.mounting.matrix[:3, :3] @ wrist)


def check(grasp: Grasp, robot: Robot, scene: Scene) -> Certificate:
    """Return what the verification says of a grasp in another task."""
    points, forces = (np.array([getattr(c, name) for c in grasp.contacts]) for name in ("point", "force"))
    claim = Claim(grasp.joints, points, forces, np.zeros(len(points)))
    return Verifier(robot.description, scene, "sphere").check(claim)


@pytest.fixture(scope="module")
def free(gen3: Robot, glovebox: Scene) -> Result:
    """Grasps of the task that prefers nothing."""
    return plan(gen3, glovebox, "sphere", starts=STARTS, workers=1)


@pytest.fixture(scope="module")
def from_above(gen3: Robot, glovebox: Scene) -> Result:
    return plan(gen3, preferring(glovebox, approach=DOWN), "sphere", starts=STARTS, workers=1)


# ---- the cone


def test_grasps_are_within_the_cone(from_above: Result, free: Result, gen3: Robot, glovebox: Scene) -> None:
    assert from_above.verified >= 0.85 * STARTS
    assert from_above.refuted == 0
    for grasp in from_above.grasps:
        angle = math.acos(-approach_of(grasp, gen3, glovebox)[2])
        figure = grasp.certificate["approach"]
        assert figure.value == pytest.approx(angle, abs=1e-7)
        assert (figure.limit, figure.unit, figure.where) == (0.3 + 1e-9, "rad", "end_effector_link")
        assert angle < 0.3
    outside = [grasp for grasp in free.grasps if approach_of(grasp, gen3, glovebox)[2] > -math.cos(0.3)]
    assert len(outside) > 0.5 * len(free.grasps)  # without the cone they are not
    names = {figure.name for grasp in free.grasps for figure in grasp.certificate.figures}
    assert not names & {"approach", "joint ranges"}


@pytest.mark.parametrize(("off", "angle"), [(0.2, 0.2001), (0.2, 0.1999)])
def test_a_grasp_outside_the_cone_is_refuted(
    free: Result, gen3: Robot, glovebox: Scene, off: float, angle: float
) -> None:
    [grasp] = free.grasps[:1]
    cone = {"direction": tilted(approach_of(grasp, gen3, glovebox), off), "angle": angle}
    certificate = check(grasp, gen3, preferring(glovebox, approach=cone))
    assert certificate["approach"].value == pytest.approx(off, abs=1e-9)
    assert [figure.name for figure in certificate.refuted_by] == ([] if off <= angle else ["approach"])


def tilted(z: Array, off: float) -> tuple[float, ...]:
    """Return a unit vector at an angle (rad) from another one."""
    aside = np.cross(z, [0.0, 1.0, 0.0])
    return tuple((math.cos(off) * z + math.sin(off) * aside / np.linalg.norm(aside)).tolist())


@pytest.mark.parametrize("off", [0.0, 1e-7, 1e-3, 1.0, 3.0, math.pi])
def test_the_angle_of_the_certificate_is_exact(off: float) -> None:
    T = Pose(position=(1.0, 2.0, 3.0), rpy=(0.3, 0.5, -0.7)).matrix
    wanted = ApproachCone(direction=tilted(T[:3, 2], off), angle=1.0)
    assert approach_figure(wanted, np.eye(4), T, "wrist").value == pytest.approx(off, rel=1e-8, abs=1e-15)
    local = ApproachCone(direction=tilted(np.array([0.0, 0.0, 1.0]), off), angle=1.0, frame="object")
    assert approach_figure(local, T, T, "wrist").value == pytest.approx(off, rel=1e-8, abs=1e-15)


def test_a_direction_may_be_given_in_the_frame_of_the_object(gen3: Robot, glovebox: Scene) -> None:
    content = glovebox.model_dump()
    content["objects"]["sphere"]["pose"]["rpy"] = (math.pi / 2, 0.0, 0.0)  # its y is the world's z
    content["tasks"]["sphere"] |= {"desired_contacts": ((0.0, 0.0, 0.0373), (0.0, 0.0, -0.0373))}
    content["tasks"]["sphere"] |= {"approach": {"direction": (0.0, -1.0, 0.0), "angle": 0.3, "frame": "object"}}
    turned = Scene.model_validate(content)
    result = plan(gen3, turned, "sphere", starts=4, workers=1)
    assert result.verified >= 3
    assert all(approach_of(grasp, gen3, glovebox)[2] < -math.cos(0.3) for grasp in result.grasps)


@pytest.mark.parametrize("angle", [1e-3, 0.1, 1.0, 2.0, math.pi])
def test_membership_is_rad_like(gen3: Robot, glovebox: Scene, angle: float) -> None:
    """Zero at the border, positive inside, slope one across the border (of the chord, for wide cones)."""
    x = np.array([0.3, 0.5, -0.4, 1.2, 0.7, 0.6, -0.2, 0.1, 0.0, 0.0, 0.0, 0.0])
    problem = GraspProblem(TaskModel(gen3, glovebox, "sphere"), (0, 1))
    z = wrist(problem, x)

    def value(off: float) -> float:
        approach = Approach(DirectionCone(2.0 * np.array(tilted(z, off)), angle), "wrist")
        state = problem.state(x)
        assert approach.angle(state) == pytest.approx(min(off, 2 * math.pi - off), abs=1e-7)
        return float(approach.inside(state).values[0])

    assert value(angle) == pytest.approx(0.0, abs=1e-9)
    assert value(0.0) == pytest.approx((2 - math.sqrt(2)) * 2 * math.sin(angle / 2))
    if angle < math.pi:
        step = 1e-4 * angle
        slope = (value(angle - step) - value(angle + step)) / (2 * step)
        assert slope == pytest.approx(math.cos(angle / 2), rel=1e-4)
        assert -2 * math.sqrt(2) < value(math.pi) < 0.0


def wrist(problem: GraspProblem, x: Array) -> Array:
    """Return the wrist's z axis in the world by Pinocchio's frames."""
    robot, data = problem.model.robot, problem.model.robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.joint_positions(x[: robot.posture_size]))
    return np.array(data.oMf[robot.wrist_frame].rotation[:, 2])


def test_a_cone_that_the_arm_cannot_keep_is_named(gen3: Robot, make_toy_scene: SceneFactory, toy: Any) -> None:
    """The toy's only arm joint turns its wrist in the plane of x and z: it never points along y."""
    task = TOY_SCENE["tasks"]["ball"] | {"approach": {"direction": [0, 1, 0], "angle": 1.0}}
    model = TaskModel(toy, make_toy_scene(tasks={"ball": task}), "ball")
    solution = LocalSolver(model, SolverOptions(max_evaluations=30)).solve(0, np.array([0.0, 0.03]))
    assert not solution.feasible
    [violation] = [violation for violation in solution.violations if violation.name == "approach"]
    beyond = pytest.approx(90 - math.degrees(1.0), abs=0.01)
    assert violation == Violation("approach", beyond, "deg", "arm", size=beyond)
    assert solution.worst == violation


# ---- joint ranges


@pytest.fixture(scope="module")
def ranged(gen3: Robot, glovebox: Scene) -> Result:
    ranges = {"joint_7": (3.0, 3.6), "joint_6": (-3.0, 0.5), KNUCKLE: (0.05, 0.5)}
    return plan(gen3, preferring(glovebox, joint_ranges=ranges), "sphere", starts=STARTS, workers=1)


def test_joints_are_in_their_ranges_up_to_whole_turns(ranged: Result) -> None:
    """joint_7 is continuous, its range goes beyond pi: reported angles are within (-pi, pi] and keep it."""
    assert ranged.verified >= 0.5 * STARTS
    assert ranged.refuted == 0
    for grasp in ranged.grasps:
        assert -math.pi < grasp.joints["joint_7"] <= math.pi
        assert 3.0 - 1e-9 <= grasp.joints["joint_7"] % (2 * math.pi) <= 3.6 + 1e-9
        assert -2.09 - 1e-9 <= grasp.joints["joint_6"] <= 0.5 + 1e-9
        assert 0.05 - 1e-9 <= grasp.joints[KNUCKLE] <= 0.5
        assert grasp.certificate["joint ranges"].value >= -1e-9
    assert any(grasp.joints["joint_7"] < 0 for grasp in ranged.grasps)


def test_a_grasp_outside_a_range_is_refuted(free: Result, gen3: Robot, glovebox: Scene) -> None:
    [grasp] = free.grasps[:1]
    angle, limited = (grasp.joints[name] for name in ("joint_5", "joint_4"))
    for ranges, depth in (
        (
            {
                "joint_5": (angle + 2 * math.pi - 0.2, angle + 2 * math.pi + 0.3),
                "joint_4": (limited - 0.1, limited + 0.3),
            },
            0.1,
        ),
        ({"joint_5": (angle - 0.2, angle + 0.3), KNUCKLE: (0.7, 0.8)}, grasp.joints[KNUCKLE] - 0.7),
    ):
        certificate = check(grasp, gen3, preferring(glovebox, joint_ranges=ranges))
        figure = certificate["joint ranges"]
        assert (figure.value, figure.where) == (pytest.approx(depth), list(ranges)[-1])
        assert [figure.name for figure in certificate.refuted_by] == ([] if depth > 0 else ["joint ranges"])


@pytest.mark.parametrize(
    ("low", "high", "free", "held"),
    [
        (-0.1, 0.3, 0.1, 0.1),
        (0.1, 0.3, -0.1, -0.1),
        (2 * math.pi - 0.2, 2 * math.pi + 0.3, 0.2, 0.2 - 2 * math.pi),
        (-4 * math.pi - 0.3, -4 * math.pi - 0.2, -0.2, -0.2 - 4 * math.pi),
        (1.0, 8.0, 3.5 - abs(4.5 - 2 * math.pi), -1.0),
    ],
)
def test_whole_turns_count_for_limited_joints_only(low: float, high: float, free: float, held: float) -> None:
    ranges, angles = [JointInterval("joint_ranges", "a", 1.0 + low, 1.0 + high)], {"a": 1.0}
    assert ranges_figure(ranges, angles, {"a"}).value == pytest.approx(free)
    assert ranges_figure(ranges, angles, set()).value == pytest.approx(held)


def test_bounds_are_ranges_within_the_limits(gen3: Robot, glovebox: Scene) -> None:
    ranges = {"joint_1": (3.0, 3.6), "joint_3": (-40.0, -39.0), "joint_5": (1.0, 8.0), "joint_6": (-9.0, 1.0)}
    model = TaskModel(gen3, preferring(glovebox, joint_ranges=ranges | {KNUCKLE: (0.1, 0.2)}), "sphere")
    problem = GraspProblem(model, (0, 1))
    bounds = list(zip(problem.lower.tolist(), problem.upper.tolist(), strict=True))
    turn = 2 * math.pi
    assert bounds[0] == pytest.approx((3.0 - turn, 3.6 - turn))
    assert bounds[2] == pytest.approx((-40.0 + 6 * turn, -39.0 + 6 * turn))
    assert bounds[4][1] - bounds[4][0] > turn  # more than a whole turn: no restriction
    assert bounds[5] == pytest.approx((-2.07, 1.0))  # 0.02 from the robot's limit
    assert bounds[7] == (0.1, 0.2)
    assert bounds[1] == pytest.approx((-2.22, 2.22))
    np.testing.assert_array_equal(gen3.lower[:1], -turn)  # the robot is left as it is


@pytest.mark.parametrize(
    ("name", "interval", "words"),
    [
        ("joint_8", (0.0, 1.0), ["'joint_8'", "no arm joint or synergy of gen3_2f85", "Did you mean joint_"]),
        ("robotiq_85_mimic_left_finger_tip_joint", (0.0, 1.0), ["no arm joint or synergy", f"It mimics {KNUCKLE}"]),
        ("joint_6", (2.1, 3.0), ["[2.1, 3]", "[-2.07, 2.07]", "reserve of 0.02"]),
        (KNUCKLE, (-0.5, 0.0), ["[-0.5, 0]", "[0, 0.8]"]),
    ],
)
def test_range_that_does_not_suit_the_robot(
    gen3: Robot, glovebox: Scene, name: str, interval: tuple[float, float], words: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        TaskModel(gen3, preferring(glovebox, joint_ranges={name: interval}), "sphere")
    assert caught.value.file == glovebox.source
    assert caught.value.key == f"tasks.sphere.joint_ranges.{name}"
    for word in words:
        assert word in str(caught.value)


def test_verifier_refuses_a_range_of_no_joint(gen3: Robot, glovebox: Scene) -> None:
    scene = preferring(glovebox, joint_ranges={"joint_8": (0.0, 1.0)})
    with pytest.raises(InputError, match=r"joint_ranges\.joint_8: the URDF has no movable joint 'joint_8'"):
        Verifier(gen3.description, scene, "sphere")


# ---- starts


@pytest.fixture(scope="module")
def rows(gen3: Robot, glovebox: Scene, tmp_path_factory: pytest.TempPathFactory) -> Database:
    return build_database(gen3, glovebox, tmp_path_factory.mktemp("rows") / "rows.duckdb", size=30_000, workers=2)


def test_starts_come_from_the_cone_and_the_ranges(rows: Database, gen3: Robot, glovebox: Scene) -> None:
    """In the bounds as they are where there are enough; else all of those, and others that miss them by little."""
    ranges = {"joint_1": (2.5, 4.5), "joint_6": (-1.5, 0.5)}
    model = TaskModel(gen3, preferring(glovebox, approach=DOWN | {"angle": 0.5}, joint_ranges=ranges), "sphere")
    some, many = (starts_near(rows, model, count, 0) for count in (3, 10_000))
    beyond, off = misses(model, some)
    assert len(some) == 3
    assert max(beyond.max(), off.max()) <= 0.5 + 1e-6
    assert beyond.max() <= 0.0
    beyond, off = misses(model, many)
    kept = (beyond <= 0.0) & (off <= 0.5)
    assert 3 <= kept.sum() < len(many)
    assert kept[: kept.sum()].all()
    assert beyond.max() <= RANGE_SLACK
    assert off.max() <= 0.5 + RANGE_SLACK


def misses(model: TaskModel, starts: Array) -> tuple[Array, Array]:
    """Return how far starts are outside the bounds, rad, and their angles from the cone's axis, rad."""
    problem, cone = GraspProblem(model, (0, 1)), model.approach
    assert cone is not None
    beyond = np.maximum(model.lower - starts, starts - model.upper)[:, :-1].max(axis=1)
    z = np.array([wrist(problem, start) for start in starts])
    return beyond, np.arccos(np.clip(z @ cone.axis, -1.0, 1.0))


def test_starts_of_a_limited_joint_are_moved_by_whole_turns(make_toy: RobotFactory, make_toy_scene: Any) -> None:
    """The toy's shoulder may turn by two turns: rows a turn off the range serve as well."""
    toy = make_toy(arm=TOY_ROBOT["arm"] | {"limits": {"shoulder": [-7.0, 7.0]}})
    task = TOY_SCENE["tasks"]["ball"] | {"joint_ranges": {"shoulder": [5.5, 6.8]}, "start_radius": 1.0}
    scene = make_toy_scene(tasks={"ball": task})
    with build_database(toy, scene, Path(scene.source).with_name("toy.duckdb"), size=2000, workers=1) as database:
        model = TaskModel(toy, scene, "ball")
        starts = starts_near(database, model, 200, 0)
        plain = starts_near(database, TaskModel(toy, make_toy_scene(), "ball"), 200, 0)
    assert len(starts) == 200
    assert (starts[:, 0] >= 5.5).all()
    assert (starts[:, 0] <= 6.8).all()
    assert plain[:, 0].min() < -5.0


def test_too_few_starts_are_said(gen3: Robot, glovebox: Scene) -> None:
    """The hand cannot come from below: the object lies near the floor."""
    scene = preferring(glovebox, approach={"direction": (0.0, 0.0, 1.0), "angle": 0.1}, start_radius=0.1)
    result = plan(gen3, scene, "sphere", starts=9, workers=1)
    assert (result.best, result.starts) == (None, 9)
    assert result.done < 9
