"""Contacts that are proposed where a task desires none."""

from __future__ import annotations

import json
import math
import pickle
import re
from pathlib import Path
from typing import Any

import meshes
import numpy as np
import pytest
import yaml
from conftest import Run

import pinograsp
from pinograsp import (
    Ball,
    Band,
    Body,
    Box,
    Capsule,
    Cone,
    ContactPair,
    ContactPairs,
    Cuboid,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    InputError,
    Object,
    Planner,
    Pose,
    Robot,
    Scene,
    Sphere,
    TaskError,
    UnknownNameError,
)
from pinograsp.descriptions.shapes import Mesh
from pinograsp.descriptions.task import Margins
from pinograsp.geometry.antipodal import Pairs, drawn, opposite_points
from pinograsp.geometry.shapes import surface_of
from pinograsp.kinematics.grips import grips
from pinograsp.problem.lone_faces import LoneFaces

ABOVE = (0.80, 0.02, -0.12)
"""A place in the glovebox with nothing near it, m, world."""


def holding(glovebox: Scene, shape: Any, position: tuple[float, float, float] = ABOVE, **keys: Any) -> Scene:
    """Return the glovebox with another object in place of the sphere, and a task that desires no contacts."""
    thing = Object(shape=shape, pose=Pose(position=position))
    return glovebox.with_object("sphere", thing).with_task("sphere", desired_contacts=None, **keys)


def proposed(robot: Robot, scene: Scene, **options: Any) -> ContactPairs:
    return pinograsp.contacts(robot, scene, task="sphere", **options)


def refusal(robot: Robot, scene: Scene) -> TaskError:
    with pytest.raises(TaskError) as refused:
        proposed(robot, scene)
    return refused.value


@pytest.fixture(scope="module")
def box_pairs(gen3: Robot, glovebox: Scene) -> ContactPairs:
    """Pairs of a box of 50 mm x 60 mm x 80 mm with nothing near it."""
    return proposed(gen3, holding(glovebox, Box(size=(0.05, 0.06, 0.08))))


def axes(pairs: tuple[ContactPair, ...]) -> set[str]:
    """Return the axes that the normals of pairs are along; both are along one."""
    found = set()
    for pair in pairs:
        np.testing.assert_allclose(pair.normals[0], -pair.normals[1], atol=1e-6)
        assert np.abs(pair.normals[0]).max() == pytest.approx(1.0)
        found.add("xyz"[int(np.abs(pair.normals[0]).argmax())])
    return found


# ---- opposite points


@pytest.mark.parametrize(
    ("shape", "width"),
    [
        (Sphere(radius=0.03), (0.06, 0.06)),
        (Box(size=(0.02, 0.03, 0.05)), (0.02, 0.05)),
        (Cylinder(radius=0.02, height=0.05), (0.04, 0.05)),
        (Ellipsoid(semi_axes=(0.03, 0.035, 0.05)), (0.06, 0.1)),
    ],
)
def test_opposite_points_are_on_the_surface_with_opposite_normals(shape: Any, width: tuple[float, float]) -> None:
    surface = surface_of(shape)
    pairs = opposite_points(surface, 200, np.random.default_rng(0))
    assert len(pairs.points) == 200
    distances, normals, _ = surface.signed_distance(pairs.points.reshape(-1, 3))
    np.testing.assert_allclose(distances, 0.0, atol=1e-9)
    np.testing.assert_allclose(normals, pairs.normals.reshape(-1, 3), atol=1e-9)
    assert pairs.tilts.max() < math.radians(0.05)
    assert pairs.widths.min() >= width[0] - 1e-6
    assert pairs.widths.max() <= width[1] + 1e-6
    assert np.ptp(pairs.widths) > 0.3 * (width[1] - width[0])


