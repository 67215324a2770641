"""Compounds: geometry of all parts, twice; pads that keep out of the parts beside; files, pictures, the hold test."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import coal
import numpy as np
import pytest
from conftest import Array, differences

import pinograsp
from pinograsp import Box, Capsule, Compound, Cone, Cylinder, InputError, Object, Part, Pose, Sphere
from pinograsp.collision.pairs import PAD_CLEARANCE, PAD_MARGIN
from pinograsp.collision.solids import distance_request, scene_body
from pinograsp.descriptions import Scene, schema
from pinograsp.descriptions.bodies import Body
from pinograsp.geometry.contact_faces import Flat, Ruling, Spot, edge_distance
from pinograsp.geometry.filled import center_of_mass, filled
from pinograsp.geometry.shapes import surface_of
from pinograsp.hold.objects import object_body
from pinograsp.kinematics.robot import Robot
from pinograsp.problem.constraints.clearance import Clearance
from pinograsp.problem.constraints.pad_clearance import PadClearance, pad_clearance
from pinograsp.problem.state import State
from pinograsp.problem.task_model import TaskModel
from pinograsp.verification.shapes import PlacedShape, geometry_of
from pinograsp.visualization.surfaces import surface_mesh

UP = np.array([0.0, 0.0, 1.0])
LID = Pose(position=(0.0, 0.0, 0.054))
CAN = Compound(
    parts=(
        Part(shape=Cylinder(radius=0.033, height=0.1)),
        Part(shape=Cylinder(radius=0.035, height=0.008), pose=LID),
        Part(shape=Box(size=(0.03, 0.01, 0.01)), pose=Pose(position=(0.045, 0.0, 0.025))),
        Part(shape=Box(size=(0.03, 0.01, 0.01)), pose=Pose(position=(0.045, 0.0, -0.025))),
        Part(shape=Capsule(radius=0.006, length=0.06), pose=Pose(position=(0.06, 0.0, 0.0))),
    )
)
"""A can with a lid that stands out and a handle."""
DUMB_BELL = Compound(
    parts=(
        Part(shape=Capsule(radius=0.014, length=0.12)),
        Part(shape=Sphere(radius=0.03), pose=Pose(position=(0.0, 0.0, 0.06))),
        Part(shape=Sphere(radius=0.03), pose=Pose(position=(0.0, 0.0, -0.06))),
    )
)
FUNNEL = Compound(
    parts=(
        Part(shape=Cone(bottom_radius=0.02, top_radius=0.04, height=0.06), pose=Pose(rpy=(0.2, -0.1, 0.4))),
        Part(shape=Box(size=(0.05, 0.05, 0.03)), pose=Pose(position=(0.02, 0.01, 0.03), rpy=(0.5, 0.3, 0.0))),
    )
)
"""Lines up its side end at the turned box where they meet it, which depends on the point."""
every = pytest.mark.parametrize("shape", [CAN, DUMB_BELL, FUNNEL], ids=["can", "dumb-bell", "funnel"])


def points_around(shape: Compound, count: int = 300) -> Array:
    radius = surface_of(shape).radius
    return np.random.default_rng(0).uniform(-1.2 * radius, 1.2 * radius, size=(count, 3))


def part_distances(shape: Compound, points: Array) -> Array:
    """Return the distances to each part by itself, shape (parts, n)."""
    found = []
    for part in shape.parts:
        T = part.pose.matrix
        found.append(surface_of(part.shape).signed_distance((points - T[:3, 3]) @ T[:3, :3])[0])
    return np.array(found)


# ---- geometry


@every
def test_the_distance_is_that_of_the_nearest_part(shape: Compound) -> None:
    points, surface = points_around(shape), surface_of(shape)
    apart = part_distances(shape, points)
    distances, _, _ = surface.signed_distance(points)
    np.testing.assert_allclose(distances, apart.min(axis=0), atol=1e-15)
    assert (surface.nearest_part(points) == apart.argmin(axis=0)).all()
    assert len(set(surface.nearest_part(points).tolist())) >= 2


@every
def test_gradient_and_hessian_are_those_of_the_distance(shape: Compound) -> None:
    surface, step = surface_of(shape), 1e-6
    points = points_around(shape)
    distances, gradients, hessians = surface.signed_distance(points)
    moved = [[surface.signed_distance(points + sign * step * axis) for sign in (1.0, -1.0)] for axis in np.eye(3)]
    slopes = np.stack([(up[0] - down[0]) / (2 * step) for up, down in moved], axis=1)
    bends = np.stack([(up[1] - down[1]) / (2 * step) for up, down in moved], axis=2)
    smooth = (distances > 0.0) & (np.abs(bends).max(axis=(1, 2)) < 1e3)
    assert smooth.sum() > 200
    np.testing.assert_allclose(gradients[smooth], slopes[smooth], atol=1e-6)
    np.testing.assert_allclose(hessians[smooth], bends[smooth], atol=1e-2)


@every
def test_solids_are_the_parts_where_they_are(shape: Compound) -> None:
    body, points = scene_body("obstacle", "it", Body(shape=shape)), points_around(shape, 60)
    distances, request = surface_of(shape).signed_distance(points)[0], distance_request()
    assert [solid.part for solid in body.solids] == list(range(len(shape.parts)))
    probe = coal.Sphere(1e-3)
    probe.computeLocalAABB()
    for point, distance in zip(points[distances > 0.005], distances[distances > 0.005], strict=True):
        at = coal.Transform3s(np.eye(3), point)
        apart = [
            coal.distance(
                solid.shape,
                coal.Transform3s(solid.placement[:3, :3], solid.placement[:3, 3]),
                probe,
                at,
                request,
                coal.DistanceResult(),
            )
            for solid in body.solids
        ]
        assert min(apart) + 1e-3 == pytest.approx(distance, abs=1e-5)


@every
def test_extent_radius_and_width(shape: Compound) -> None:
    surface = surface_of(shape)
    corners = surface.tessellation().vertices
    directions = np.random.default_rng(0).normal(size=(50, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    extents = np.array([surface.extent(direction) for direction in directions])
    highest = (corners @ directions.T).max(axis=0)
    assert (extents >= highest - 1e-12).all()
    assert (extents - highest).max() < 5e-4  # the triangles' corners are on the surface
    assert np.linalg.norm(corners, axis=1).max() <= surface.radius
    assert surface_of(CAN).least_width == pytest.approx(0.008)  # the lid


def test_triangles_inside_another_part_are_left_out() -> None:
    surface = surface_of(CAN)
    tessellation = surface.tessellation()
    middles = surface.signed_distance(tessellation.corners.mean(axis=1))[0]
    assert middles.min() > -0.006  # of the handle's arms, what is in the can ends there
    parts = sum(len(surface_of(part.shape).tessellation().triangles) for part in CAN.parts)
    assert len(tessellation.triangles) < parts
    mesh = surface_mesh(surface, tessellation)
    assert len(mesh.faces) == len(tessellation.triangles)


def test_a_line_up_the_side_ends_where_the_lid_begins() -> None:
    face = surface_of(CAN).contact_face(np.array([0.0, 0.033, 0.01]))
    assert isinstance(face, Ruling)
    assert (face.low, face.high) == pytest.approx((-0.06, 0.04), abs=2e-7)
    distance, slope = edge_distance(face, np.array([0.0, 0.033, 0.01]))
    assert distance == pytest.approx(0.04, abs=2e-7)
    np.testing.assert_allclose(slope, -UP, atol=1e-12)


def test_a_line_up_the_side_ends_at_the_arms_of_the_handle() -> None:
    """Between them at the handle's side, and above the upper one."""
    x, y = 0.033 * math.cos(0.1), 0.033 * math.sin(0.1)
    between, above = (surface_of(CAN).contact_face(np.array([x, y, z])) for z in (0.0, 0.045))
    assert isinstance(between, Ruling)
    assert isinstance(above, Ruling)
    assert (between.low, between.high) == pytest.approx((-0.02, 0.02), abs=2e-7)
    assert (above.low, above.high) == pytest.approx((-0.015, 0.005), abs=2e-7)


