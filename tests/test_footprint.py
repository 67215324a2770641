"""Footprints of contacts, their depth in regions, rims of pads and edges of objects; all by the independent check."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydantic import TypeAdapter
from test_regions import READ, REGIONS

from pinograsp.descriptions.bodies import Body
from pinograsp.descriptions.patches import Patch
from pinograsp.verification.footprint import footprint, thinned
from pinograsp.verification.patches import contact_face, rim_distance
from pinograsp.verification.region_depth import RESOLUTION, least_depth
from pinograsp.verification.regions import depths
from pinograsp.verification.shapes import PlacedShape

Array = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])
FRAME = {"origin": [0, 0, 0], "normal": [0, 0, 1], "x_axis": [1, 0, 0]}


def patch(**keys: Any) -> Any:
    return TypeAdapter(Patch).validate_python(FRAME | keys)


def placed(shape: dict[str, Any], **pose: Any) -> PlacedShape:
    return PlacedShape("thing", Body.model_validate({"shape": shape, "pose": pose}))


PLANE = patch(type="plane", u=[-0.02, 0.02], v=[-0.01, 0.01])
CAN = {"type": "cylinder", "radius": 0.04, "height": 0.1}
BOX = {"type": "box", "size": [0.1, 0.2, 0.3]}


def area(polygon: Array) -> float:
    x, y = polygon[:, 0], polygon[:, 1]
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def on_the_pad(shape: dict[str, Any], position: Any, rpy: Any, point: Any = (0.0, 0.0, 0.0), pad: Any = PLANE) -> Array:
    """Return the footprint on a pad that faces up, of a shape above it."""
    body = placed(shape, position=list(position), rpy=list(rpy))
    at = np.array(point, dtype=float)
    return body.footprint(contact_face(pad, at), at, -body.inward(at))


def ends(line: Array) -> list[tuple[float, ...]]:
    return sorted(tuple(np.round(end, 9).tolist()) for end in line)


# ---- what touches


def test_a_sphere_touches_in_a_point() -> None:
    found = on_the_pad({"type": "sphere", "radius": 0.03}, (0.01, 0.0, 0.03), (0, 0, 0), (0.01, 0.0, 0.0))
    np.testing.assert_allclose(found, [[0.01, 0.0, 0.0]], atol=1e-15)


@pytest.mark.parametrize(
    ("turn", "position", "expected"),
    [
        (0.0, (0.0, 0.0), [(-0.02, 0.0, 0.0), (0.02, 0.0, 0.0)]),  # the pad ends first
        (0.0, (0.04, 0.005), [(-0.01, 0.005, 0.0), (0.02, 0.005, 0.0)]),  # the can ends first on one side
        (math.pi / 2, (0.0, 0.0), [(0.0, -0.01, 0.0), (0.0, 0.01, 0.0)]),
        (math.pi / 4, (0.0, 0.0), [(-0.01, -0.01, 0.0), (0.01, 0.01, 0.0)]),
    ],
)
def test_the_side_of_a_can_touches_along_a_line(turn: float, position: Any, expected: Any) -> None:
    point = (0.0, position[1], 0.0)
    found = on_the_pad(CAN, (*position, 0.04), (0.0, math.pi / 2, turn), point)
    np.testing.assert_allclose(ends(found), expected, atol=1e-9)


def test_flat_faces_touch_over_an_area() -> None:
    corner = on_the_pad(BOX, (0.06, 0.0, 0.15), (0, 0, 0), (0.015, 0.0, 0.0))  # from x = 0.01 on
    assert area(corner) == pytest.approx(0.01 * 0.02)
    np.testing.assert_allclose(corner.min(axis=0), [0.01, -0.01, 0.0], atol=1e-12)
    cap = on_the_pad(CAN, (0.0, 0.0, 0.05), (0, 0, 0))
    assert area(cap) == pytest.approx(0.04 * 0.02)
    small = on_the_pad(CAN | {"radius": 0.005}, (0.01, 0.0, 0.05), (0, 0, 0), (0.01, 0.0, 0.0))
    assert area(small) == pytest.approx(math.pi * 0.005**2, rel=1e-4)
    half = on_the_pad(CAN | {"radius": 0.005}, (0.02, 0.0, 0.05), (0, 0, 0), (0.02, 0.0, 0.0))
    assert area(half) == pytest.approx(math.pi * 0.005**2 / 2, rel=1e-4)


@pytest.mark.parametrize(("degrees", "corners"), [(0.0, 2), (0.9, 2), (1.1, 1), (90.0, 1)])
def test_lines_touch_along_a_line_if_they_are_parallel(degrees: float, corners: int) -> None:
    pad = patch(type="cylinder", radius=0.01, u=[-0.02, 0.02], v=[-1.0, 1.0])
    point = np.array([0.005, 0.0, 0.01])
    found = on_the_pad(CAN, (0.0, 0.0, 0.05), (0.0, math.pi / 2, math.radians(degrees)), point, pad)
    assert len(found) == corners
    if corners == 2:
        np.testing.assert_allclose(np.linalg.norm(found[1] - found[0]), 0.04, rtol=1e-3)


def test_a_line_with_a_width_is_a_rectangle() -> None:
    narrow, wide = (patch(type="line", u=[-0.01, 0.03], width=width) for width in (0.0, 0.006))
    assert area(on_the_pad(BOX, (0.0, 0.0, 0.15), (0, 0, 0), pad=wide)) == pytest.approx(0.04 * 0.006)
    np.testing.assert_allclose(
        ends(on_the_pad(BOX, (0.0, 0.0, 0.15), (0, 0, 0), pad=narrow)), [(-0.01, 0.0, 0.0), (0.03, 0.0, 0.0)]
    )


def test_a_line_along_the_rim_stays_whole() -> None:
    """A can that lies along the rim of the pad, 0.01 um outside of it."""
    found = on_the_pad(CAN, (0.0, 0.01 + 1e-8, 0.04), (0.0, math.pi / 2, 0.0), (0.0, 0.01 + 1e-8, 0.0))
    np.testing.assert_allclose(ends(found), [(-0.02, 0.01, 0.0), (0.02, 0.01, 0.0)], atol=2e-8)


@settings(max_examples=200)
@given(st.integers(0, 2**32 - 1))
def test_two_areas_have_their_common_points(seed: int) -> None:
    """Points of the plane are in the footprint if they are in both faces; by sides of triangles of the corners."""
    rng = np.random.default_rng(seed)
    angles = [np.sort(rng.uniform(0.0, 2 * math.pi, count)) for count in rng.integers(3, 40, 2)]
    faces = [
        np.column_stack([np.cos(a), np.sin(a), 0 * a]) * 0.02 + rng.uniform(-0.01, 0.01, 3) * [1, 1, 0] for a in angles
    ]
    points = np.column_stack([rng.uniform(-0.03, 0.03, (300, 2)), np.zeros(300)])
    common = inside(faces[0], points) & inside(faces[1], points)
    if not common.any():
        return
    start = points[np.flatnonzero(common)[0]]
    for given_faces in (faces, faces[::-1]):
        found = footprint(given_faces[0][:: rng.choice([-1, 1])], given_faces[1], start, UP)
        assert len(found) >= 3
        np.testing.assert_array_equal(inside(found, points), common)


def inside(polygon: Array, points: Array) -> NDArray[np.bool_]:
    along = np.roll(polygon, -1, axis=0) - polygon
    turns = along[:, 0] * (points[:, None, 1] - polygon[:, 1]) - along[:, 1] * (points[:, None, 0] - polygon[:, 0])
    return np.asarray((turns > 0).all(axis=1) | (turns < 0).all(axis=1))


SHAPES = st.sampled_from([CAN, BOX, {"type": "sphere", "radius": 0.03}])
PADS = st.sampled_from(
    [
        PLANE,
        patch(type="line", u=[-0.01, 0.02]),
        patch(type="line", u=[-0.01, 0.02], width=0.01),
        patch(type="cylinder", radius=0.01, u=[-0.02, 0.02], v=[-1.0, 1.0]),
        patch(type="sphere", radius=0.01, u=[-1.0, 1.0], v=[-1.0, 1.0]),
    ]
)


@settings(max_examples=300)
@given(
    SHAPES,
    PADS,
    st.lists(st.floats(-4, 4), min_size=6, max_size=6),
    st.lists(st.floats(-0.2, 0.2), min_size=3, max_size=3),
)
def test_whatever_is_claimed_has_a_finite_footprint_with_the_point(shape: Any, pad: Any, pose: Any, at: Any) -> None:
    body, point = placed(shape, position=[0.05 * c for c in pose[:3]], rpy=pose[3:]), np.array(at)
    normal = -body.inward(point)
    if not np.isfinite(normal).all():
        return
    found = body.footprint(contact_face(pad, point), point, normal)
    assert np.isfinite(found).all()
    np.testing.assert_allclose((found - point) @ normal, 0.0, atol=1e-12)
    # In its plane the point is in the hull of the footprint: no direction separates it.
    for direction in np.random.default_rng(0).normal(size=(20, 3)):
        assert ((found - point) @ direction).max() >= -2e-7


def test_large_footprints_are_thinned() -> None:
    circle = np.array([[math.cos(a), math.sin(a), 0.0] for a in np.arange(100) * 2 * math.pi / 100])
    few = thinned(circle, 8)
    assert len(few) == 8
    assert area(few) > 0.89 * area(circle)
    assert thinned(few, 8) is few
    # Nearly all corners of this one are on two short arcs.
    pad = on_the_pad(CAN | {"radius": 0.0205}, (0.0, 0.0, 0.05), (0, 0, 0))
    assert len(pad) > 100
    assert area(thinned(pad, 7)) > 0.9 * area(pad)


# ---- how deep in a region


@settings(max_examples=150, deadline=None)
@given(REGIONS, st.integers(0, 2**32 - 1))
def test_least_depth_of_a_triangle(region: dict[str, Any], seed: int) -> None:
    read, rng = READ.validate_python(region), np.random.default_rng(seed)
    corners = rng.uniform(-0.05, 0.05, (3, 3))
    shares = np.array([(i, j, 30 - i - j) for i in range(31) for j in range(31 - i)]) / 30
    sampled = depths(read, shares @ corners).min()
    spacing = max(float(np.linalg.norm(corners[i] - corners[i - 1])) for i in range(3)) / 30
    assert sampled - 3.5 * spacing - RESOLUTION <= least_depth(read, corners) <= sampled + 1e-12


@settings(max_examples=150, deadline=None)
@given(REGIONS, st.integers(0, 2**32 - 1))
def test_least_depth_is_that_of_the_least_deep_point(region: dict[str, Any], seed: int) -> None:
    """Never more than at any of many points, and no less than their spacing explains."""
    read, rng = READ.validate_python(region), np.random.default_rng(seed)
    corners = rng.uniform(-0.05, 0.05, (2, 3))
    found = least_depth(read, corners)
    shares = np.linspace(0.0, 1.0, 1001)[:, None]
    sampled = depths(read, corners[0] + shares * (corners[1] - corners[0])).min()
    spacing = float(np.linalg.norm(corners[1] - corners[0])) / 1000
    assert sampled - 3.5 * spacing - RESOLUTION <= found <= sampled + 1e-12


@pytest.mark.parametrize(
    ("region", "expected"),
    [
        ({"type": "band", "z": [-1.0, 0.03]}, 0.01),  # at a corner
        ({"type": "outside", "part": {"type": "ball", "center": [0.0, 0.0, 0.03], "radius": 0.01}}, 0.02 - 0.01 + 0.01),
        ({"type": "outside", "part": {"type": "ball", "center": [0.0, 0.0, 0.01], "radius": 0.002}}, -0.002),
        ({"type": "outside", "part": {"type": "band", "z": [0.0, 0.01]}}, -0.005),  # all along a line in the middle
        (
            {"type": "any_of", "parts": [{"type": "band", "z": [-1.0, 0.0]}, {"type": "band", "z": [0.004, 1.0]}]},
            -0.002,
        ),
    ],
)
def test_least_depth_of_an_area(region: Any, expected: float) -> None:
    """A rectangle 0.04 x 0.04 in the plane x = 0, z from -0.02 to 0.02; the least depth lies inside of it."""
    corners = np.array([[0.0, y, z] for y, z in ((-0.02, -0.02), (0.02, -0.02), (0.02, 0.02), (-0.02, 0.02))])
    if expected == pytest.approx(0.02):
        expected = 0.0  # the ball ends where the rectangle does
    found = least_depth(READ.validate_python(region), corners)
    assert expected - 1e-5 <= found <= expected + 1e-12


def test_a_sector_is_left_in_the_middle_of_a_face() -> None:
    """The corners of a face are outside of a narrow forbidden sector, the middle is not."""
    face = np.array([[0.05, y, z] for y, z in ((-0.02, -0.1), (0.02, -0.1), (0.02, 0.1), (-0.02, 0.1))])
    narrow = READ.validate_python({"type": "outside", "part": {"type": "sector", "middle": 0.0, "half_width": 0.1}})
    assert depths(narrow, face).min() > 0.01
    assert -0.1 * 0.05 - 1e-5 <= least_depth(narrow, face) <= -0.1 * 0.05 + 1e-6


# ---- rims and edges


@pytest.mark.parametrize(
    ("pad", "point", "expected"),
    [
        (PLANE, (0.015, 0.002, 0.0), 0.005),
        (PLANE, (0.0, -0.012, 0.0), -0.002),
        (patch(type="line", u=[-0.01, 0.02]), (0.018, 0.0, 0.0), 0.002),
        (patch(type="line", u=[-0.01, 0.02], width=0.006), (0.012, 0.0, 0.0), 0.003),
        (
            patch(type="cylinder", radius=0.01, u=[-0.02, 0.02], v=[-1, 1]),
            (0.0, 0.01 * math.sin(0.8), 0.01 * math.cos(0.8)),
            0.002,
        ),
        (patch(type="cylinder", radius=0.01, u=[-0.02, 0.02], v=[-math.pi, math.pi]), (0.01, 0.0, -0.01), 0.01),
        (
            patch(type="sphere", radius=0.02, u=[-1, 1], v=[-0.5, 0.5]),
            (0.02 * math.sin(0.9), 0.0, 0.02 * math.cos(0.9)),
            0.002,
        ),
        (
            patch(type="sphere", radius=0.02, u=[-1, 1], v=[-0.5, 0.5]),
            (0.0, 0.02 * math.sin(0.4), 0.02 * math.cos(0.4)),
            0.002,
        ),
    ],
)
def test_rims(pad: Any, point: Any, expected: float) -> None:
    assert rim_distance(pad, np.array(point, dtype=float)) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("shape", "point", "expected"),
    [
        (CAN, (0.04, 0.0, 0.045), 0.005),
        (CAN, (0.0, 0.03, -0.05), 0.01),
        (BOX, (0.05, 0.09, 0.0), 0.01),
        (BOX, (0.02, 0.0, -0.15), 0.03),
        ({"type": "sphere", "radius": 0.03}, (0.0, 0.0, 0.03), math.inf),
    ],
)
def test_edges(shape: Any, point: Any, expected: float) -> None:
    assert placed(shape).edge(np.array(point)) == pytest.approx(expected)


@settings(max_examples=100)
@given(SHAPES, st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda v: np.linalg.norm(v) > 0.1))
def test_faces_lie_on_the_surface_in_its_tangent_plane(shape: Any, direction: Any) -> None:
    """From the point of the surface below a random one: every corner is on the surface, and none above the plane."""
    body = placed(shape, position=[0.1, 0.2, 0.3], rpy=[0.1, 0.2, 0.3])
    outside = body.center + 0.3 * np.array(direction) / np.linalg.norm(direction)
    point = outside + 0.0 * body.inward(outside)
    for _ in range(50):  # along the normal of the nearest face, until it is on the surface
        point = point + body.distance(point) * body.inward(point)
    inward = body.inward(point)
    R = body.to_object(np.eye(3) + body.center)
    face = body._geometry.face(body.to_object(point)) @ R.T + body.center
    for corner in face:
        assert abs(body.distance(corner)) < 1e-9
        assert abs((corner - face[0]) @ inward) < 1e-9