def test_ends_of_a_capsule_have_no_opposite_points_but_on_the_axis() -> None:
    """From an end a ray along the normal leaves by the side, whose normal is another one."""
    pairs = opposite_points(surface_of(Capsule(radius=0.02, length=0.06)), 300, np.random.default_rng(0))
    on_side = (np.abs(pairs.points[:, 0, 2]) < 0.0299) & (np.abs(pairs.points[:, 1, 2]) < 0.0299)
    np.testing.assert_allclose(pairs.tilts[on_side], 0.0, atol=1e-6)
    np.testing.assert_allclose(pairs.widths[on_side], 0.04, atol=1e-6)
    assert on_side.sum() > 100


def test_points_are_drawn_by_area() -> None:
    tessellation = surface_of(Box(size=(0.1, 0.1, 0.01))).tessellation()
    points = drawn(tessellation, 4000, np.random.default_rng(1))
    large = np.isclose(np.abs(points[:, 2]), 0.005).mean()
    assert large == pytest.approx(0.02 / 0.024, abs=0.03)


def test_grips_are_those_of_the_jaw(gen3: Robot) -> None:
    found = grips(gen3, gen3.lower[7:], gen3.upper[7:])
    assert found.widths.max() == pytest.approx(0.085, abs=1e-4)
    assert found.widths.min() == pytest.approx(0.0, abs=1e-3)
    nearest = found.nearest(0.05)[0]
    assert abs(found.widths[nearest] - 0.05) == np.abs(found.widths - 0.05).min()
    np.testing.assert_allclose(found.normals.sum(axis=1), 0.0, atol=1e-6)


# ---- faces that nothing is opposite to


def test_the_side_of_a_cone_is_told_to_have_no_pair(gen3: Robot, glovebox: Scene) -> None:
    """Opposite lines of it are turned by twice the half angle, atan(18 / 60), and pads stay parallel."""
    cone = Cone(bottom_radius=0.03, top_radius=0.012, height=0.06)
    pairs = proposed(gen3, holding(glovebox, cone), most=5)
    assert axes(pairs) == {"z"}
    (remark,) = pairs.remarks
    share = int(remark.split(" ")[0])
    flank, bottom, top = math.pi * 0.042 * math.hypot(0.018, 0.06), math.pi * 0.03**2, math.pi * 0.012**2
    assert share == pytest.approx(100.0 * (flank + bottom - top) / (flank + bottom + top), abs=3)
    turned = math.degrees(2.0 * math.atan2(0.018, 0.06))
    assert remark.endswith(
        f" % of the surface has no pair: what is opposite is turned by {turned:.3g} ° or more, "
        "and the pads stay parallel, within 0.5 °"
    )


def test_a_cone_on_the_floor_is_told_why_no_other_pairs_are_there(gen3: Robot, glovebox: Scene) -> None:
    cone = Cone(bottom_radius=0.03, top_radius=0.012, height=0.06)
    floor = glovebox.enclosure.min[2]
    refused = refusal(gen3, holding(glovebox, cone, (0.75, 0.0, floor + 0.0301)))
    assert "the hand gets at none" in refused.problem
    assert "turned by 33.4 ° or more, and the pads stay parallel" in refused.problem
    pointed = refusal(gen3, holding(glovebox, Cone(bottom_radius=0.03, top_radius=0.0, height=0.06)))
    assert "; 100 % of the surface has no pair: what is opposite is turned by 53.1 ° or more" in pointed.problem


def test_shapes_with_opposite_faces_get_no_remark(box_pairs: ContactPairs) -> None:
    assert box_pairs.remarks == ()
    again = pickle.loads(pickle.dumps(ContactPairs(box_pairs, ("some",))))
    assert (again.remarks, len(again), type(again)) == (("some",), len(box_pairs), ContactPairs)


def pair_at(angle: float, height: float) -> tuple[list[list[float]], list[list[float]]]:
    """Return opposite points of a cone about z of a half angle, rad, at a height."""
    across, up = math.cos(angle), math.sin(angle)
    return [[1.0, 0.0, height], [-1.0, 0.0, height]], [[across, 0.0, up], [-across, 0.0, up]]


