"""What may touch the object, where, and how far from where joints and pads end: figures of the independent check."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import trimesh
from pydantic import TypeAdapter
from test_verification import OPENING, ROOM, Case, configuration, measure, names, place, random_angles, scene_with

from pinograsp.descriptions import Scene, load_robot_description, load_scene
from pinograsp.descriptions.patches import Patch
from pinograsp.descriptions.robot import RobotDescription
from pinograsp.verification.check import Verifier
from pinograsp.verification.meshes import _link_mesh
from pinograsp.verification.robot import read_robot
from pinograsp.verification.shapes.core import PENETRATION
from pinograsp.verification.standing_out import _part, standing_out


@pytest.fixture(scope="module")
def robot() -> RobotDescription:
    return load_robot_description("gen3_2f85")


@pytest.fixture(scope="module")
def case(robot: RobotDescription) -> Case:
    return Case(robot, Verifier(robot, scene_with(enclosure=ROOM), "sphere"))


# ---- what may touch


def patch(**keys: Any) -> Any:
    return TypeAdapter(Patch).validate_python({"origin": [0, 0, 0], "normal": [0, 0, 1], "x_axis": [1, 0, 0]} | keys)


def block(size: list[float], center: list[float]) -> Any:
    return trimesh.creation.box(extents=size).apply_translation(center)


PLANE = patch(type="plane", u=[-0.01, 0.01], v=[-0.01, 0.01])


def test_a_ridge_beside_a_pad_stands_out() -> None:
    """A block whose upper side is the pad, with a ridge of 3 mm at x = 20 mm .. 22 mm."""
    plain = block([0.04, 0.04, 0.02], [0.0, 0.0, -0.01])
    ridge = block([0.002, 0.04, 0.023], [0.021, 0.0, -0.0085])
    assert _part(_link_mesh("tip", [plain]), [PLANE]) is None
    part = _part(_link_mesh("tip", [plain, ridge]), [PLANE])
    assert part is not None
    np.testing.assert_allclose(part.vertices.min(axis=0), [0.02, -0.02, PENETRATION], atol=1e-9)
    np.testing.assert_allclose(part.vertices.max(axis=0), [0.022, 0.02, 0.003], atol=1e-9)
    # A ball of radius 20 mm on the pad's middle: its point towards the ridge's edge is 17 mm below its centre.
    ball = place({"type": "sphere", "radius": 0.02}, np.array([0.0, 0.0, 0.02]))
    assert measure(part, ball) == pytest.approx(math.hypot(0.02, 0.017) - 0.02, abs=1e-7)


def test_what_stands_out_of_two_pads_is_above_both() -> None:
    corner = [block([0.04, 0.04, 0.04], [0.0, 0.0, -0.02]), block([0.002, 0.04, 0.01], [0.025, 0.0, 0.0])]
    side = patch(
        type="plane", origin=[0.02, 0, -0.02], normal=[1, 0, 0], x_axis=[0, 1, 0], u=[-0.01, 0.01], v=[-0.01, 0.01]
    )
    part = _part(_link_mesh("tip", corner), [PLANE, side])
    assert part is not None
    np.testing.assert_allclose(part.vertices.min(axis=0), [0.024, -0.02, PENETRATION], atol=1e-9)


def test_what_stands_out_of_a_round_pad() -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.0101)
    stem = block([0.004, 0.004, 0.03], [0.0, 0.0, -0.02])
    round_pad = patch(type="sphere", radius=0.0101, u=[-1, 1], v=[-1, 1])
    assert _part(_link_mesh("tip", [ball]), [round_pad]) is None
    part = _part(_link_mesh("tip", [ball, stem]), [round_pad])
    assert part is not None
    assert part.vertices[:, 2].min() == pytest.approx(-0.035)
    pipe = patch(type="cylinder", radius=0.0101, u=[-0.01, 0.01], v=[-1, 1], x_axis=[0, 1, 0])
    assert _part(_link_mesh("tip", [ball]), [pipe]) is None  # what is in the cylinder, however far along it


def test_pads_of_shipped_robots_are_flush_with_their_links(robot: RobotDescription) -> None:
    pads = tuple((pad.link, pad.patch) for pad in robot.pads)
    assert standing_out(read_robot(robot), pads) == {}
    assert standing_out(read_robot(robot), pads) is standing_out(read_robot(robot), pads)
    # A pad 2 mm below the rubber lets the rubber stand out.
    deep = tuple(
        (link, patch.model_copy(update={"origin": (0.9 * patch.origin[0], *patch.origin[1:])})) for link, patch in pads
    )
    assert standing_out(read_robot(robot), deep).keys() == {pad.link for pad in robot.pads}


def test_links_that_are_no_pads_keep_a_margin(case: Case) -> None:
    near = case.check(case.scene())["object clearance"]
    assert near.holds
    assert near.limit == pytest.approx(1e-3 - 1e-6)
    assert 1e-3 < near.value < 0.05
    link = near.where.removesuffix(" / sphere")
    assert link not in {pad.link for pad in case.robot.pads}
    margin = load_scene("glovebox").task("sphere").margin.model_dump()
    refuted = case.check(case.scene(margin=margin | {"object": near.value + 1e-5}))
    assert names(refuted) == {"object clearance"}
    assert case.check(case.scene(margin=margin | {"object": near.value - 1e-5})).verified


def test_rubber_that_stands_out_beside_the_pad_is_no_pad(case: Case) -> None:
    """The same grasp of a robot file whose left pad lies 0.3 mm inside of the rubber's surface."""
    pads = list(case.robot.pads)
    x, y, z = pads[0].patch.origin
    pads[0] = pads[0].model_copy(update={"patch": pads[0].patch.model_copy(update={"origin": (0.988 * x, y, z)})})
    certificate = Verifier(case.robot.model_copy(update={"pads": tuple(pads)}), case.scene(), "sphere").check(
        case.claim
    )
    assert {"object clearance", "contact on pad"} <= names(certificate)
    assert certificate["object clearance"].where == f"{pads[0].link} / sphere"


