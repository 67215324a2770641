"""A planner that stays warm: the same plans, grasps as they come, objects that move, the user's own configuration."""

from __future__ import annotations

import json
import os
import pickle
import signal
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import trimesh
from conftest import TOY_URDF, RobotFactory, SceneFactory
from places import changed

import pinograsp
from pinograsp import InputError, Planner, plan, problem
from pinograsp.collision.solids import link_bodies
from pinograsp.database import cache
from pinograsp.descriptions import Scene
from pinograsp.descriptions.pose import Pose
from pinograsp.frozen import same
from pinograsp.kinematics.forward import forward
from pinograsp.kinematics.robot import Robot
from pinograsp.mechanics import ContactModels, ForceLimits, least_cost, least_cost_parallel
from pinograsp.mechanics.barrier import barrier
from pinograsp.planning.assemble import claim_of
from pinograsp.planning.bound import least_U
from pinograsp.planning.single_grasps import SingleGrasps
from pinograsp.problem import TaskModel
from pinograsp.results import Result
from pinograsp.verification import Claim
from pinograsp.verification.check import Verifier

THERE = Pose(position=(0.80, 0.06, -0.08), rpy=(0.0, 0.0, 0.4))
LIMITS = ForceLimits(0.9, 0.001, 5.0, 0.01)


@pytest.fixture
def planner(gen3: Robot, glovebox: Scene) -> Iterator[Planner]:
    with Planner(gen3, glovebox, workers=1) as planner:
        yield planner


def found(result: Result) -> list[Any]:
    return [(g.start, g.cost.U, list(g.joints.values()), g.count) for g in result.grasps]


def test_a_session_plans_what_a_single_plan_does(planner: Planner, gen3: Robot, glovebox: Scene) -> None:
    alone = plan(gen3, glovebox, "sphere", starts=6, workers=1, seed=2)
    for _ in range(2):
        assert found(planner.plan("sphere", starts=6, seed=2)) == found(alone)


def test_a_given_executor_finds_the_same(gen3: Robot, glovebox: Scene) -> None:
    alone = plan(gen3, glovebox, "sphere", starts=10, workers=1)
    with ProcessPoolExecutor(2, mp_context=get_context("fork")) as executor:
        assert found(plan(gen3, glovebox, "sphere", starts=10, executor=executor)) == found(alone)
        assert executor.submit(abs, -1).result() == 1  # it is left running


def test_workers_stay_warm_from_plan_to_plan(gen3: Robot, glovebox: Scene) -> None:
    with Planner(gen3, glovebox, workers=2) as planner:
        first = planner.plan("sphere", starts=16)
        pool = planner._workers._pool  # type: ignore[attr-defined]
        pids = set(pool._processes)
        planner.move("sphere", THERE)
        moved = planner.plan("sphere", starts=16)
        assert set(planner._workers._pool._processes) == pids  # type: ignore[attr-defined]
    assert found(moved) != found(first)
    assert found(moved) == found(plan(gen3, glovebox.with_object_pose("sphere", THERE), "sphere", starts=16, workers=1))


def test_a_worker_killed_between_two_plans_is_replaced(gen3: Robot, glovebox: Scene) -> None:
    with Planner(gen3, glovebox, workers=2) as planner:
        first = planner.plan("sphere", starts=10)
        for pid in list(planner._workers._pool._processes):  # type: ignore[attr-defined]
            os.kill(pid, signal.SIGKILL)
        assert found(planner.plan("sphere", starts=10)) == found(first)


def test_a_wrong_database_is_refused_every_time(gen3: Robot, paper: Robot, glovebox: Scene, tmp_path: Path) -> None:
    file = tmp_path / "other.duckdb"
    pinograsp.build_database(paper, glovebox, file, size=50, workers=1).close()
    with Planner(gen3, glovebox, database=file, workers=1) as planner:
        for _ in range(2):
            with pytest.raises(InputError, match="was made for another robot"):
                planner.plan("sphere", starts=1)
            with pytest.raises(InputError, match="was made for another robot"):
                next(planner.grasps("sphere"))


def test_workers_and_an_executor_are_one_too_many(gen3: Robot, glovebox: Scene) -> None:
    with ProcessPoolExecutor(1) as executor, pytest.raises(InputError, match="workers: is given with an executor"):
        Planner(gen3, glovebox, workers=2, executor=executor)