def test_friction_is_named_where_pads_may_turn() -> None:
    angles = [0.1, 0.4, 0.6, 0.7]
    points, normals = zip(*(pair_at(angle, height) for height, angle in enumerate(angles)), strict=True)
    pairs = Pairs(np.array(points), np.array(normals))
    lone = LoneFaces(math.atan(0.5), None)
    lone.see(pairs)
    assert lone.remarks(0.5) == (
        "50 % of the surface has no pair: the line to what is opposite leans by up to "
        f"{math.degrees(0.7):.3g} °, and friction 0.5 holds 26.6 °",
    )
    parallel = LoneFaces(math.atan(0.5), 0.3)
    parallel.see(pairs)
    assert parallel.remarks(0.5) == (
        f"75 % of the surface has no pair: what is opposite is turned by {math.degrees(0.8):.3g} ° or more, "
        "and the pads stay parallel, within 17.2 °",
    )


def test_a_point_with_one_pair_that_fits_is_none_without() -> None:
    """Rays leave a body first, and last."""
    points, normals = pair_at(0.0, 0.0)
    others, turned = pair_at(0.5, 0.0)
    lone = LoneFaces(math.atan(0.5), 0.01)
    lone.see(Pairs(np.array([points, others]), np.array([normals, turned])))
    assert lone.remarks(0.5) == ()


def test_the_command_tells_it(glovebox: Scene, run: Run, tmp_path: Path) -> None:
    scene = holding(glovebox, Cone(bottom_radius=0.03, top_radius=0.012, height=0.06))
    file = tmp_path / "cone.yaml"
    file.write_text(yaml.safe_dump(scene.to_dict()))
    code, out, _ = run("contacts", file, "--task", "sphere", "--most", 2)
    assert code == 0
    assert "of the surface has no pair: what is opposite is turned by 33.4 ° or more" in " ".join(out.split())
    code, out, _ = run("contacts", file, "--task", "sphere", "--most", 2, "--json")
    assert [remark.split(":")[0][-8:] for remark in json.loads(out)["remarks"]] == [" no pair"]


# ---- pairs of objects


def test_a_box_has_its_three_pairs_of_faces(box_pairs: tuple[ContactPair, ...]) -> None:
    assert len(box_pairs) == 24
    assert axes(box_pairs) == set("xyz")
    for pair in box_pairs:
        side = "xyz"["xyz".index(axes((pair,)).pop())]
        assert pair.width == pytest.approx({"x": 0.05, "y": 0.06, "z": 0.08}[side])
        assert pair.width == pytest.approx(np.linalg.norm(pair.points[0] - pair.points[1]))


def test_sides_that_are_too_far_apart_are_left_out(gen3: Robot, glovebox: Scene) -> None:
    assert axes(proposed(gen3, holding(glovebox, Box(size=(0.05, 0.06, 0.1))))) == set("xy")


def test_a_cylinder_has_its_sides_and_its_ends(gen3: Robot, glovebox: Scene) -> None:
    pairs = proposed(gen3, holding(glovebox, Cylinder(radius=0.035, height=0.06)))
    ends = [pair for pair in pairs if abs(pair.normals[0, 2]) > 0.9]
    sides = [pair for pair in pairs if abs(pair.normals[0, 2]) < 0.1]
    assert len(ends) + len(sides) == len(pairs)
    assert {round(pair.width, 6) for pair in ends} == {0.06}
    assert {round(pair.width, 6) for pair in sides} == {0.07}


def test_pairs_are_far_from_edges_where_they_can_be(box_pairs: tuple[ContactPair, ...]) -> None:
    half = np.array([0.025, 0.03, 0.04])
    for pair in box_pairs:
        room = np.sort(half - np.abs(pair.points), axis=1)[:, 1]  # the least of all is that of the face itself
        assert room.min() >= 0.006 - 1e-9


def test_faces_with_nothing_but_edges_are_proposed_too(gen3: Robot, glovebox: Scene) -> None:
    pairs = proposed(gen3, holding(glovebox, Box(size=(0.01, 0.01, 0.1))))
    assert axes(pairs) == set("xy")