def test_a_point_under_another_part_is_beyond_the_edge() -> None:
    """In the handle's upper arm, from z = 20 to 30 mm, 2 mm below its upper side."""
    face = surface_of(CAN).contact_face(np.array([0.032, 0.0, 0.028]))
    assert isinstance(face, Flat | Ruling)
    if isinstance(face, Ruling):
        assert edge_distance(face, np.array([0.032, 0.0, 0.028]))[0] == pytest.approx(-0.002, abs=2e-7)


def test_flat_faces_stay_whole_and_spots_are_spots() -> None:
    lid = surface_of(CAN).contact_face(np.array([0.0, 0.01, 0.058]))
    assert isinstance(lid, Flat)
    np.testing.assert_allclose(lid.normal, UP, atol=1e-12)
    assert isinstance(surface_of(DUMB_BELL).contact_face(np.array([0.03, 0.0, 0.06])), Spot)


def test_parts_that_are_flush_do_not_cut_each_other() -> None:
    two = Compound(
        parts=(Part(shape=Cylinder(radius=0.03, height=0.1)), Part(shape=Cylinder(radius=0.03, height=0.05)))
    )
    face = surface_of(two).contact_face(np.array([0.03, 0.0, 0.0]))
    assert isinstance(face, Ruling)
    assert (face.low, face.high) == pytest.approx((-0.05, 0.05))


