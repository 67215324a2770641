"""A user's script that touches most of the public face: checked with `mypy --strict` against the wheel, never run."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

import pinograsp
from pinograsp import Grasp, InputError, Planner, Progress, Result, Robot, Scene


def told(progress: Progress) -> None:
    print(progress.stage, progress.done, progress.total, progress.numbers.get("verified"), progress)


def planned(robot: Robot, scene: Scene, task: str) -> Result:
    options = pinograsp.SolverOptions(algorithm="LD_SLSQP", tries=2)
    return pinograsp.plan(robot, scene, task, starts=100, workers=2, seed=1, options=options, progress=told)


def listed(grasps: Iterable[Grasp]) -> list[float]:
    found: list[float] = []
    for grasp in grasps:
        figure: pinograsp.Figure = grasp.certificate["joint reserve"]
        assert figure.holds and figure.sense == "at least", figure.where
        found.append(grasp.cost.U + figure.value)
        for contact in grasp.contacts:
            print(contact.pad, contact.link, float(np.linalg.norm(contact.force)), contact.point.tolist())
        print(grasp.joints["joint_1"], grasp.q_arm.shape, grasp.synergy, grasp.T_world_wrist[:3, 3])
    return found


def reported(file: Path) -> None:
    result = pinograsp.read_json(file)
    best = result.best
    if best is None:
        for kind, blocked in result.blocked.items():
            print(kind, blocked.starts, blocked.nearest_miss, blocked.unit)
        return
    listed(result.ranked("clearance"))
    for grasp, starts, number in result.different(5):
        print(grasp.start, starts, number)
    print([criterion.name for criterion in pinograsp.CRITERIA], len(result.pareto(("U", "clearance"))))
    differences: tuple[pinograsp.Difference, ...] = pinograsp.verify(result)
    print([difference.what for difference in differences])
    pinograsp.write_json(result, str(file) + ".copy")
    pinograsp.visualization.write_html(result, file.with_suffix(".html"))
    assessment = pinograsp.assess(best, pinograsp.Errors(position=0.001), samples=20)
    print(assessment.share, assessment.interval, [margin.size for margin in assessment.margins])
    outcomes = pinograsp.hold_test(result, 3, options=pinograsp.HoldOptions(acceleration=2.0))
    print([outcome.held for outcome in outcomes])


def own_configurations(robot: Robot, scene: Scene) -> None:
    with Planner(robot, scene) as planner:
        for grasp in planner.grasps("sphere", most=2, deadline=1.0):
            checked: pinograsp.ConfigurationCheck = planner.check("sphere", grasp.joints)
            print(checked.verified, checked.certificate.refuted_by)
            for pair in checked.clearances:
                print(pair.link, pair.other, pair.distance)
        first: Result = planner.first("sphere", most=2, deadline=1.0)
        print(first.best)
        planner.move("sphere", pinograsp.Pose(position=(0.5, 0.0, 0.2)))
        verifier = pinograsp.Verifier(robot, planner.scene, "sphere")
        certificate: pinograsp.Certificate = verifier.check(next(planner.grasps("sphere")).claim)
        print(certificate.verified)


def made_in_python() -> Scene:
    ball = pinograsp.Object(shape=pinograsp.Sphere(radius=0.03), pose=pinograsp.Pose(position=(0.5, 0.0, 0.3)))
    task = pinograsp.Task(
        object="ball",
        desired_contacts=((0.03, 0.0, 0.0), (-0.03, 0.0, 0.0)),
        wrench=pinograsp.Wrench(force=(0.0, 0.0, -1.0)),
        contact=pinograsp.ContactConstants(friction=0.5),
        margin=pinograsp.Margins(enclosure=0.01),
        lock={"joint_7": 0.0},
    )
    enclosure = pinograsp.Enclosure(min=(-0.5, -0.5, 0.0), max=(0.9, 0.5, 0.9))
    scene = Scene(name="mine", enclosure=enclosure, objects={"ball": ball}, tasks={"hold": task})
    post = pinograsp.Body(shape=pinograsp.Box(size=(0.05, 0.05, 0.4)), pose=pinograsp.Pose(position=(0.3, 0.3, 0.2)))
    scene = scene.with_obstacle("post", post).with_object_pose("ball", np.eye(4))
    return Scene.from_dict(scene.with_task("hold", withstand=2.0).to_dict())


def vectors_as_they_come(planner: Planner) -> tuple[float, float, float]:
    """Lists and arrays are taken, tuples are held."""
    point = np.array([0.5, 0.0, 0.3])
    scene = planner.scene.with_object_pose("ball", np.eye(4).tolist())
    shape = pinograsp.Box(size=[0.1, 0.1, 0.1])
    ball = pinograsp.Object(
        shape=shape, pose=pinograsp.Pose(position=point, rpy=[0, 0, 1]), center_of_mass=[0, 0, 0.01]
    )
    region = pinograsp.AllOf(
        parts=(
            pinograsp.Near(points=[point, [0.0, 0.0, 0.1]], radius=0.01),
            pinograsp.Outside(part=pinograsp.HalfSpace(normal=[0, 0, 1], offset=0.0)),
            pinograsp.Band(z=[0.0, 0.1]),
        )
    )
    task = pinograsp.Task(
        object="ball",
        desired_contacts=np.array([[0.05, 0.0, 0.0], [-0.05, 0.0, 0.0]]),
        wrench=pinograsp.Wrench(force=[0, 0, -1], torque=np.zeros(3)),
        contact=pinograsp.ContactConstants(friction=0.5),
        approach=pinograsp.ApproachCone(direction=[0, 0, -1], angle=0.5),
        joint_ranges={"joint_1": [0.0, 1.0]},
        allowed_contacts=region,
    )
    scene.with_object("ball", ball).with_task("hold", task)
    planner.move("ball", pinograsp.Pose(position=[0.5, 0.1, 0.3]).matrix)
    planner.check("hold", [0.0] * 8)
    pinograsp.HandMount("gripper.urdf", position=[0.0, 0.0, 0.1])
    x, y, z = ball.pose.position
    assert task.desired_contacts is not None  # they may be left out
    lower: float = task.joint_ranges["joint_1"][0] + task.desired_contacts[0][1]
    print(np.array(task.desired_contacts).shape, lower, x + y + z)
    return ball.pose.position


def databases(robot: Robot, scene: Scene, folder: Path) -> None:
    with pinograsp.build_database(robot, scene, folder / "starts.duckdb", size=1000) as database:
        cone = pinograsp.DirectionCone(np.array([0.0, 0.0, -1.0]), 0.5)
        near = pinograsp.configurations_near(database, [0.5, 0.0, 0.3], [0.2, 0.1, 0.1], cone=cone)
        spread = pinograsp.spread_configurations(database, np.array([0.5, 0.0, 0.3]), 0.2, 10)
        print(near.q.shape, spread.clearances.min(), database.info()["rows"])
        coverage = pinograsp.Coverage.of(database)
        pinograsp.visualization.coverage_png(coverage, str(folder / "coverage.png"), "reached")
        database.export_parquet(str(folder / "starts.parquet"))


def main() -> None:
    print(pinograsp.__version__, sorted(pinograsp.shipped_robots()), sorted(pinograsp.shipped_scenes()))
    try:
        robot, scene = pinograsp.load_robot("gen3_2f85"), pinograsp.load_scene(Path("glovebox"))
    except pinograsp.FileError as error:
        raise SystemExit(f"{error.file}: {error.problem}") from None
    except InputError as error:
        raise SystemExit(f"{error.file}: {error.key}: {error.problem}. {error.remedy}") from None
    print(scene.task("sphere").desired_contacts, scene.objects["sphere"].pose.matrix)
    draft: pinograsp.Draft = pinograsp.new_robot_file("arm.urdf", "my_arm/robot.yaml")
    print(draft.text, draft.wrist, draft.checks, float(draft.pad_sizes[0, 0]))
    report = pinograsp.check_robot("gen3_2f85")
    print(report.wrong, [finding.what for finding in report.findings])
    result = planned(robot, scene, "sphere")
    listed(result.grasps)
    own_configurations(robot, scene)


if __name__ == "__main__":
    main()