def test_the_first_pair_is_near_the_centre_of_mass_and_the_others_are_spread(gen3: Robot, glovebox: Scene) -> None:
    pairs = proposed(gen3, holding(glovebox, Cylinder(radius=0.02, height=0.2)))
    middles = np.array([pair.points.mean(axis=0) for pair in pairs])
    assert np.linalg.norm(middles[0]) < 0.01
    assert middles[:, 2].min() < -0.06
    assert middles[:, 2].max() > 0.06


def test_pairs_that_cannot_bear_the_weight_are_not_proposed(gen3: Robot, glovebox: Scene) -> None:
    """Lying, a rod turns in the fingers where it is held far from its middle; standing, it does not."""
    rod, reaches = Cylinder(radius=0.02, height=0.2), []
    for rpy in ((0.0, 0.0, 0.0), (0.0, math.pi / 2, 0.0)):
        thing = Object(shape=rod, pose=Pose(position=ABOVE, rpy=rpy))
        pairs = proposed(gen3, glovebox.with_object("sphere", thing).with_task("sphere", desired_contacts=None))
        reaches.append(max(abs(pair.points[:, 2].mean()) for pair in pairs))
    assert reaches[0] > 0.08
    assert reaches[1] < 0.03


def test_what_stands_on_the_floor_is_not_held_from_below(gen3: Robot, glovebox: Scene) -> None:
    box, floor = Box(size=(0.05, 0.06, 0.08)), glovebox.enclosure.min[2]
    standing = holding(glovebox, box, position=(0.80, 0.02, floor + 0.04))
    assert axes(proposed(gen3, standing)) == set("xy")
    beside = Body(shape=Box(size=(0.1, 0.02, 0.2)), pose=Pose(position=(0.80, 0.062, floor + 0.1)))
    assert axes(proposed(gen3, standing.with_obstacle("shelf", beside))) == set("x")


# ---- nothing to propose


def test_an_object_that_is_too_wide_is_told_by_how_much(gen3: Robot, glovebox: Scene) -> None:
    error = refusal(gen3, holding(glovebox, Box(size=(0.1, 0.11, 0.12))))
    assert error.key == "objects.sphere.shape"
    assert "too wide by 15.0 mm: at least 100.0 mm, and the pads open to 85.0 mm" in error.problem
    with pytest.raises(TaskError, match=r"too wide by 15\.0 mm"):
        pinograsp.plan(gen3, holding(glovebox, Box(size=(0.1, 0.11, 0.12))), "sphere", starts=2, workers=1)


@pytest.mark.parametrize(
    ("shape", "why"),
    [
        (Cone(bottom_radius=0.04, top_radius=0.0, height=0.08), "no two faces are opposite to each other"),
        (Box(size=(0.2, 0.0008, 0.0008)), "all opposite points are at edges"),
        (Box(size=(0.04, 0.04, 1e-5)), "too narrow by 0.2 mm: at most 0.0 mm"),
        (
            Box(size=(0.2, 0.2, 1.5e-4)),
            "too narrow or too wide: 0.1 mm or less, 200.0 mm or more, and the pads",
        ),
        (Sphere(radius=1e-5), "too narrow by 0.1 mm: at most 0.0 mm"),
        (Cylinder(radius=1e-5, height=0.03), "too narrow by 0.1 mm: at most 0.0 mm"),
    ],
)
def test_an_object_without_a_pair_is_told_why(gen3: Robot, glovebox: Scene, shape: Any, why: str) -> None:
    assert why in refusal(gen3, holding(glovebox, shape)).problem


def test_a_spot_smaller_than_the_pads_takes_none(gen3: Robot, glovebox: Scene) -> None:
    box, spots = Box(size=(0.05, 0.06, 0.08)), Cuboid(min=(-0.1, -0.006, -0.006), max=(0.1, 0.006, 0.006))
    scene = holding(glovebox, box, allowed_contacts=spots)
    assert "no face is there that a pad fits on" in refusal(gen3, scene).problem
    pairs = proposed(gen3, holding(glovebox, box, allowed_contacts=spots, contact_regions="point"))
    assert axes(pairs) == {"x"}