@every
def test_distances_from_ends_of_lines_have_the_slope_that_they_say(shape: Compound) -> None:
    surface, rng = surface_of(shape), np.random.default_rng(1)
    cut = 0
    for point in points_around(shape, 200):
        distances, normals, _ = surface.signed_distance(point[None])
        at = point - (distances[0] - rng.uniform(0.0, 1e-3)) * normals[0]
        face = surface.contact_face(at)
        around = [surface.contact_face(at + sign * 1e-6 * axis) for sign in (1.0, -1.0) for axis in np.eye(3)]
        if not isinstance(face, Ruling) or all(slope is None for slope in face.slopes):
            continue
        if len({surface.nearest_part((at + d)[None])[0] for d in 1e-6 * np.vstack([np.eye(3), -np.eye(3)])}) > 1:
            continue
        nearest = {min((0, 1), key=lambda i, f=f: f.ends[i][0]) for f in (face, *around) if isinstance(f, Ruling)}
        value, slope = edge_distance(face, at)
        if len(nearest) > 1 or abs(value) > 0.1 or np.abs(slope).max() > 30.0:
            continue

        def distance(p: Array) -> float:
            return edge_distance(surface.contact_face(p), p)[0]

        expected = differences(distance, at, 1e-7)
        if np.abs(expected - differences(distance, at, 2e-7)).max() > 1e-4:
            continue  # a corner of the other part
        np.testing.assert_allclose(slope, expected, atol=1e-4 * (1.0 + np.abs(expected).max()))
        cut += 1
    assert cut > (0 if shape is DUMB_BELL else 10)


# ---- the verification's geometry


@every
def test_the_verification_sees_the_same_compound(shape: Compound) -> None:
    surface = surface_of(shape)
    placed = PlacedShape("it", Body(shape=shape))
    points = points_around(shape)
    distances, _, _ = surface.signed_distance(points)
    np.testing.assert_allclose([placed.distance(point) for point in points], distances, atol=1e-12)
    farthest = np.linalg.norm(surface.tessellation().vertices, axis=1).max()
    assert farthest <= placed.radius_about(placed.center) <= surface.radius + 1e-12
    assert placed.radius_about(np.array([0.1, 0.0, 0.0])) >= distances_from(surface.tessellation().vertices)
    assert len(placed.parts) == len(shape.parts)


