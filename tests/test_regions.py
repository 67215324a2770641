"""Contact regions: smooth for the optimiser, exact in the verification, and what a plan makes of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

import pinograsp
from pinograsp.descriptions.regions import Region
from pinograsp.descriptions.shapes import Shape
from pinograsp.errors import InputError
from pinograsp.geometry.regions import membership
from pinograsp.geometry.shapes import surface_of
from pinograsp.kinematics.contacts import contact_kinematics
from pinograsp.kinematics.forward import forward
from pinograsp.kinematics.reach import arm_reach
from pinograsp.problem import GraspProblem, TaskModel, check_task
from pinograsp.solve.projection import initial_guesses
from pinograsp.verification import Claim
from pinograsp.verification.check import Verifier
from pinograsp.verification.regions import depth
from pinograsp.verification.shapes import GEOMETRY

READ = TypeAdapter(Region)
FINITE = st.floats(-0.05, 0.05)
LEAVES = st.one_of(
    st.builds(
        lambda a, b, d: {
            "type": "half_space",
            "normal": [math.cos(a) * math.cos(b), math.sin(a) * math.cos(b), math.sin(b)],
            "offset": d,
        },
        st.floats(-3, 3),
        st.floats(-1.5, 1.5),
        FINITE,
    ),
    st.builds(lambda low, size: {"type": "band", "z": [low, low + size]}, FINITE, st.floats(0.01, 0.05)),
    st.builds(
        lambda m, w: {"type": "sector", "middle": m, "half_width": w}, st.floats(-6, 6), st.floats(0.1, math.pi - 0.1)
    ),
    st.builds(lambda *c, r: {"type": "ball", "center": c, "radius": r}, *[FINITE] * 3, r=st.floats(0.01, 0.05)),
    st.builds(
        lambda points, r: {"type": "near", "points": points, "radius": r},
        st.lists(st.tuples(*[FINITE] * 3), min_size=1, max_size=3),
        r=st.floats(0.01, 0.05),
    ),
    st.builds(lambda *c: {"type": "box", "min": [v - 0.02 for v in c], "max": [v + 0.02 for v in c]}, *[FINITE] * 3),
)
REGIONS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.builds(lambda parts: {"type": "all_of", "parts": parts}, st.lists(inner, min_size=1, max_size=3)),
        st.builds(lambda parts: {"type": "any_of", "parts": parts}, st.lists(inner, min_size=1, max_size=3)),
        st.builds(lambda part: {"type": "outside", "part": part}, inner),
    ),
    max_leaves=5,
)
POINTS = st.tuples(*[FINITE] * 3).map(np.array)


@settings(max_examples=300)
@given(region=REGIONS, point=POINTS)
def test_smooth_membership_is_safe_and_tight(region: dict[str, Any], point: Any) -> None:
    """Inside for the optimiser is inside; and what is well inside is inside for the optimiser."""
    read = READ.validate_python(region)
    [value], _ = membership(read)(point[None])
    exact = depth(read, point)
    if value > 1e-9:
        assert exact > 0
    if value < -0.003:
        assert exact < 0.003


@settings(max_examples=200)
@given(region=REGIONS, point=POINTS)
def test_gradient_of_membership(region: dict[str, Any], point: Any) -> None:
    assume(math.hypot(point[0], point[1]) > 2e-3)
    function = membership(READ.validate_python(region))
    [value], [gradient] = function(point[None])
    step = 1e-7
    ahead = np.array([function((point + e)[None])[0][0] - value for e in step * np.eye(3)]) / step
    behind = np.array([value - function((point - e)[None])[0][0] for e in step * np.eye(3)]) / step
    assume(np.abs(ahead - behind).max() < 0.1)  # the centre of a ball has no gradient
    np.testing.assert_allclose(gradient, (ahead + behind) / 2, atol=2e-4)


@pytest.mark.parametrize(
    ("region", "inside", "outside"),
    [
        ({"type": "band", "z": [0.01, 0.02]}, (0.0, 0.0, 0.015), (0.0, 0.0, 0.021)),
        ({"type": "sector", "middle": 3.1, "half_width": 0.2}, (-1.0, -0.1, 0.0), (-1.0, -0.3, 0.0)),
        ({"type": "sector", "middle": 0.0, "half_width": 3.0}, (-1.0, 0.2, 0.0), (-1.0, 0.01, 0.0)),
        ({"type": "ball", "center": [1, 0, 0], "radius": 0.5}, (1.4, 0.0, 0.0), (0.4, 0.0, 0.0)),
        ({"type": "near", "points": [[1, 0, 0], [-1, 0, 0]], "radius": 0.5}, (-1.4, 0.0, 0.0), (0.4, 0.0, 0.0)),
        ({"type": "box", "min": [0, 0, 0], "max": [1, 2, 3]}, (0.9, 1.9, 2.9), (0.9, 2.1, 2.9)),
        (
            {"type": "outside", "part": {"type": "all_of", "parts": [{"type": "band", "z": [0, 1]}]}},
            (0.0, 0.0, 1.1),
            (0.0, 0.0, 0.5),
        ),
    ],
)
def test_known_points(region: dict[str, Any], inside: Any, outside: Any) -> None:
    read = READ.validate_python(region)
    assert depth(read, np.array(inside)) > 0 > depth(read, np.array(outside))
    values, _ = membership(read)(np.array([inside, outside], dtype=float))
    assert values[0] > 0 > values[1]


@pytest.mark.parametrize(
    "region",
    [
        {"type": "band", "z": [0.02, 0.01]},
        {"type": "half_space", "normal": [0, 0, 2], "offset": 0},
        {"type": "sector", "middle": 0, "half_width": 4},
        {"type": "ball", "center": [0, 0, 0], "radius": 0},
        {"type": "near", "points": [], "radius": 0.1},
        {"type": "all_of", "parts": []},
        {"type": "ring"},
    ],
    ids=lambda region: region["type"],
)
def test_senseless_regions_are_refused(region: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        READ.validate_python(region)


def test_allowed_and_not_forbidden(glovebox: Any) -> None:
    task = glovebox.task("sphere")
    assert task.contact_region is None
    low, high = ({"type": "band", "z": z} for z in ([-1, 0.5], [0.2, 1]))
    content = task.model_dump() | {"allowed_contacts": low, "forbidden_contacts": high}
    region = type(task).model_validate(content).contact_region
    heights = {z: depth(region, np.array([0, 0, z])) > 0 for z in (0.1, 0.3, 0.6)}
    assert heights == {0.1: True, 0.3: False, 0.6: False}


def test_case_3_contacts_stay_in_the_band(gen3: Any) -> None:
    """The paper's case 3: lines of contact from the border of the band on, half a millimetre beyond the contact points.

    So U is just above 2 * 34.5^2 + V*.
    """
    scene = pinograsp.load_scene("glovebox_can")
    result = pinograsp.plan(gen3, scene, "can_region", starts=16, workers=1)
    assert result.verified >= 13
    assert result.refuted == 0
    assert 2382.67 < result.ranked("U")[0].cost.U < 2384
    for grasp in result.grasps:
        assert grasp.certificate["contact region"].holds
        assert all(contact.point[2] - (-0.178) >= 0.034 for contact in grasp.contacts)


def test_a_contact_outside_its_region_is_refuted(gen3: Any) -> None:
    """A grasp of the whole can, checked as one of the limited region."""
    scene = pinograsp.load_scene("glovebox_can")
    best = pinograsp.plan(gen3, scene, "can", starts=8, workers=1).best
    assert best is not None
    claim = Claim(
        best.joints,
        *(np.array([getattr(c, name) for c in best.contacts]) for name in ("point", "force", "spin_torque")),
    )
    assert Verifier(gen3.description, scene, "can").check(claim).verified
    refuted = Verifier(gen3.description, scene, "can_region").check(claim).refuted_by
    assert [figure.name for figure in refuted] == ["contact region"]


def test_derivatives_of_a_problem_with_a_region(gen3: Any) -> None:
    problem = GraspProblem(TaskModel(gen3, pinograsp.load_scene("glovebox_can"), "can_region"), (0, 1))
    rng = np.random.default_rng(0)
    start = np.array([0.54, -0.33, -0.47, 1.83, 3.0, 1.6, 1.5, 0.05, 0.0, 0.0, 0.0, 0.0])

    def values(x: Any) -> Any:
        at = problem.evaluate(x)
        return np.concatenate([[at.cost], at.equalities.values, at.inequalities.values])

    for spread in (0.01, 0.1):
        x = next(initial_guesses(problem, start, "contacts")) + spread * rng.normal(size=12) * ([1.0] * 8 + [0.01] * 4)
        evaluation = problem.evaluate(x)
        assert evaluation.inequalities.values.shape == (len(problem.rows.inequalities),)
        jacobians = (evaluation.cost_gradient, evaluation.equalities.jacobian, evaluation.inequalities.jacobian)
        step = 1e-7
        numeric = np.column_stack([(values(x + e) - values(x - e)) / (2 * step) for e in step * np.eye(12)])
        size = 1 + np.abs(numeric).max(axis=1, keepdims=True)
        wrong = np.abs(np.vstack(jacobians) - numeric).max(axis=1) / size[:, 0]
        links = sum(row.startswith("clearance of") for row in problem.rows.inequalities)
        assert wrong[:-links].max() < 1e-5
        assert wrong[-links:].max() < 5e-3  # Coal's distances to a cylinder are good to 1e-7 m, differences to little


@pytest.mark.parametrize(
    "shape",
    [
        {"type": "sphere", "radius": 0.04},
        {"type": "box", "size": [0.05, 0.1, 0.2]},
        {"type": "cylinder", "radius": 0.0423, "height": 0.118},
    ],
    ids=lambda shape: shape["type"],
)
def test_both_readings_of_a_shape_agree(shape: dict[str, Any]) -> None:
    """The verification's geometry is written anew; it gives what the optimiser's gives."""
    read = TypeAdapter(Shape).validate_python(shape)
    geometry, surface = GEOMETRY[type(read)](read), surface_of(read)
    points = np.random.default_rng(0).uniform(-0.15, 0.15, (200, 3))
    distances, gradients, _ = surface.signed_distance(points)
    assert [geometry.distance(point) for point in points] == pytest.approx(distances)
    on_surface = points - distances[:, None] * gradients
    smooth = np.ones(200, dtype=bool)  # away from edges
    if shape["type"] == "box":
        smooth = np.abs(gradients).max(axis=1) > 1 - 1e-12
    elif shape["type"] == "cylinder":
        smooth = (np.abs(gradients[:, 2]) > 1 - 1e-12) | (gradients[:, 2] == 0)
    assert smooth.sum() > 10
    for point, gradient in zip(on_surface[smooth] + 1e-9 * gradients[smooth], gradients[smooth], strict=True):
        np.testing.assert_allclose(geometry.inward(point), -gradient, atol=1e-6)
    center = np.array([0.01, 0.02, 0.03])
    assert geometry.radius_about(center) >= np.linalg.norm(on_surface - center, axis=1).max() - 1e-9


# ---- regions that nothing can touch


def with_region(scene: Any, task: str, **region: Any) -> Any:
    """Return the scene with the contact region of a task replaced."""
    content = scene.model_dump()
    content["tasks"][task] |= {"allowed_contacts": None, "forbidden_contacts": None} | region
    return type(scene).model_validate(content)


UNDERSIDE = {"type": "box", "min": [-0.03, -0.03, -0.06], "max": [0.03, 0.03, -0.058]}


@pytest.mark.parametrize(
    ("region", "words"),
    [
        ({"allowed_contacts": {"type": "band", "z": [0.2, 0.3]}}, "no point of the surface of 'can' is left"),
        ({"forbidden_contacts": {"type": "ball", "center": [0, 0, 0], "radius": 1}}, "no point of the surface"),
        ({"allowed_contacts": UNDERSIDE}, "against a wall"),
    ],
)
def test_region_without_any_point_to_touch(gen3: Any, region: dict[str, Any], words: str) -> None:
    scene = with_region(pinograsp.load_scene("glovebox_can"), "can", **region)
    with pytest.raises(InputError, match=words) as caught:
        check_task(TaskModel(gen3, scene, "can"))
    assert caught.value.file == scene.source
    assert caught.value.key == f"tasks.can.{next(iter(region))}"


def test_region_beyond_the_arm(gen3: Any) -> None:
    content = pinograsp.load_scene("glovebox_can").model_dump()
    content["enclosure"]["max"] = (3.0, 0.42, 0.363)
    content["objects"]["can"]["pose"]["position"] = (2.0, 0.02, -0.178)
    scene = with_region(type(pinograsp.load_scene("glovebox_can")).model_validate(content), "can", allowed_contacts=TOP)
    with pytest.raises(InputError, match=r"1\.8\d m from the first arm joint, and the pads reach 1\.2\d m at most"):
        check_task(TaskModel(gen3, scene, "can"))


TOP = {"type": "band", "z": [0.0, 0.06]}


def test_reach_bounds_every_contact(gen3: Any, paper: Any) -> None:
    rng = np.random.default_rng(1)
    for robot in (gen3, paper):
        base, reach = arm_reach(robot)
        farthest = 0.0
        for _ in range(300):
            posture = rng.uniform(robot.lower, robot.upper)
            parameters = rng.uniform(*robot.parameter_limits.T)
            points = contact_kinematics(forward(robot, robot.model.createData(), posture), parameters).points
            farthest = max(farthest, float(np.linalg.norm(points - base, axis=1).max()))
        assert 0.7 * reach < farthest < reach


def test_desired_points_outside_the_region_are_said_not_refused(gen3: Any) -> None:
    model = TaskModel(gen3, pinograsp.load_scene("glovebox_can"), "can_region")
    warnings = check_task(model)
    assert [w[:20] for w in warnings] == ["desired_contacts[0] ", "desired_contacts[1] "]
    assert "34.0 mm" in warnings[0]
    assert check_task(TaskModel(gen3, model.scene, "can")) == []
    result = pinograsp.plan(gen3, model.scene, "can_region", starts=1, workers=1)
    assert result.warnings == tuple(warnings)