def test_a_margin_that_keeps_the_hand_off_every_face_is_named(gen3: Robot, glovebox: Scene) -> None:
    scene = glovebox.with_task("sphere", desired_contacts=None, margin=Margins(object=0.05))
    error = refusal(gen3, scene)
    assert "other links 50 mm off (margin.object)" in error.problem
    assert error.remedy == "Give a smaller margin.object"


def test_a_band_lower_than_the_pads_is_touched_by_their_ends(gen3: Robot, glovebox: Scene) -> None:
    scene = holding(glovebox, Cylinder(radius=0.03, height=0.1), allowed_contacts=Band(z=(-0.008, 0.008)))
    pairs = proposed(gen3, scene)
    assert max(np.abs(pair.points[:, 2]).max() for pair in pairs) <= 0.008


def test_what_nothing_gets_at_is_said(gen3: Robot, glovebox: Scene) -> None:
    scene, floor = holding(glovebox, Box(size=(0.05, 0.06, 0.08))), glovebox.enclosure.min[2]
    scene = scene.with_object_pose("sphere", Pose(position=(0.80, 0.02, floor + 0.04)))
    for number, (x, y) in enumerate(((0.04, 0.0), (-0.04, 0.0), (0.0, 0.045), (0.0, -0.045))):
        size = (0.02, 0.2, 0.2) if y == 0.0 else (0.2, 0.02, 0.2)
        around = Body(shape=Box(size=size), pose=Pose(position=(0.80 + x, 0.02 + y, floor + 0.1)))
        scene = scene.with_obstacle(f"board {number}", around)
    error = refusal(gen3, scene)
    assert error.key == "objects.sphere.pose"
    assert re.search(r"the hand gets at none of \d+ pairs", error.problem)


# ---- regions, seeds, arguments


def test_regions_are_kept(gen3: Robot, glovebox: Scene) -> None:
    box = Box(size=(0.05, 0.06, 0.08))
    upper = proposed(gen3, holding(glovebox, box, allowed_contacts=HalfSpace(normal=(0.0, 0.0, 1.0), offset=0.0)))
    assert min(pair.points[:, 2].min() for pair in upper) >= 0.0
    assert axes(upper) == set("xy")
    away = Ball(center=(0.025, 0.0, 0.0), radius=0.03)
    outside = proposed(gen3, holding(glovebox, box, forbidden_contacts=away))
    assert min(np.linalg.norm(pair.points - away.center, axis=1).min() for pair in outside) >= 0.03


def test_the_same_seed_gives_the_same_pairs(gen3: Robot, glovebox: Scene) -> None:
    scene = holding(glovebox, Ellipsoid(semi_axes=(0.03, 0.035, 0.04)))
    first, again, other = (proposed(gen3, scene, seed=seed, most=8) for seed in (3, 3, 4))
    assert first == again
    assert first != other
    assert len(first) == 8


def test_an_object_that_no_task_is_about(gen3: Robot, glovebox: Scene) -> None:
    scene = glovebox.with_object("block", Object(shape=Box(size=(0.03, 0.04, 0.12)), pose=Pose(position=(0.6, 0, 0))))
    pairs = pinograsp.contacts(gen3, scene, object="block")
    assert axes(pairs) == set("xy")
    with pytest.raises(UnknownNameError, match="Did you mean block"):
        pinograsp.contacts(gen3, scene, object="blocks")
    for names in ({}, {"task": "sphere", "object": "block"}):
        with pytest.raises(InputError, match="one of both is wanted"):
            pinograsp.contacts(gen3, scene, **names)


