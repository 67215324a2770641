"""Shapes: every described one has geometry, triangles and the verification's geometry, and they agree; a new one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import coal
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import pinograsp
from pinograsp.collision.solids import distance_request, scene_body
from pinograsp.descriptions import schema
from pinograsp.descriptions.bodies import Body
from pinograsp.descriptions.shapes import (
    SHAPES,
    Box,
    Capsule,
    Compound,
    Cone,
    Cylinder,
    Ellipsoid,
    FormulaShape,
    Mesh,
    ShapeDescription,
    Sphere,
)
from pinograsp.descriptions.values import Positive
from pinograsp.geometry.contact_faces import Ruling
from pinograsp.geometry.convex_solid import convex_solid
from pinograsp.geometry.shapes import SURFACES, surface_of
from pinograsp.geometry.shapes.sphere import SphereSurface
from pinograsp.geometry.tessellation import Tessellation, refined
from pinograsp.kinematics.robot import Robot
from pinograsp.verification.shapes import GEOMETRY, PlacedShape
from pinograsp.verification.shapes.core import PENETRATION
from pinograsp.verification.shapes.sphere import SphereGeometry
from pinograsp.visualization import write_html
from pinograsp.visualization.scene import draw_scene
from pinograsp.visualization.surfaces import surface_mesh
from pinograsp.visualization.viewer import Recorder, Visualizer

Array = NDArray[np.float64]

EXAMPLES: dict[type, ShapeDescription] = {
    Sphere: Sphere(type="sphere", radius=0.04),
    Box: Box(type="box", size=(0.05, 0.08, 0.03)),
    Cylinder: Cylinder(type="cylinder", radius=0.03, height=0.1),
    Capsule: Capsule(radius=0.02, length=0.05),
    Cone: Cone(bottom_radius=0.035, top_radius=0.02, height=0.08),
    Ellipsoid: Ellipsoid(semi_axes=(0.03, 0.04, 0.05)),
}
FURTHER = (Cone(bottom_radius=0.0, top_radius=0.03, height=0.06), Cone(bottom_radius=0.04, top_radius=0.0, height=0.05))
"""Kinds of them with tips."""


# ---- a shape that the package does not have


class Bead(FormulaShape):
    """A ball around the origin."""

    type: Literal["bead"]
    diameter: Positive

    @property
    def volume(self) -> float:
        """m^3."""
        return math.pi / 6.0 * self.diameter**3


class BeadSurface(SphereSurface):
    """That of a ball of half the diameter."""

    def __init__(self, shape: Bead) -> None:
        super().__init__(Sphere(radius=0.5 * shape.diameter))


class BeadGeometry(SphereGeometry):
    """That of a ball of half the diameter."""

    def __init__(self, shape: Bead) -> None:
        super().__init__(Sphere(radius=0.5 * shape.diameter))


BEAD = Bead(type="bead", diameter=0.0746)


@pytest.fixture
def registered() -> Iterator[None]:
    """The bead is a shape like any other during a test."""
    with pytest.MonkeyPatch.context() as patch:
        SHAPES.add(Bead)
        patch.setitem(SURFACES, Bead, BeadSurface)
        patch.setitem(GEOMETRY, Bead, BeadGeometry)
        yield
    SHAPES.remove(Bead)


# ---- every shape


def test_every_described_shape_has_its_geometry_twice() -> None:
    assert set(SHAPES) == set(SURFACES) == set(GEOMETRY)
    assert set(SHAPES) == {*EXAMPLES, Mesh, Compound}  # `test_mesh_contact` and `test_compound` have the others


every_shape = pytest.mark.parametrize("shape", [*EXAMPLES.values(), *FURTHER, BEAD], ids=lambda shape: shape.type)
"""The described shapes and the one of this file, which is registered meanwhile."""


@every_shape
def test_corners_of_triangles_are_on_the_surface(shape: ShapeDescription, registered: None) -> None:
    surface = surface_of(shape)
    tessellation = surface.tessellation()
    np.testing.assert_allclose(surface.signed_distance(tessellation.vertices)[0], 0.0, atol=1e-12)
    inside = surface.signed_distance(tessellation.corners.mean(axis=1))[0]
    assert inside.max() < 1e-12  # the shape is convex
    assert inside.min() > -0.01 * surface.radius


@every_shape
def test_triangles_are_closed_and_face_outward(shape: ShapeDescription, registered: None) -> None:
    surface = surface_of(shape)
    tessellation = surface.tessellation()
    assert closed(tessellation)
    corners = tessellation.corners
    facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = surface.signed_distance(0.999 * corners.mean(axis=1))[1]
    assert (np.einsum("ni,ni->n", facets, outward) > 0.0).all()


@every_shape
def test_solids_are_the_shape(shape: ShapeDescription, registered: None) -> None:
    surface, body = surface_of(shape), scene_body("obstacle", "it", Body(shape=shape))
    request = distance_request()
    probe = coal.Sphere(1e-3)
    probe.computeLocalAABB()
    points = scattered(surface.radius)
    distances = surface.signed_distance(points)[0]
    for point, distance in zip(points[distances > 0.01], distances[distances > 0.01], strict=True):
        at = coal.Transform3s(np.eye(3), point)
        here = [coal.Transform3s(solid.placement[:3, :3], solid.placement[:3, 3]) for solid in body.solids]
        apart = [
            coal.distance(solid.shape, T, probe, at, request, coal.DistanceResult())
            for solid, T in zip(body.solids, here, strict=True)
        ]
        assert min(apart) + 1e-3 == pytest.approx(distance, abs=1e-5 if isinstance(shape, Cone) else 1e-8)
        assert min(apart) + 1e-3 < distance + 1e-8  # all of the shape is in its solids


@every_shape
def test_the_verification_sees_the_same_shape(shape: ShapeDescription, registered: None) -> None:
    surface, placed = surface_of(shape), PlacedShape("it", Body(shape=shape))
    points = scattered(surface.radius)
    distances, normals, _ = surface.signed_distance(points)
    assert distances.min() < 0.0 < distances.max()
    np.testing.assert_allclose([placed.distance(point) for point in points], distances, atol=1e-12)
    assert placed.radius_about(np.zeros(3)) == pytest.approx(surface.radius)
    on_surface = surface.tessellation().corners.mean(axis=1)  # next to it, off every edge
    _, normals, _ = surface.signed_distance(on_surface)
    np.testing.assert_allclose([placed.inward(point) for point in on_surface], -normals, atol=1e-12)


@every_shape
def test_cores_are_the_shape_less_their_inset(shape: ShapeDescription, registered: None) -> None:
    surface = surface_of(shape)
    middle = surface.tessellation().corners.mean(axis=1)[::5]
    depths, normals, _ = surface.signed_distance(middle)
    ball = coal.Sphere(1e-3)
    for core in PlacedShape("it", Body(shape=shape)).parts[0].cores:
        for point, normal, depth in zip(middle, normals, depths, strict=True):
            at = coal.Transform3s(np.eye(3), point + (0.1 - depth) * normal)
            apart = coal.distance(
                core.solid, coal.Transform3s(), ball, at, coal.DistanceRequest(), coal.DistanceResult()
            )
            assert apart + 1e-3 - core.inset == pytest.approx(0.1, abs=0.3 * PENETRATION)


@every_shape
def test_refined_triangles_are_the_same_facets(shape: ShapeDescription, registered: None) -> None:
    coarse = surface_of(shape).tessellation()
    fine = refined(coarse, 0.004)
    edges = np.linalg.norm(np.roll(fine.corners, -1, axis=1) - fine.corners, axis=2)
    assert edges.max() <= 0.004
    assert closed(fine)
    for measure in (volume, area):
        assert measure(fine) == pytest.approx(measure(coarse))


@every_shape
def test_it_is_drawn_with_the_normals_of_its_surface(shape: ShapeDescription, registered: None) -> None:
    surface = surface_of(shape)
    for tessellation in (refined(surface.tessellation(), 0.002), surface.tessellation()):
        mesh = surface_mesh(surface, tessellation)
        attributes = mesh.lower({})["data"]["attributes"]
        normals = np.frombuffer(attributes["normal"]["array"].data, dtype=np.float32).reshape(-1, 3)
        assert normals.shape == mesh.vertices.shape
        middles = mesh.vertices[mesh.faces].mean(axis=1)
        _, expected, _ = surface.signed_distance(middles.astype(np.float64))
        along = np.einsum("nki,ni->nk", normals[mesh.faces], expected)
        assert along.min() > 0.98  # at an edge of the shape, too, a triangle has the normals of its own side
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=2e-3)
    assert mesh_bytes(mesh) < 100_000


def test_a_box_is_drawn_with_sharp_edges() -> None:
    surface = surface_of(EXAMPLES[Box])
    mesh = surface_mesh(surface, surface.tessellation())
    assert len(mesh.vertices) == 24  # three normals at each corner
    assert {tuple(normal) for normal in mesh.normals} == {tuple(n) for s in (1.0, -1.0) for n in s * np.eye(3) + 0.0}


def scattered(radius: float) -> Array:
    """Return points in and around a shape of that radius, m, shape (n, 3)."""
    return np.random.default_rng(0).uniform(-1.5 * radius, 1.5 * radius, size=(300, 3))


def closed(tessellation: Tessellation) -> bool:
    """Whether every edge is passed once in each direction."""
    passed = [(a, b) for t in tessellation.triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)]
    return len(passed) == len(set(passed)) and {(b, a) for a, b in passed} == set(passed)


def volume(tessellation: Tessellation) -> float:
    return float(np.linalg.det(tessellation.corners).sum() / 6.0)


def area(tessellation: Tessellation) -> float:
    a, b, c = tessellation.corners.transpose(1, 0, 2)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def mesh_bytes(mesh: Any) -> int:
    data = mesh.lower({})["data"]
    return sum(len(part["array"].data) for part in (*data["attributes"].values(), data["index"]))


@every_shape
def test_gradient_and_hessian_are_those_of_the_distance(shape: ShapeDescription, registered: None) -> None:
    surface, step = surface_of(shape), 1e-6
    points = scattered(surface.radius)
    distances, normals, hessians = surface.signed_distance(points)
    moved = [[surface.signed_distance(points + sign * step * axis) for sign in (1.0, -1.0)] for axis in np.eye(3)]
    slopes = np.stack([(up[0] - down[0]) / (2 * step) for up, down in moved], axis=1)
    bends = np.stack([(up[1] - down[1]) / (2 * step) for up, down in moved], axis=2)
    # Off the places where another side, or another end of the shape, becomes the nearest one.
    smooth = (distances > -0.1 * surface.least_width) & (np.abs(bends).max(axis=(1, 2)) < 1e3)
    assert smooth.sum() > 200
    np.testing.assert_allclose(normals[smooth], slopes[smooth], atol=1e-6)
    np.testing.assert_allclose(hessians[smooth], bends[smooth], atol=1e-2)


@every_shape
def test_lines_up_a_side_turn_as_they_say(shape: ShapeDescription, registered: None) -> None:
    surface, step = surface_of(shape), 1e-6
    middle = surface.tessellation().corners.mean(axis=1)[::7]
    depths, normals, _ = surface.signed_distance(middle)
    for point in middle - depths[:, None] * normals:
        face = surface.contact_face(point)
        if not isinstance(face, Ruling):
            continue
        ends = [surface.signed_distance((point + at * face.direction)[None])[0][0] for at in (face.low, face.high)]
        np.testing.assert_allclose(ends, 0.0, atol=1e-12)
        moved = [[surface.contact_face(point + sign * step * axis) for sign in (1.0, -1.0)] for axis in np.eye(3)]
        if any(not isinstance(there, Ruling) for pair in moved for there in pair):
            continue
        bend = np.stack([(up.direction - down.direction) / (2 * step) for up, down in moved], axis=1)
        np.testing.assert_allclose(np.zeros((3, 3)) if face.bend is None else face.bend, bend, rtol=1e-5, atol=1e-4)


# ---- the registry


@pytest.mark.parametrize("thickness", [1e-5, 1e-10, 0.0])
def test_what_is_flat_becomes_a_solid_that_holds_it(thickness: float) -> None:
    """Coal ends the process where it makes the hull of points in a plane."""
    corners = np.array(list(itertools.product((-0.1, 0.1), (-0.2, 0.2), (-0.5 * thickness, 0.5 * thickness))))
    R = Rotation.from_euler("xyz", [0.3, -0.5, 0.7]).as_matrix()
    solid = np.array(convex_solid(corners @ R.T).points()) @ R
    assert np.ptp(solid, axis=0) == pytest.approx([0.2, 0.4, max(thickness, 0.4e-6)], rel=0.2)
    assert (np.abs(solid).max(axis=0) >= [0.1 - 1e-12, 0.2 - 1e-12, 0.5 * thickness - 1e-12]).all()


def test_slender_shapes_have_triangles() -> None:
    drawn = surface_of(Cylinder(radius=1e-5, height=0.03)).tessellation()
    assert np.abs(drawn.vertices).max(axis=0) == pytest.approx([1e-5, 1e-5, 0.015])
    a, b, c = drawn.corners.transpose(1, 0, 2)
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert volume == pytest.approx(24.0 * math.sin(2.0 * math.pi / 48.0) * 1e-10 * 0.03)


def test_two_shapes_of_one_name_are_refused() -> None:
    class Other(ShapeDescription):
        type: Literal["sphere"]

    before = tuple(SHAPES)
    with pytest.raises(TypeError, match="sphere"):
        SHAPES.add(Other)
    assert tuple(SHAPES) == before


SCENE = """
format: 1
name: beads
enclosure:
  min: [0.0, -0.42, -0.237]
  max: [1.10, 0.42, 0.363]
