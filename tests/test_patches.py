"""Surfaces of pads: points, normals and derivatives, the independent judgement of a point, and what files may say."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
import yaml
from conftest import TOY_ROBOT, TOY_URDF, Array, collision_model, random_parameters, with_patches
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from pinograsp import InputError, Robot, load_robot
from pinograsp.descriptions import Scene, schema
from pinograsp.descriptions.patches import CylinderPatch, LinePatch, Patch, PlanePatch, SpherePatch
from pinograsp.descriptions.urdf import read_urdf
from pinograsp.geometry.patches import above, patch_point
from pinograsp.kinematics.contacts import contact_kinematics
from pinograsp.kinematics.forward import forward
from pinograsp.kinematics.robot import SLIDE_STEP, SLIP_STEP, TURN_STEP
from pinograsp.verification.contacts import Pads
from pinograsp.verification.kinematics import Kinematics, parsed
from pinograsp.verification.patches import nearest_on_patch

FRAME = {"origin": (0.0, 0.0, 0.0), "normal": (0.0, 0.0, 1.0), "x_axis": (1.0, 0.0, 0.0)}
FLAT = ("plane", "line")
CURVED = ("cylinder", "sphere")
STEP = 1e-6


def patch_of(kind: str, **changes: Any) -> Patch:
    given_by_kind: dict[str, dict[str, Any]] = {
        "plane": {"u": (-0.02, 0.03), "v": (-0.01, 0.015)},
        "line": {"u": (-0.04, 0.01)},
        "cylinder": {"u": (-0.02, 0.03), "v": (-0.7, 2.5), "radius": 0.012},
        "sphere": {"u": (-2.6, 1.1), "v": (-0.9, 1.4), "radius": 0.015},
    }
    return TypeAdapter(Patch).validate_python(FRAME | {"type": kind} | given_by_kind[kind] | changes)


def test_a_frame_of_a_few_digits_is_a_rotation() -> None:
    """File and check allow for rounding; points and normals on the patch do not agree unless the frame is exact."""
    R = patch_of("sphere", normal=(0.0, 0.6, 0.8000004), x_axis=(0.0, 0.8000003, -0.6)).rotation
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(R, [[0.0, -1.0, 0.0], [0.8, 0.0, 0.6], [-0.6, 0.0, 0.8]], atol=1e-6)


@st.composite
def patches(draw: st.DrawFn, kinds: tuple[str, ...] = (*FLAT, *CURVED)) -> Patch:
    """Return a patch of any kind, size and range."""

    def interval(low: float, high: float) -> tuple[float, float]:
        first, second = sorted(draw(st.tuples(st.floats(low, high), st.floats(low, high))))
        width = 0.02 * (high - low)  # at least, so that there is an inside
        return (first, second) if second - first > width else (max(low, first - width), min(high, second + width))

    kind = draw(st.sampled_from(kinds))
    ranges: dict[str, Any] = {"u": interval(-math.pi, math.pi) if kind == "sphere" else interval(-0.05, 0.05)}
    if kind != "line":
        most = {"plane": 0.05, "cylinder": math.pi, "sphere": 1.5}[kind]
        ranges["v"] = interval(-most, most)
    if kind in CURVED:
        ranges["radius"] = draw(st.floats(1e-3, 0.1))
    return patch_of(kind, **ranges)


@st.composite
def places(draw: st.DrawFn, kinds: tuple[str, ...] = (*FLAT, *CURVED)) -> tuple[Patch, Array]:
    """Return a patch and parameters within their ranges."""
    patch = draw(patches(kinds))
    return patch, np.array([draw(st.floats(low, high)) for low, high in patch.parameters])


# ---- points, normals, derivatives


def test_every_patch_is_tried() -> None:
    """Here and by the registries of points, heights and judgements."""
    types = {PlanePatch, LinePatch, CylinderPatch, SpherePatch}
    assert {type(patch_of(kind)) for kind in (*FLAT, *CURVED)} == types
    for function in (patch_point, above):
        assert set(function.registry) == {object, *types}


def test_points_by_hand() -> None:
    np.testing.assert_allclose(patch_point(patch_of("plane"), np.array([0.01, -0.02])).point, [0.01, -0.02, 0.0])
    np.testing.assert_allclose(patch_point(patch_of("line"), np.array([-0.03])).point, [-0.03, 0.0, 0.0])
    cylinder, sphere = patch_of("cylinder", radius=0.5), patch_of("sphere", radius=0.5)
    for at, point, normal in (
        (patch_point(cylinder, np.array([0.02, 0.0])), [0.02, 0.0, 0.5], [0, 0, 1]),
        (patch_point(cylinder, np.array([0.02, math.pi / 2])), [0.02, 0.5, 0.0], [0, 1, 0]),
        (patch_point(sphere, np.array([0.0, 0.0])), [0.0, 0.0, 0.5], [0, 0, 1]),
        (patch_point(sphere, np.array([math.pi / 2, 0.0])), [0.5, 0.0, 0.0], [1, 0, 0]),
        (patch_point(sphere, np.array([0.0, math.pi / 2])), [0.0, 0.5, 0.0], [0, 1, 0]),
    ):
        np.testing.assert_allclose(at.point, point, atol=1e-15)
        np.testing.assert_allclose(at.normal, normal, atol=1e-15)


@given(place=places())
def test_normal_is_a_unit_vector_across_the_surface(place: tuple[Patch, Array]) -> None:
    at = patch_point(*place)
    assert np.linalg.norm(at.normal) == pytest.approx(1.0)
    assert at.d_point.shape == at.d_normal.shape == (3, len(place[1]))
    np.testing.assert_allclose(at.normal @ at.d_point, 0.0, atol=1e-12)
    if len(place[1]) == 2:
        u, v = at.d_point.T
        assert np.cross(u, v) @ at.normal == pytest.approx(np.linalg.norm(u) * np.linalg.norm(v))


@given(place=places())
def test_derivatives(place: tuple[Patch, Array]) -> None:
    patch, parameters = place
    at = patch_point(patch, parameters)
    for k, step in enumerate(STEP * np.eye(len(parameters))):
        plus, minus = patch_point(patch, parameters + step), patch_point(patch, parameters - step)
        np.testing.assert_allclose(at.d_point[:, k], (plus.point - minus.point) / (2 * STEP), atol=1e-9)
        np.testing.assert_allclose(at.d_normal[:, k], (plus.normal - minus.normal) / (2 * STEP), atol=1e-9)


@given(place=places(CURVED))
def test_radius_is_that_of_curvature(place: tuple[Patch, Array]) -> None:
    """The normal turns by the way along the surface over the radius; along a cylinder it does not turn."""
    patch, parameters = place
    at = patch_point(patch, parameters)
    turns = at.d_normal
    if isinstance(patch, CylinderPatch):
        np.testing.assert_allclose(turns[:, 0], 0.0)
        turns, ways = turns[:, 1], at.d_point[:, 1]
    else:
        ways = at.d_point
    np.testing.assert_allclose(patch.radius * turns, ways, atol=1e-12)


# ---- heights


@given(place=places(), height=st.floats(-5e-4, 0.05))
def test_above(place: tuple[Patch, Array], height: float) -> None:
    """Zero on the surface, positive outwards, negative inwards."""
    at = patch_point(*place)
    points = np.array([at.point, at.point + height * at.normal])
    np.testing.assert_allclose(above(place[0], points), [0.0, height], atol=1e-12)


def test_a_link_inside_its_curved_pad_has_no_distance_to_the_object(
    gen3: Robot, curved_gen3: Robot, glovebox: Scene
) -> None:
    """A ball or a rod of 1 m that holds a finger tip bounds it as a plane does; one of 40 mm does not hold it."""

    def against_object(robot: Robot) -> set[str]:
        model = collision_model(robot, glovebox, "sphere")
        return {pair.link for pair in model.pairs if pair.kind == "object clearance"}

    tips = {pad.link for pad in gen3.description.pads}
    ball = {"type": "sphere", "radius": 1.0, "origin": (0.974, -0.0008, 0.032), "v": (-0.1, 0.1)}
    rod = {"type": "cylinder", "radius": 1.0, "origin": (-0.974, 0.0, 0.032), "v": (-0.1, 0.1)}
    assert not tips & against_object(with_patches(gen3, ball, rod))
    assert tips <= against_object(curved_gen3)


# ---- the independent judgement


@given(place=places())
def test_judgement_of_points_on_the_pad(place: tuple[Patch, Array]) -> None:
    at = patch_point(*place)
    distance, normal = nearest_on_patch(place[0], at.point)
    assert distance == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(normal, at.normal, atol=1e-9)


@given(place=places(), height=st.floats(-5e-4, 0.05))
def test_judgement_of_points_off_the_pad(place: tuple[Patch, Array], height: float) -> None:
    at = patch_point(*place)
    distance, normal = nearest_on_patch(place[0], at.point + height * at.normal)
    assert distance == pytest.approx(abs(height), abs=1e-12)
    np.testing.assert_allclose(normal, at.normal, atol=1e-9)


OUTSIDE = [
    (kind, parameter, end, 1.0 if kind == "sphere" or (kind == "cylinder" and parameter) else 0.01)
    for kind in (*FLAT, *CURVED)
    for parameter in range(1 if kind == "line" else 2)
    for end in (0, 1)
]


@pytest.mark.parametrize(("kind", "parameter", "end", "unit"), OUTSIDE)
def test_judgement_of_points_beyond_the_ranges(kind: str, parameter: int, end: int, unit: float) -> None:
    """A point of the surface a little beyond an end of a range is as far off as it is from that end."""
    patch = patch_of(kind)
    x = np.array([0.5 * (low + high) for low, high in patch.parameters])
    x[parameter] = patch.parameters[parameter][end]
    edge = patch_point(patch, x)
    for beyond in (1e-6, 0.01, 0.1):
        off = x.copy()
        off[parameter] += (2 * end - 1) * beyond * unit
        point = patch_point(patch, off).point
        distance, normal = nearest_on_patch(patch, point)
        assert distance > 0.0
        expected = float(np.linalg.norm(point - edge.point))
        if (kind, parameter) == ("sphere", 0):
            assert distance == pytest.approx(expected, rel=0.02)
            assert distance <= expected + 1e-15
        else:
            assert distance == pytest.approx(expected, rel=1e-6)
            np.testing.assert_allclose(normal, edge.normal, atol=1e-9)


@pytest.mark.parametrize("kind", [*FLAT, *CURVED])
def test_judgement_is_the_least_distance(kind: str) -> None:
    """From points all round, against a fine grid of the pad: never more, and hardly less."""
    patch, rng = patch_of(kind), np.random.default_rng(0)
    grid = np.stack(np.meshgrid(*[np.linspace(*ends, 120) for ends in patch.parameters]), -1)
    points = np.array([patch_point(patch, x).point for x in grid.reshape(-1, len(patch.parameters))])
    for point in rng.uniform(-0.05, 0.05, (60, 3)):
        distance, normal = nearest_on_patch(patch, point)
        least = float(np.linalg.norm(points - point, axis=1).min())
        assert least - 1e-3 < distance <= least + 1e-12
        assert np.linalg.norm(normal) == pytest.approx(1.0)


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e200])
@pytest.mark.parametrize("kind", [*FLAT, *CURVED])
def test_judgement_of_no_point(kind: str, bad: float) -> None:
    """Numbers that are none refute a claim, they do not stop the check."""
    with np.errstate(all="ignore"):
        distance, _ = nearest_on_patch(patch_of(kind), np.array([0.001, bad, bad]))
    assert not distance <= 1e-6


@pytest.mark.parametrize("name", ["curved_gen3", "mixed_toy", "paper"])
def test_judgement_agrees_with_the_model_on_whole_robots(name: str, request: pytest.FixtureRequest) -> None:
    """Contact points and normals of the model, judged with link poses that the verification computes itself."""
    robot: Robot = request.getfixturevalue(name)
    description, rng = robot.description, np.random.default_rng(3)
    kinematics = Kinematics(parsed(read_urdf(description), description.urdf_file), description.urdf_file)
    for _ in range(5):
        posture = rng.uniform(robot.lower, robot.upper)
        contacts = contact_kinematics(
            forward(robot, robot.model.createData(), posture), random_parameters(robot, rng, 0.99)
        )
        pads = Pads.at(description.pads, kinematics.poses(robot.joints_by_name(posture)))
        distances, normals = pads.nearest(contacts.points)
        np.testing.assert_allclose(distances, 0.0, atol=1e-12)
        np.testing.assert_allclose(normals, contacts.normals, atol=1e-9)
        distances, _ = pads.nearest(contacts.points + 0.003 * contacts.normals)
        np.testing.assert_allclose(distances, 0.003, atol=1e-12)


# ---- files

PLANE = TOY_ROBOT["pads"][0]["patch"]


@pytest.mark.parametrize(
    ("old", "changes", "key", "words"),
    [
        ("type", {"type": "cone"}, "type", "'cone' is not known"),
        ("type", {"type": "shpere"}, "type", "Did you mean sphere"),
        ("type", {}, "type", "missing"),
        ("v", {}, "v", "missing"),
        ("x", {"type": "line"}, "v", "unknown key"),
        ("x", {"type": "cylinder"}, "radius", "missing"),
        ("x", {"type": "sphere"}, "radius", "missing"),
        ("x", {"type": "sphere", "radius": 0}, "radius", "greater than 0"),
        ("x", {"radius": 0.1}, "radius", "unknown key"),
        ("x", {"type": "cylinder", "radius": 0.1, "v": [-0.1, 3.2]}, "v", "within -pi .. pi"),
        ("x", {"type": "cylinder", "radius": 0.1, "v": [0.2, -0.1]}, "v", "0.2 is not below the upper end -0.1"),
        ("x", {"type": "sphere", "radius": 0.1, "u": [-3.2, 0.1]}, "u", "within -pi .. pi"),
        ("x", {"type": "sphere", "radius": 0.1, "v": [-0.1, 1.6]}, "v", "within -1.5 .. 1.5"),
        ("x", {"type": "sphere", "radius": 0.1, "w": 1}, "w", "Known: normal, origin, radius"),
        ("x", {"type": "sphere", "raduis": 0.1}, "raduis", "Did you mean radius"),
        ("x", {"type": "line", "v": None}, "v", "unknown key"),
        ("x", {"type": "cylinder", "radius": 0.1, "normal": [0.0, 0.0, 1.0]}, "x_axis", "perpendicular"),
    ],
    ids=str,
)
def test_patch_that_is_refused(old: str, changes: dict[str, Any], key: str, words: str, tmp_path: Path) -> None:
    left, right = TOY_ROBOT["pads"]
    patch = {name: value for name, value in PLANE.items() if name != old} | changes
    (tmp_path / "toy.urdf").write_text(TOY_URDF)
    file = tmp_path / "robot.yaml"
    content = TOY_ROBOT | {"pads": [left, right | {"patch": patch}]}
    file.write_text(yaml.safe_dump(content))
    with pytest.raises(InputError) as caught:
        load_robot(file)
    assert (caught.value.file, caught.value.key) == (file, f"pads[1].patch.{key}")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    if "missing" in words or "unknown key" in str(caught.value):
        assert not jsonschema.Draft202012Validator(schema("robot")).is_valid(content)  # an editor says so too


def test_whole_turns_are_allowed() -> None:
    turn = (-math.pi, math.pi)
    assert patch_of("cylinder", v=turn).parameters[1] == turn
    assert patch_of("sphere", u=turn, v=(-1.5, 1.5)).parameters == (turn, (-1.5, 1.5))
    for kind in CURVED:  # the seam has no outside
        patch = patch_of(kind, **{"v" if kind == "cylinder" else "u": turn})
        for point in ([0.0, 0.0, -0.02], [0.0, 1e-9, -0.02], [-1e-9, -1e-9, -0.02]):
            assert nearest_on_patch(patch, np.array(point))[0] == pytest.approx(0.02 - patch.radius, abs=1e-8)


def test_parameters_of_a_robot_follow_its_pads(mixed_toy: Robot, paper: Robot) -> None:
    assert [pad.parameters for pad in mixed_toy.pads] == [slice(0, 1), slice(1, 3)]
    assert mixed_toy.parameter_limits.tolist() == [[-0.015, 0.01], [-0.5, 0.6], [0.1, 0.5]]
    assert [pad.parameters for pad in paper.pads] == [slice(0, 1), slice(1, 2)]


def test_units_of_steps(mixed_toy: Robot) -> None:
    """A unit of every contact parameter moves the contact as far in the middle of the pad."""
    radius, middle = 0.02, 0.3
    expected = [TURN_STEP, SLIDE_STEP, SLIP_STEP, SLIP_STEP / (radius * math.cos(middle)), SLIP_STEP / radius]
    np.testing.assert_allclose(mixed_toy.step_units, expected)