def test_grasps_of_a_moved_object_are_verified_where_it_is(planner: Planner, gen3: Robot) -> None:
    next(planner.grasps("sphere"))
    for pose in (THERE, Pose(position=(0.75, -0.05, -0.1), rpy=(0.0, 0.5, 0.0)).matrix):
        planner.move("sphere", pose)
        grasp = next(planner.grasps("sphere", most=1))
        scene = planner.scene
        np.testing.assert_allclose(scene.objects["sphere"].pose.matrix, getattr(pose, "matrix", pose), atol=1e-12)
        claim = Claim(
            grasp.joints,
            np.array([c.point for c in grasp.contacts]),
            np.array([c.force for c in grasp.contacts]),
            np.array([c.spin_torque for c in grasp.contacts]),
        )
        assert Verifier(gen3.description, scene, "sphere").check(claim).verified
        assert grasp.setup is not None
        assert grasp.setup.scene == scene


def test_a_moved_model_is_one_built_there(gen3: Robot, glovebox: Scene) -> None:
    scene = glovebox.with_object_pose("sphere", THERE)
    moved, built = TaskModel(gen3, glovebox, "sphere").moved("sphere", scene), TaskModel(gen3, scene, "sphere")
    np.testing.assert_array_equal(moved.desired_points, built.desired_points)
    np.testing.assert_array_equal(moved.load.center_of_mass, built.load.center_of_mass)
    data = built.robot.model.createData()
    at = forward(built.robot, data, 0.4 * built.lower + 0.6 * built.upper)
    np.testing.assert_array_equal(moved.collisions.distances(at).values, built.collisions.distances(at).values)


def test_another_object_that_is_moved_is_an_obstacle_there(gen3: Robot, glovebox: Scene) -> None:
    """A block put beside the sphere takes its grasp away, put aside it gives it back."""
    content = glovebox.model_dump()
    content["objects"]["block"] = {
        "shape": {"type": "box", "size": (0.12, 0.12, 0.06)},
        "pose": {"position": (0.6, 0.25, -0.1)},
    }
    scene = Scene.model_validate(content)
    sphere = scene.objects["sphere"].pose.position
    with Planner(gen3, scene, workers=1) as planner:
        found = next(planner.grasps("sphere", most=1))
        planner.move("block", Pose(position=(sphere[0], sphere[1] + 0.0373 + 0.06, sphere[2])))  # where a pad is
        assert not planner.check("sphere", found.joints).certificate["obstacle clearance"].holds
        assert all(grasp.certificate["obstacle clearance"].holds for grasp in planner.grasps("sphere", deadline=0.3))
        planner.move("block", Pose(position=(0.6, 0.25, -0.1)))
        assert planner.check("sphere", found.joints).certificate["obstacle clearance"].holds
        assert next(planner.grasps("sphere", most=1), None) == found


def test_an_object_that_is_not_there_cannot_be_moved(planner: Planner) -> None:
    with pytest.raises(InputError, match=r"objects: no object 'spere' in this scene\. Did you mean sphere"):
        planner.move("spere", THERE)


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        (np.full((4, 4), np.nan), "pose: holds a number that is not finite"),
        (np.zeros((4, 4)), "pose: is no homogeneous transform"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "pose: is no homogeneous transform"),
        (np.zeros(3), r"pose: has shape \(3,\), not \(4, 4\)"),
    ],
    ids=["nan", "zeros", "mirror", "vector"],
)
def test_what_is_no_pose_moves_nothing(planner: Planner, pose: Any, message: str) -> None:
    before = planner.scene
    with pytest.raises(InputError, match=message):
        planner.move("sphere", pose)
    assert planner.scene == before


@pytest.mark.parametrize("limits", [{"most": 0}, {"deadline": -1.0}, {"deadline": float("nan")}], ids=str)
def test_limits_of_a_search_that_make_no_sense(planner: Planner, limits: Any) -> None:
    with pytest.raises(InputError, match=r"^(most|deadline): must be (at least|a finite)"):
        next(planner.grasps("sphere", **limits))


def test_an_object_moved_through_a_wall_is_refused(planner: Planner) -> None:
    planner.move("sphere", Pose(position=(0.8, 0.0, 5.0)))
    with pytest.raises(InputError, match="outside the enclosure"):
        next(planner.grasps("sphere"))