mounting: {position: [0.0, 0.0, 0.0], rpy: [0.0, 1.5707963267948966, 0.0]}
objects:
  other:
    shape: {type: bead, diameter: 0.04}
    pose: {position: [1.05, 0.35, 0.0]}
  bead:
    shape: {type: bead, diameter: 0.0746}
    pose: {position: [0.801, 0.020, -0.1797]}
tasks:
  side: &side
    object: bead
    desired_contacts: [[0.0, 0.0373, 0.0], [0.0, -0.0373, 0.0]]
    wrench: {force: [0.0, 0.0, -2.0]}
    contact: {friction: 0.9}
  ring:
    <<: *side
    allowed_contacts: {type: band, z: [-0.02, 0.02]}
"""


def scene_file(folder: Path, text: str = SCENE) -> Path:
    file = folder / "scene.yaml"
    file.write_text(text)
    return file


def test_a_shape_is_known_while_it_is_registered(tmp_path: Path) -> None:
    with pytest.raises(pinograsp.InputError, match="'bead' is not known"):
        pinograsp.load_scene(scene_file(tmp_path))
    assert "Bead" not in schema("scene")["$defs"]


@pytest.mark.usefixtures("registered")
def test_a_new_shape_is_described_like_any_other(tmp_path: Path) -> None:
    scene = pinograsp.load_scene(scene_file(tmp_path))
    assert scene.objects["bead"].shape == BEAD
    content = scene.model_dump()
    assert content["objects"]["bead"]["shape"] == {"type": "bead", "diameter": 0.0746}
    assert '"other":{"shape":{"type":"bead","diameter":0.04}' in scene.model_dump_json()
    assert type(scene).model_validate(content) == scene
    assert type(scene).model_validate_json(scene.model_dump_json()) == scene
    assert "Bead" in schema("scene")["$defs"]
    misspelt = scene_file(tmp_path, SCENE.replace("diameter: 0.0746", "daimeter: 0.0746"))
    with pytest.raises(pinograsp.InputError, match=r"objects\.bead\.shape\.daimeter.*unknown key.*mean diameter"):
        pinograsp.load_scene(misspelt)
    unknown = scene_file(tmp_path, SCENE.replace("type: bead, diameter: 0.0746", "type: baed, diameter: 0.0746"))
    with pytest.raises(pinograsp.InputError, match=r"objects\.bead\.shape\.type.*mean bead"):
        pinograsp.load_scene(unknown)


@pytest.mark.usefixtures("registered")
def test_a_new_shape_is_drawn_and_painted(tmp_path: Path) -> None:
    scene = pinograsp.load_scene(scene_file(tmp_path))
    for task, painted in (("side", False), ("ring", True)):
        recorder = Recorder()
        draw_scene(Visualizer(window=recorder), scene, scene.task(task))
        drawn = {c["path"].rsplit("meshcat/")[-1]: c["object"] for c in recorder.commands if c["type"] == "set_object"}
        for name in ("object", "obstacles/other"):
            [geometry] = drawn[name]["geometries"]
            assert ("color" in geometry["data"]["attributes"]) == (painted and name == "object")


@pytest.mark.usefixtures("registered")
def test_a_new_shape_is_grasped(gen3: Robot, tmp_path: Path) -> None:
    scene = pinograsp.load_scene(scene_file(tmp_path))
    result = pinograsp.plan(gen3, scene, "ring", starts=3, workers=1)
    assert result.verified >= 2
    assert result.refuted == 0
    best = result.best
    assert best is not None
    surface = surface_of(BEAD)
    for contact in best.contacts:
        point = np.array(contact.point) - scene.objects["bead"].pose.matrix[:3, 3]
        assert surface.signed_distance(point[None])[0] == pytest.approx(0.0, abs=2e-5)
        assert abs(point[2]) <= 0.02 + 1e-6
    pinograsp.write_json(result, tmp_path / "result.json")
    read = pinograsp.read_json(tmp_path / "result.json")
    assert not read.altered
    assert read.setup.scene == scene
    assert pinograsp.verify(read) == ()
    write_html(read, tmp_path / "grasp.html")
    assert (tmp_path / "grasp.html").stat().st_size > 100_000