def test_pairs_may_be_desired(gen3: Robot, glovebox: Scene) -> None:
    scene = holding(glovebox, Cylinder(radius=0.03, height=0.08))
    points = tuple(tuple(point) for point in proposed(gen3, scene)[0].points.tolist())
    result = pinograsp.plan(gen3, scene.with_task("sphere", desired_contacts=points), "sphere", starts=6, workers=1)
    assert result.verified > 0


def test_pairs_follow_an_object_that_moves(gen3: Robot, glovebox: Scene) -> None:
    """Forces have room: where on the pads a configuration touches is for the check to choose."""
    stronger = glovebox.task("sphere").contact.model_copy(update={"max_force": 20.0})
    scene, floor = holding(glovebox, Box(size=(0.05, 0.06, 0.08)), contact=stronger), glovebox.enclosure.min[2]
    with Planner(gen3, scene, workers=1) as planner:
        assert axes(planner.contacts("sphere")) == set("xyz")
        planner.move("sphere", Pose(position=(0.80, 0.02, floor + 0.04)))
        assert axes(planner.contacts("sphere")) == set("xy")
        grasp = next(planner.grasps("sphere", most=1))
        assert grasp.cost.phi_mm2 == 0.0
        check = planner.check("sphere", grasp.joints)
        assert check.verified
        assert check.grasp.contacts[0].desired_point is None


def test_hands_of_more_pads_are_given_theirs(glovebox: Scene) -> None:
    robot, scene = pinograsp.load_robot("xarm7_allegro"), pinograsp.load_scene("allegro_ceiling")
    error = refusal(robot, scene.with_task("sphere", desired_contacts=None, pads=None))
    assert error.key == "tasks.sphere.desired_contacts"
    assert "contacts are proposed for two pads, and 4 are to touch 'sphere'" in error.problem
    pairs = proposed(robot, scene.with_task("sphere", desired_contacts=None, pads=("thumb", "middle")), most=4)
    assert len(pairs) == 4


# ---- plans


@pytest.mark.parametrize(
    "shape",
    [Box(size=(0.05, 0.06, 0.08)), Sphere(radius=0.0373), Cylinder(radius=0.035, height=0.1)],
    ids=lambda shape: str(shape.type),
)
def test_most_starts_are_verified(gen3: Robot, glovebox: Scene, shape: Any) -> None:
    result = pinograsp.plan(gen3, holding(glovebox, shape), "sphere", starts=20, workers=1)
    assert result.verified >= 18
    assert result.refuted == 0
    for grasp in result:
        assert grasp.cost.phi_mm2 == 0.0
        assert pytest.approx(grasp.cost.V) == grasp.cost.U
        assert [contact.desired_point for contact in grasp.contacts] == [None, None]