def test_a_search_ends_at_a_number_a_deadline_or_the_bound(planner: Planner) -> None:
    assert list(planner.grasps("sphere", deadline=0.0)) == []
    planner.move("sphere", Pose(position=(0.80, 0.06, -0.08), rpy=(1.2, 0.0, 0.0)))  # V* depends on the direction
    assert len(list(planner.grasps("sphere", most=3))) == 3
    began = time.perf_counter()
    assert list(planner.grasps("sphere", deadline=0.3))
    assert time.perf_counter() - began < 10.0
    planner.move("sphere", THERE)
    *_, last = planner.grasps("sphere")
    assert 1.001 * least_U(planner._models.model("sphere")) >= last.cost.U


def test_the_first_grasps_as_a_result(gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    """What `grasps` yields, with the account of every start that was tried."""
    scene = glovebox.with_object_pose("sphere", Pose(position=(0.80, 0.06, -0.08), rpy=(1.2, 0.0, 0.0)))
    told: list[pinograsp.Progress] = []
    with Planner(gen3, scene, workers=1, progress=told.append) as planner:
        result = planner.first("sphere", most=3)
        yielded = {grasp.start: grasp for grasp in planner.grasps("sphere", most=3)}
    assert {grasp.start for grasp in result.grasps} <= yielded.keys()
    assert all(same(grasp.claim.joints, yielded[grasp.start].claim.joints) for grasp in result.grasps)
    assert all(same(grasp.certificate, yielded[grasp.start].certificate) for grasp in result.grasps)
    assert sum(grasp.count for grasp in result.grasps) == result.verified == 3
    assert result.done == result.verified + sum(blocked.starts for blocked in result.blocked.values()) <= result.starts
    assert (result.provenance["most"], result.provenance["options"]["tries"]) == (3, 1)
    assert (told[-1].stage, told[-1].done, told[-1].numbers["verified"]) == ("starts", result.done, 3)
    pinograsp.write_json(result, tmp_path / "first.json")
    assert pinograsp.read_json(tmp_path / "first.json") == result
    assert pinograsp.verify(result) == ()


def test_the_first_grasps_within_no_time(planner: Planner) -> None:
    result = planner.first("sphere", deadline=0.0)
    assert (result.grasps, result.done, result.interrupted) == ((), 0, False)
    assert result.starts > 0
    (warning,) = result.warnings
    assert warning.startswith("no start was tried: the preparations took ")


@pytest.mark.parametrize("stage", ["starts", "preparations"])
def test_an_interruption_of_the_first_grasps_keeps_them(
    gen3: Robot, glovebox: Scene, stage: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    if stage == "preparations":
        monkeypatch.setattr(SingleGrasps, "nearest", interrupt)
    with Planner(gen3, glovebox, workers=1) as planner:
        planner._report = lambda progress: interrupt() if progress.stage == "starts" else None
        result = planner.first("sphere")
    assert result.interrupted
    assert (result.done, len(result.grasps)) == ((1, 1) if stage == "starts" else (0, 0))
    assert result.starts > result.done


def test_the_scene_digest_follows_its_content(glovebox: Scene) -> None:
    moved = glovebox.with_object_pose("sphere", THERE)
    assert moved.digest != glovebox.digest
    assert moved.digest == glovebox.with_object_pose("sphere", THERE).digest
    np.testing.assert_allclose(Pose.of(THERE.matrix).matrix, THERE.matrix, atol=1e-15)
    upright = Pose(rpy=(0.3, np.pi / 2, -0.4)).matrix
    np.testing.assert_allclose(Pose.of(upright).matrix, upright, atol=1e-9)


@pytest.fixture(scope="module")
def grasp(gen3: Robot, glovebox: Scene) -> pinograsp.Grasp:
    with Planner(gen3, glovebox, workers=1) as planner:
        return next(planner.grasps("sphere"))


def test_a_grasp_given_as_a_configuration_is_verified(planner: Planner, grasp: pinograsp.Grasp) -> None:
    for q in (grasp.joints, np.concatenate([grasp.q_arm, grasp.synergy])):
        check = planner.check("sphere", q)
        assert check.verified, check.certificate.refuted_by
        for name in ("enclosure clearance", "self clearance", "object clearance", "pad clearance"):
            figure = check.certificate[name]
            assert figure.value == pytest.approx(grasp.certificate[name].value, abs=1e-9)
            least = min((pair.distance for pair in check.clearances if pair.name == name), default=0.05)
            assert least == pytest.approx(figure.value, abs=1e-9)


def test_a_grasp_given_as_a_configuration_is_that_grasp(planner: Planner, grasp: pinograsp.Grasp) -> None:
    check = planner.check("sphere", grasp.joints)
    found = check.grasp
    assert (found.start, found.count) == (None, 0)
    assert repr(found).startswith("<Grasp: verified, U ")
    assert found.certificate is check.certificate
    assert list(found.joints.items()) == list(grasp.joints.items())
    for name in ("q_arm", "synergy", "contact_parameters", "internal_forces", "T_world_wrist", "T_object_wrist"):
        np.testing.assert_allclose(getattr(found, name), getattr(grasp, name), atol=1e-5, err_msg=name)
    assert pytest.approx(grasp.cost.U, rel=1e-4) == found.cost.U
    for one, other in zip(found.contacts, grasp.contacts, strict=True):
        assert (one.pad, one.link) == (other.pad, other.link)
        for name in ("point", "normal", "desired_point", "T_world_pad"):
            np.testing.assert_allclose(getattr(one, name), getattr(other, name), atol=1e-6, err_msg=name)
        np.testing.assert_allclose(one.force, other.force, atol=1e-3)
    assert found.setup == pinograsp.Setup(planner.robot.description, planner.scene, "sphere")


def test_robot_and_scene_of_a_planner_are_read_only(planner: Planner) -> None:
    """Another scene would leave the models as they are; `move` is the way to change it."""
    for name in ("robot", "scene"):
        with pytest.raises(AttributeError):
            setattr(planner, name, None)


@pytest.mark.parametrize("task", [[], {}, None, 3])
def test_a_task_that_is_no_name(planner: Planner, task: Any) -> None:
    with pytest.raises(pinograsp.UnknownNameError, match=r"no task .* in this scene"):
        planner.plan(task)
    with pytest.raises(pinograsp.UnknownNameError, match=r"no task .* in this scene"):
        planner.check(task, [])


def test_one_check_without_a_planner(gen3: Robot, glovebox: Scene, planner: Planner, grasp: pinograsp.Grasp) -> None:
    check = pinograsp.check(gen3, glovebox, "sphere", grasp.joints)
    with Planner(gen3, glovebox) as fresh:
        assert check == fresh.check("sphere", grasp.joints)
    assert check.verified
    with pytest.raises(InputError, match="no task 'can'"):
        pinograsp.check(gen3, glovebox, "can", grasp.joints)


def test_a_check_as_json_has_the_attributes(planner: Planner, grasp: pinograsp.Grasp) -> None:
    """Of a configuration with numbers that are not finite, too: links intersect to an unknown depth."""
    q = np.concatenate([grasp.q_arm, grasp.synergy])
    q[3] = 2.5  # the elbow folds
    check = planner.check("sphere", q)
    data = json.loads(json.dumps(check.to_json(), allow_nan=False))
    assert data.keys() == {"verified", "grasp", "clearances", "warnings"}
    assert data["verified"] is False
    assert data["grasp"] == check.grasp.to_json()
    assert data["grasp"]["start"] is None
    pairs = [(pair["name"], pair["link"], pair["other"]) for pair in data["clearances"]]
    assert pairs == [(pair.name, pair.link, pair.other) for pair in check.clearances]
    assert len({tuple(pair) for pair in data["clearances"]}) == 1
    distances = [pair["distance"] for pair in data["clearances"]]
    assert distances == [pair.distance if np.isfinite(pair.distance) else None for pair in check.clearances]


def test_pads_are_where_joints_that_keep_to_no_synergy_have_them(
    planner: Planner, grasp: pinograsp.Grasp, gen3: Robot
) -> None:
    tip = "robotiq_85_mimic_right_finger_tip_joint"
    check = planner.check("sphere", {**grasp.joints, tip: grasp.joints[tip] + 0.1})
    assert "mimic joints" in {figure.name for figure in check.certificate.refuted_by}
    left, right = (contact.T_world_pad for contact in check.grasp.contacts)
    np.testing.assert_allclose(left, grasp.contacts[0].T_world_pad, atol=1e-9)
    before = grasp.contacts[1].T_world_pad
    turn = np.linalg.norm(pin.log3(before[:3, :3].T @ right[:3, :3]))
    assert turn == pytest.approx(0.1, abs=1e-9)


def test_a_contact_within_the_reserve_is_said_to_be_that(gen3: Robot, glovebox: Scene, grasp: pinograsp.Grasp) -> None:
    """It is where pad and object touch, and not moved away from the rim to where they do not."""
    found = grasp.certificate["pad rim"].value
    assert found < 0.00999
    scene = changed(glovebox, "tasks", reserve={"rim": 0.00999})
    with Planner(gen3, scene, workers=1) as planner:
        check = planner.check("sphere", grasp.joints)
    [refuted] = check.certificate.refuted_by
    assert (refuted.name, refuted.value) == ("pad rim", pytest.approx(found, abs=1e-9))


def test_a_configuration_that_is_no_grasp_says_why(planner: Planner, grasp: pinograsp.Grasp) -> None:
    into_wall = dict(grasp.joints) | {next(iter(grasp.joints)): 2.0}
    check = planner.check("sphere", into_wall)
    assert not check.verified
    assert "contact gap" in {figure.name for figure in check.certificate.refuted_by}
    distances = [pair.distance for pair in check.clearances]
    assert distances == sorted(distances)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda q: q | {"joint_9": 0.0}, "there is no joint 'joint_9'"),
        (lambda q: {name: value for name, value in q.items() if name != "joint_2"}, "no value is given for 'joint_2'"),
        (lambda q: q | {"joint_2": float("nan")}, "^joints.joint_2: must be a finite number, not nan"),
        (lambda q: q | {"joint_2": True}, "^joints.joint_2: must be a number, not True"),
        (lambda q: [0.0, 1.0], r"^joints: has shape \(2,\), not \(8,\)\. Give joint_1"),
        (lambda q: q | {"joint_2": "half"}, "^joints.joint_2: must be a number, not 'half'"),
        (lambda q: None, r"^joints: has shape \(\)"),
    ],
)
def test_a_configuration_that_cannot_be_read(
    planner: Planner, grasp: pinograsp.Grasp, change: Any, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        planner.check("sphere", change(dict(grasp.joints)))


def test_joints_of_a_hand_with_named_synergies_are_a_configuration() -> None:
    """The synergies follow from the joints; joints that keep to none are refused by the certificate."""
    robot, scene = pinograsp.load_robot("xarm7_allegro"), pinograsp.load_scene("allegro_ceiling")
    joints = robot.joints_by_name(0.5 * (robot.lower + robot.upper))
    with Planner(robot, scene, workers=1) as planner:
        assert planner.check("sphere", joints).certificate["synergies"].holds
        moved = robot.joint_names[robot.hand_joints[0]]
        assert not planner.check("sphere", joints | {moved: joints[moved] + 0.01}).certificate["synergies"].holds


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"starts": 1.5}, "starts: must be a whole number, not 1.5"),
        ({"starts": "3"}, "starts: must be a whole number, not '3'"),
        ({"seed": float("inf")}, "seed: must be a whole number, not inf"),
        ({"workers": 1.5}, r"workers: must be a whole number, not 1\.5"),
        ({"executor": 42}, "executor: is no concurrent.futures.Executor"),
    ],
    ids=str,
)
def test_numbers_that_make_no_sense(gen3: Robot, glovebox: Scene, change: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        plan(gen3, glovebox, "sphere", **change)


def test_numbers_of_numpy_will_do(gen3: Robot, glovebox: Scene) -> None:
    of_numpy = plan(gen3, glovebox, "sphere", starts=np.int64(2), seed=np.int64(3), workers=1)  # type: ignore[arg-type]
    assert found(of_numpy) == found(plan(gen3, glovebox, "sphere", starts=2, seed=3, workers=1))


def test_a_registered_constraint_reaches_the_plan(gen3: Robot, glovebox: Scene) -> None:
    asked = []

    def nothing(model: TaskModel) -> None:
        asked.append(model.task_name)

    problem.CONSTRAINTS.append(nothing)
    try:
        plan(gen3, glovebox, "sphere", starts=1, workers=1)
    finally:
        problem.CONSTRAINTS.remove(nothing)
    assert "sphere" in asked


# ---- files that change


SRDF = '<robot name="toy"><disable_collisions link1="{}" link2="{}" reason="Adjacent"/></robot>'


def on_disk(robot: Robot, key: str) -> Path:
    return robot.description.files[key]


def test_an_executor_that_lives_on_sees_what_changed(
    make_toy: RobotFactory, make_toy_scene: SceneFactory, tmp_path: Path
) -> None:
    """An SRDF, and a mesh of the same size and time."""
    (tmp_path / "toy.srdf").write_text(SRDF.format("arm", "left"))
    trimesh.creation.box((0.04, 0.04, 0.16)).export(tmp_path / "arm.stl")
    box, mesh = '<box size="0.04 0.04 0.16"/>', '<mesh filename="arm.stl"/>'
    files = (tmp_path / "toy.srdf", tmp_path / "arm.stl")
    robot, scene = make_toy(TOY_URDF.replace(box, mesh), meshes=files, srdf="toy.srdf"), make_toy_scene()
    with ProcessPoolExecutor(1, mp_context=get_context("fork")) as executor:

        def pairs(robot: Robot) -> tuple[Any, Any]:
            return executor.submit(seen, pickle.dumps(robot.mounted(scene.mounting.matrix))).result()

        first = pairs(robot)
        on_disk(robot, "srdf").write_text(SRDF.format("arm", "right"))
        second = pairs(pinograsp.load_robot(robot.description.source))
        assert first[0] != second[0]
        stl = Path(robot.urdf.meshes[0])
        stat = stl.stat()
        trimesh.creation.box((0.04, 0.04, 0.20)).export(stl)
        os.utime(stl, ns=(stat.st_atime_ns, stat.st_mtime_ns))
        assert stl.stat().st_size == stat.st_size
        third = pairs(pinograsp.load_robot(robot.description.source))
        assert third[1] == pytest.approx(second[1] + 0.04, abs=1e-7)


def seen(pickled: bytes) -> tuple[Any, float]:
    """Return, in a worker, the pairs of an SRDF that a robot has there, and the height of its arm's mesh."""
    robot = pickle.loads(pickled)
    [arm] = [body for body in link_bodies(robot) if body.name == "arm"]
    return robot.urdf.disabled_pairs, float(np.ptp(np.array(arm.solids[0].shape.points())[:, 2]))


@pytest.mark.parametrize("workers", [1, 2])
def test_a_robot_whose_files_changed_since_it_was_loaded_is_refused(
    make_toy: RobotFactory, make_toy_scene: SceneFactory, workers: int
) -> None:
    robot, scene = make_toy(), make_toy_scene()
    urdf = on_disk(robot, "urdf")
    urdf.write_text(urdf.read_text().replace('xyz="0 0 0.2"', 'xyz="0 0 0.19"'))
    with pytest.raises(InputError, match=r"urdf changed since the robot was loaded\. Load it again"):
        plan(robot, scene, "ball", starts=3, workers=workers)


def test_a_robot_that_was_read_stays_as_it_was_or_is_refused(
    make_toy: RobotFactory, make_toy_scene: SceneFactory
) -> None:
    robot, scene = make_toy(), make_toy_scene()
    before = plan(robot, scene, "ball", starts=5, workers=1)
    urdf = on_disk(robot, "urdf")
    urdf.write_text(urdf.read_text().replace('xyz="0 0 0.2"', 'xyz="0 0 0.19"'))
    again = plan(robot, scene, "ball", starts=5, workers=1)
    assert found(again) == found(before)
    assert again.provenance["sha256"] == before.provenance["sha256"]
    with pytest.raises(InputError, match="urdf changed since the robot was loaded"):
        plan(robot, scene, "ball", starts=5, workers=2)


# ---- the bound


def test_no_forces_of_parallel_pads_are_below_the_bound() -> None:
    rng, models = np.random.default_rng(0), ContactModels.hard(2, 1.0)
    bound, any_hand = least_cost_parallel(2.0, LIMITS), least_cost(2, LIMITS)
    assert any_hand < bound
    least = np.inf
    for _ in range(4000):
        e, w = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
        first = -w + rng.uniform(1.0, 4.5) * e + rng.normal(scale=0.2, size=3)
        f = np.concatenate([first, -2.0 * w - first])
        least = min(least, barrier(f, np.array([e, -e]), models, LIMITS).V)
    assert bound <= least < 1.1 * bound


def test_the_bound_is_reached_by_the_sphere(gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    """With V* of 2.17875 on the desired points; for a hand whose pads turn only the weaker bound is claimed."""
    model = TaskModel(gen3, glovebox, "sphere")
    best = plan(gen3, glovebox, "sphere", starts=8, workers=1).ranked("U")[0]
    assert least_U(model) <= best.cost.U <= 1.0001 * least_U(model)


def test_the_bound_holds_for_other_tasks(paper: Robot, curved_gen3: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "SIZE", 4000)  # of a database of its own, for a robot that is elsewhere given one
    for robot, scene, task in ((paper, "glovebox_can", "can_region"), (curved_gen3, "glovebox", "sphere")):
        # The round pads bulge out of flat finger tips by less than the margin that a task has by default.
        description = changed(pinograsp.load_scene(scene), "tasks", task, margin={"object": 0.0})
        best = plan(robot, description, task, starts=6, workers=1).best
        assert best is not None
        assert least_U(TaskModel(robot, description, task)) <= best.cost.U


def test_claims_of_states_are_what_is_checked(planner: Planner, grasp: pinograsp.Grasp) -> None:
    """The session's check puts the contacts where the grasp has them."""
    model = planner._models.model("sphere")
    from pinograsp.planning.own_contacts import touching

    claim = claim_of(touching(model, np.concatenate([grasp.q_arm, grasp.synergy])))
    np.testing.assert_allclose(claim.points, [contact.point for contact in grasp.contacts], atol=2e-4)


@pytest.mark.parametrize("desired", [False, True])
def test_contacts_of_a_configuration_are_where_a_plan_would_have_them(
    toy: Robot, make_toy_scene: SceneFactory, desired: bool
) -> None:
    """A box whose centre of mass is 4 mm beside the middle of the pads: two hard fingers hold it only beside it.

    Flat pads touch the box everywhere, so that the posture alone does not say where contacts are.
    """
    sigma = (0.05 - 0.002) / 2.25
    box = pinograsp.Object(
        shape=pinograsp.Box(size=(0.05, 0.03, 0.03)),
        pose=Pose(position=(-0.5 * (0.25 * sigma + 0.002), 0.0, 0.222)),
        center_of_mass=(0.0, 0.004, 0.0),
    )
    points = [[0.025, 0.0, 0.0], [-0.025, 0.0, 0.0]] if desired else None
    scene = make_toy_scene().with_object("ball", box).with_task("ball", desired_contacts=points)
    result = pinograsp.plan(toy, scene, "ball", starts=6, workers=1)
    assert result.best is not None
    check = pinograsp.check(toy, scene, "ball", result.best.joints)
    assert check.verified, check.certificate.refuted_by
    for one, other in zip(check.grasp.contacts, result.best.contacts, strict=True):
        assert one.point[1] == pytest.approx(0.004, abs=5e-5)  # as far as the balance may be off
        np.testing.assert_allclose(one.force, other.force, atol=0.3)
    assert pytest.approx(result.best.cost.V, rel=0.05) == check.grasp.cost.V


def test_contacts_stay_in_the_middle_where_nothing_holds_anyway(toy: Robot, make_toy_scene: SceneFactory) -> None:
    """The centre of mass is 12 mm beside the middle of the pads, which reach 8 mm."""
    sigma = (0.05 - 0.002) / 2.25
    box = pinograsp.Object(
        shape=pinograsp.Box(size=(0.05, 0.03, 0.03)),
        pose=Pose(position=(-0.5 * (0.25 * sigma + 0.002), 0.0, 0.222)),
        center_of_mass=(0.0, 0.012, 0.0),
    )
    scene = make_toy_scene().with_object("ball", box).with_task("ball", desired_contacts=None)
    check = pinograsp.check(toy, scene, "ball", [0.0, sigma])
    assert [figure.name for figure in check.certificate.refuted_by] == ["force balance", "torque balance"]
    for contact in check.grasp.contacts:
        np.testing.assert_allclose(contact.point[1:], [0.0, 0.22], atol=1e-6)