def distances_from(vertices: Array) -> float:
    return float(np.linalg.norm(vertices - [0.1, 0.0, 0.0], axis=1).max())


@every
def test_both_see_the_same_faces_and_edges(shape: Compound) -> None:
    surface, pose = surface_of(shape), Pose(position=(0.3, -0.2, 0.1), rpy=(0.4, 0.2, -1.0))
    T, placed = pose.matrix, PlacedShape("it", Body(shape=shape, pose=pose))
    lines = 0
    for point in points_around(shape, 200):
        distances, normals, _ = surface.signed_distance(point[None])
        at = point - distances[0] * normals[0]
        if surface.signed_distance(at[None])[0][0] < -1e-9:
            continue  # it began inside where parts overlap
        world = T[:3, :3] @ at + T[:3, 3]
        face, seen = surface.contact_face(at), geometry_of(shape).face(at)
        if abs(edge_distance(face, at)[0]) < 1e-6:
            continue  # on an edge, of which both faces are as near
        assert placed.edge(world) == pytest.approx(edge_distance(face, at)[0], abs=2e-6, rel=1e-6)
        if isinstance(face, Ruling):
            ends = [at + t * face.direction for t in (face.low, face.high)]
            np.testing.assert_allclose(np.sort(seen, axis=0), np.sort(ends, axis=0), atol=2e-6)
            lines += 1
    assert lines > (0 if shape is DUMB_BELL else 20)


# ---- a compound as an object


def scene_with(glovebox: Scene, shape: Compound, contacts: tuple[tuple[float, float, float], ...], yaw: float) -> Scene:
    thing = Object(shape=shape, pose=Pose(position=(0.80, 0.02, -0.12), rpy=(0.0, 0.0, yaw)))
    return glovebox.with_object("sphere", thing).with_task("sphere", desired_contacts=contacts)


AT_THE_HANDLE = ((0.0, 0.033, 0.0), (0.0, -0.033, 0.0))


@pytest.fixture(scope="module")
def held(gen3: Robot, glovebox: Scene) -> pinograsp.Result:
    return pinograsp.plan(gen3, scene_with(glovebox, CAN, AT_THE_HANDLE, 0.5), "sphere", starts=4, workers=1)


def test_a_can_with_a_handle_is_grasped(held: pinograsp.Result) -> None:
    assert (held.verified, held.refuted) == (4, 0)


def test_pads_are_kept_off_the_parts_beside(gen3: Robot, glovebox: Scene) -> None:
    """The rows: each pad's link against each part; what the pad touches does not count, and no other pair changes."""
    model = TaskModel(gen3, scene_with(glovebox, CAN, AT_THE_HANDLE, 0.5), "sphere")
    pairs = [pair for pair in model.collisions.pairs if pair.kind == PAD_CLEARANCE]
    tips = {pad.link for pad in gen3.description.pads}
    assert {(pair.link, pair.part) for pair in pairs} == set(itertools.product(tips, range(5)))
    assert {pair.margin for pair in pairs} == {PAD_MARGIN}
    assert model.collisions.pairs[-len(pairs) :] == tuple(pairs)
    constraint = pad_clearance(model)
    assert isinstance(constraint, PadClearance)
    assert len(constraint.rows) == 10
    assert not tips & set(Clearance(model).links) - {p.link for p in model.collisions.pairs if p.kind != PAD_CLEARANCE}
    plain = TaskModel(gen3, glovebox, "sphere")
    assert pad_clearance(plain) is None