def test_results_say_that_nothing_was_desired(gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    """The same for any number of workers; read, proven again, and refuted where somebody adds a wish."""
    scene = holding(glovebox, Cylinder(radius=0.03, height=0.08), force_weight=2.0)
    result, other = (pinograsp.plan(gen3, scene, "sphere", starts=6, workers=workers) for workers in (1, 2))
    assert result.grasps == other.grasps
    best = result.ranked("U")[0]
    assert pytest.approx(2.0 * best.cost.V) == best.cost.U
    file = tmp_path / "result.json"
    pinograsp.write_json(result, file)
    read = pinograsp.read_json(file)
    assert read == result
    assert pinograsp.verify(read) == ()
    assert "no contacts desired: each start was led to pairs that were proposed to it" in result._repr_html_()
    page = tmp_path / "page.html"
    pinograsp.visualization.write_html(result, page)
    assert "no contacts desired: proposed ones" in page.read_text()
    assert "desired contact point" not in page.read_text()
    content = json.loads(file.read_text())
    contact = content["grasps"][0]["contacts"][0]
    assert contact["desired_point"] is None
    contact["desired_point"] = contact["point"]
    file.write_text(json.dumps(content))
    with pytest.raises(InputError, match="the task desires none") as caught:
        pinograsp.read_json(file)
    assert caught.value.key == "grasps[0].contacts[0].desired_point"


# ---- command line and page


def test_the_command_lists_and_draws(run: Run, gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    code, output, _ = run("contacts", "glovebox", "--object", "sphere", "--most", 3, "--out", "out")
    assert code == 0
    assert len(re.findall(r"^[123] +74\.6 ", output, re.MULTILINE)) == 3
    name = "glovebox_sphere_gen3_2f85_contacts"
    content = json.loads((tmp_path / "out" / f"{name}.json").read_text())
    pairs = pinograsp.contacts(gen3, glovebox, object="sphere", most=3)
    assert content["pairs"] == [pair.to_json() for pair in pairs]
    page = (tmp_path / "out" / f"{name}.html").read_text()
    assert page.count("&#9632;") == 3
    code, output, _ = run("contacts", "glovebox", "--task", "sphere", "--seed", 1, "--json")
    assert json.loads(output)["object"] == "sphere"
    assert len(json.loads(output)["pairs"]) == 24


def test_the_command_says_what_is_wrong(run: Run) -> None:
    code, _, errors = run("contacts", "glovebox")
    assert code == 2
    assert "--task, --object: one of both is wanted" in errors
    code, _, errors = run("contacts", "glovebox", "--object", "spere")
    assert code == 2
    assert "Did you mean sphere?" in errors


def test_a_page_needs_pairs_and_an_object(glovebox: Scene, gen3: Robot, tmp_path: Path) -> None:
    pairs, file = pinograsp.contacts(gen3, glovebox, object="sphere", most=1), tmp_path / "page.html"
    with pytest.raises(InputError, match="no pair to draw"):
        pinograsp.visualization.write_contacts_html((), glovebox, "sphere", file)
    with pytest.raises(UnknownNameError, match="Did you mean sphere"):
        pinograsp.visualization.write_contacts_html(pairs, glovebox, "spher", file)


# ---- meshes


def test_a_fine_mesh_has_pairs_as_its_shape(gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    box = meshes.written(meshes.box((-0.025, -0.03, -0.04), (0.025, 0.03, 0.04)), tmp_path / "box.stl")
    pairs = proposed(gen3, holding(glovebox, Mesh(file=box, unit="m")))
    sides = {"xyz"[int(np.abs(pair.normals[0]).argmax())] for pair in pairs}
    assert sides == set("xyz")
    for pair in pairs:
        size = {"x": 0.05, "y": 0.06, "z": 0.08}["xyz"[int(np.abs(pair.normals[0]).argmax())]]
        assert pair.width == pytest.approx(size, abs=0.002)
        assert math.acos(float(-pair.normals[0] @ pair.normals[1])) < math.radians(6.4)


@pytest.mark.parametrize(
    ("mesh", "why"),
    [
        (meshes.box((-0.02, -0.025, -2e-4), (0.02, 0.025, 2e-4)), "are at edges, or where it is thinner than 0.5 mm"),
        (meshes.ball(1e-9), "too narrow by 0.2 mm: at most 0.0 mm"),
    ],
)
def test_a_mesh_that_is_too_thin_is_told_so(gen3: Robot, glovebox: Scene, tmp_path: Path, mesh: Any, why: str) -> None:
    file = meshes.written(mesh, tmp_path / "thin.stl")
    assert why in refusal(gen3, holding(glovebox, Mesh(file=file, unit="m"))).problem


def test_a_cup_is_held_across_both_walls(gen3: Robot, glovebox: Scene, tmp_path: Path) -> None:
    """A pad is too wide for one of them, and with a finger inside, at the bottom, the hand would be in the other."""
    hollow = meshes.cylinder(0.017, 0.005, 0.05)
    cup = meshes.written(meshes.cylinder(0.02, 0.0, 0.04).difference(hollow, engine="manifold"), tmp_path / "cup.stl")
    pairs = proposed(gen3, holding(glovebox, Mesh(file=cup, unit="m")), most=8)
    assert {round(1e3 * pair.width) for pair in pairs} == {40}