def test_a_pad_that_the_task_does_not_use_is_a_link_like_any(case: Case) -> None:
    """A third pad on the palm changes nothing; two tasks of one robot differ in what may touch."""
    third = case.robot.pads[0].model_copy(update={"name": "palm", "link": "robotiq_85_base_link"})
    robot = case.robot.model_copy(update={"pads": (*case.robot.pads, third)})
    given = case.scene().model_dump()
    given["tasks"]["sphere"] |= {"pads": ("left", "right")}
    certificate = Verifier(robot, Scene.model_validate(given), "sphere").check(case.claim)
    assert certificate == case.check(case.scene())


# ---- where


def can(case: Case, turn: float, **task: Any) -> Scene:
    """Return a can between the pads, its axis turned by an angle from the pads' x axis towards their y axis."""
    across = case.across
    third = np.cross(case.jaw, across)
    z = math.cos(turn) * across + math.sin(turn) * third
    x = case.jaw
    R = np.column_stack([x, np.cross(z, x), z])
    rpy = [math.atan2(R[2, 1], R[2, 2]), math.asin(-R[2, 0]), math.atan2(R[1, 0], R[0, 0])]
    shape = {"type": "cylinder", "radius": case.radius, "height": 0.03}
    given = case.scene().model_dump()
    given["objects"]["sphere"] = {"shape": shape, "pose": {"position": case.center.tolist(), "rpy": rpy}}
    given["tasks"]["sphere"] |= task
    return Scene.model_validate(given)


def test_a_region_holds_for_the_footprint(case: Case) -> None:
    """The pads are 36 x 20 mm: along them a can of 30 mm touches from end to end, across them 20 mm of it.

    Their middles are 0.85 mm from each other that way.
    """
    for turn, half in ((0.0, 0.015), (math.pi / 2, 0.010 + 0.000425)):
        for reach, holds in ((half + 2e-4, True), (half - 2e-4, False)):
            band = {"type": "band", "z": [-reach, reach]}
            certificate = case.check(can(case, turn, allowed_contacts=band))
            assert certificate["contact region"].holds is holds
            assert certificate["contact region"].value == pytest.approx(reach - half, abs=1e-7)
            assert case.check(can(case, turn, allowed_contacts=band, contact_regions="point"))["contact region"].holds


def test_a_forbidden_spot_in_the_middle_of_the_footprint(case: Case) -> None:
    """A ball of 2 mm about a point of the line that lies 8 mm from the contact: neither end is near it."""
    for offset, holds in ((0.0019, False), (0.0021, True)):
        spot = {"type": "ball", "center": [-case.radius, offset, 0.008], "radius": 0.002}
        certificate = case.check(can(case, 0.0, forbidden_contacts=spot))
        assert certificate["contact region"].holds is holds
        assert certificate["contact region"].value == pytest.approx(offset - 0.002, abs=5e-5)


def test_rims_and_edges(case: Case) -> None:
    ball, lying = case.check(case.scene()), case.check(can(case, 0.0))
    assert "surface edge" not in {figure.name for figure in ball.figures}  # a sphere has none
    assert lying["surface edge"].value == pytest.approx(0.015, abs=1e-9)
    rim = ball["pad rim"]
    assert rim.value == pytest.approx(0.010, abs=5e-4)
    assert rim.where in {"left", "right"}
    for reserve, holds in ((rim.value - 1e-5, True), (rim.value + 1e-5, False)):
        certificate = case.check(case.scene(reserve={"rim": reserve}))
        assert certificate["pad rim"].holds is holds
        assert certificate.verified is holds
    assert "surface edge" in names(case.check(can(case, 0.0, reserve={"rim": 0.0151})))


# ---- joints


def test_joint_reserve(case: Case) -> None:
    figure = case.check(case.scene())["joint reserve"]
    expected = {
        name: limit - abs(case.claim.joints[name])
        for name, limit in (("joint_2", 2.24), ("joint_4", 2.57), ("joint_6", 2.09))
    }
    assert figure.where == min(expected, key=expected.__getitem__)
    assert figure.value == pytest.approx(min(expected.values()), abs=1e-9)
    for reserve, holds in ((figure.value - 1e-6, True), (figure.value + 1e-6, False)):
        assert case.check(case.scene(reserve={"joint": reserve}))["joint reserve"].holds is holds


def test_manipulability_is_that_of_pinocchio(case: Case) -> None:
    verifier = Verifier(case.robot, case.scene(), "sphere")
    model = pin.buildModelFromUrdf(str(case.robot.urdf_file))
    data, rng = model.createData(), np.random.default_rng(3)
    frame = model.getFrameId("end_effector_link", pin.BODY)
    for _ in range(5):
        joints = random_angles(verifier, rng, OPENING)
        J = pin.computeFrameJacobian(model, data, configuration(model, joints), frame, pin.LOCAL_WORLD_ALIGNED)[:, :7]
        figure = verifier.check(replace(case.claim, joints=joints))["manipulability"]
        assert figure.value == pytest.approx(math.sqrt(np.linalg.det(J @ J.T)), rel=1e-9)
        assert figure.limit == -math.inf
        assert figure.holds


def test_a_figure_without_a_limit_is_written_as_null(case: Case) -> None:
    written = case.check(case.scene()).to_json()
    [figure] = [figure for figure in written["figures"] if figure["name"] == "manipulability"]
    assert figure["limit"] is None
    assert figure["holds"] is True
    json.dumps(written, allow_nan=False)