def test_the_pad_clearance_is_the_least_distance_to_parts_not_touched(
    gen3: Robot, glovebox: Scene, held: pinograsp.Result
) -> None:
    model = TaskModel(gen3, scene_with(glovebox, CAN, AT_THE_HANDLE, 0.5), "sphere")
    constraint = pad_clearance(model)
    assert constraint is not None
    best = held.best
    assert best is not None
    x = np.concatenate([best.q_arm, best.synergy, best.contact_parameters])
    data = model.robot.model.createData()
    at = State(model, data, x, (0, 1))
    assert at.touched_parts == (0, 0)
    inside = dict(zip(constraint.rows, constraint.inside(at).values, strict=True))
    assert min(inside.values()) >= -1e-7
    [to_can] = {round(inside[row], 9) for row in constraint.rows if row.endswith("part 1")}
    assert to_can == pytest.approx(round(max(inside.values()), 9))  # touched: it does not count

    # With the hand 20 mm lower along the can, or turned about it, pads come to the other parts.
    def value(y: Array) -> Array:
        return constraint.inside(State(model, data, y, (0, 1))).values

    rng = np.random.default_rng(0)
    near = 0
    for _ in range(40):
        y = x.copy()
        y[: model.robot.arm_size] += rng.uniform(-0.06, 0.06, model.robot.arm_size)
        state = State(model, data, y, (0, 1))
        found = constraint.inside(state)
        numeric = np.array([(value(y + 1e-6 * e) - value(y - 1e-6 * e)) / 2e-6 for e in np.eye(len(y))]).T
        if np.abs(numeric - found.jacobian).max() > 1e-3:  # two pieces at one distance, or another part is touched
            continue
        near += int(found.values.min() < 0.01)
    assert near >= 5


def test_a_pad_in_a_handle_is_refuted(gen3: Robot, glovebox: Scene, held: pinograsp.Result) -> None:
    """A can with one more knob, right where a pad is in the grasp of the can without."""
    best = held.best
    assert best is not None
    contact, T = best.contacts[0], held.setup.scene.objects["sphere"].pose.matrix
    pad = contact.T_world_pad
    local = (pad[:3, 3] + 0.004 * pad[:3, 2] - T[:3, 3]) @ T[:3, :3]
    beside = local + 0.9 * ((contact.point - pad[:3, 3]) @ T[:3, :3])
    knob = Part(shape=Sphere(radius=0.006), pose=Pose(position=tuple(beside.tolist())))
    with_knob = Compound(parts=(*CAN.parts, knob))
    scene = scene_with(glovebox, with_knob, AT_THE_HANDLE, 0.5)
    certificate = pinograsp.verification.check.Verifier(gen3, scene, "sphere").check(best.claim)
    assert not certificate["pad clearance"].holds
    assert best.certificate["pad clearance"].holds


@pytest.mark.parametrize("yaw", [1.3, 1.8])
def test_pads_stay_off_a_handle_in_their_way(gen3: Robot, glovebox: Scene, yaw: float) -> None:
    """Contacts are wanted 15 degrees beside the handle's arms: pads would be in them."""
    x, y = 0.033 * math.cos(0.25), 0.033 * math.sin(0.25)
    scene = scene_with(glovebox, CAN, ((x, y, 0.02), (-x, -y, 0.02)), yaw)
    result = pinograsp.plan(gen3, scene, "sphere", starts=6, workers=1)
    assert result.refuted == 0
    assert result.verified >= 3
    for grasp in result.grasps:
        assert grasp.certificate["pad clearance"].value >= -2e-5


# ---- files


def test_a_compound_is_read_and_written(tmp_path: Path, glovebox: Scene) -> None:
    scene = scene_with(glovebox, CAN, AT_THE_HANDLE, 0.0).with_obstacle(
        "rack", Body(shape=DUMB_BELL, pose=Pose(position=(0.5, 0.3, 0.0)))
    )
    assert Scene.from_dict(scene.to_dict()) == scene
    parts = scene.to_dict()["obstacles"]["rack"]["shape"]["parts"]
    assert parts[1]["shape"] == {"type": "sphere", "radius": 0.03}
    assert parts[1]["pose"]["position"] == [0.0, 0.0, 0.06]
    assert "compound of capsule, sphere, sphere" in scene._repr_html_()
    block = schema("scene")["$defs"]["Part"]["properties"]["shape"]
    assert "compound" not in block["discriminator"]["mapping"]
    assert "capsule" in block["discriminator"]["mapping"]


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ([], "at least 1"),
        ([{"shape": {"type": "compound", "parts": [{"shape": {"type": "sphere", "radius": 1.0}}]}}], "another one"),
        ([{"shape": {"type": "spere", "radius": 1.0}}], "mean sphere"),
        ([{"shape": {"type": "sphere", "radus": 1.0}}], "mean radius"),
        ([{"shape": {"type": "sphere", "radius": 1.0}, "position": [0, 0, 0]}], "unknown key"),
    ],
)
def test_wrong_parts_are_refused(parts: list[object], words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        Compound(parts=parts)
    assert str(caught.value).startswith("parts")


def test_the_centre_of_mass_is_that_of_the_parts() -> None:
    """A hammer: a head of twice the handle's volume, its centre 30 mm above the handle's."""
    handle = Part(shape=Box(size=(0.02, 0.02, 0.05)), pose=Pose(position=(0.01, 0.0, 0.0)))
    head = Part(shape=Cylinder(radius=math.sqrt(4e-3 / math.pi), height=0.01), pose=Pose(position=(0.01, 0.0, 0.03)))
    hammer = Compound(parts=(handle, head))
    assert filled(hammer).volume == pytest.approx(6e-5)
    assert filled(hammer).centroid.tolist() == pytest.approx([0.01, 0.0, 0.02], abs=1e-5)
    assert center_of_mass(Object(shape=hammer)).tolist() == pytest.approx([0.01, 0.0, 0.02], abs=1e-5)
    cone = Part(shape=Cone(bottom_radius=0.02, top_radius=0.0, height=0.04), pose=Pose(rpy=(math.pi / 2, 0.0, 0.0)))
    assert filled(Compound(parts=(cone,))).centroid.tolist() == pytest.approx([0.0, 0.01, 0.0])
    for shape in (Capsule(radius=0.02, length=0.05), Cone(bottom_radius=0.03, top_radius=0.01, height=0.05)):
        grid = np.array(list(itertools.product(np.linspace(-0.05, 0.05, 80), repeat=3)))
        share = (surface_of(shape).signed_distance(grid)[0] < 0.0).mean()
        assert shape.volume == pytest.approx(share * (0.1 * 80 / 79) ** 3, rel=0.02)


# ---- the hold test


def test_the_inertia_of_a_compound_is_that_of_what_it_is_made_of() -> None:
    """A box in two halves, one of them turned, is the box; a capsule is what it is by integration."""
    half = Part(shape=Box(size=(0.02, 0.03, 0.05)), pose=Pose(position=(-0.01, 0.0, 0.0)))
    other = Part(shape=Box(size=(0.03, 0.02, 0.05)), pose=Pose(position=(0.01, 0.0, 0.0), rpy=(0.0, 0.0, math.pi / 2)))
    whole, halves = (
        object_body("it", shape) for shape in (Box(size=(0.04, 0.03, 0.05)), Compound(parts=(half, other)))
    )
    np.testing.assert_allclose(halves.inertia, whole.inertia, atol=1e-15)
    assert [geom["type"] for geom in halves.geoms] == ["box", "box"]
    for shape in (Capsule(radius=0.02, length=0.05), pinograsp.Ellipsoid(semi_axes=(0.02, 0.03, 0.05))):
        surface = surface_of(shape)
        grid = np.array(list(itertools.product(np.linspace(-0.05, 0.05, 80), repeat=3)))
        inside = grid[surface.signed_distance(grid)[0] < 0.0]
        expected = (inside**2).mean(axis=0).sum() - (inside**2).mean(axis=0)
        np.testing.assert_allclose(object_body("it", shape).inertia, np.diag(expected), rtol=0.02, atol=1e-12)


def test_a_compound_is_held(held: pinograsp.Result) -> None:
    pytest.importorskip("mujoco")
    best = held.best
    assert best is not None
    (outcome,) = pinograsp.hold_test(best, workers=1)
    assert outcome.held
