"""Shapes: every described one has geometry, triangles and the verification's geometry, and they agree; a new one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import coal
import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

import pinograsp
from pinograsp.collision.solids import distance_request, scene_body
from pinograsp.descriptions import schema
from pinograsp.descriptions.scene import Body
from pinograsp.descriptions.shapes import SHAPES, Box, Cylinder, ShapeDescription, Sphere
from pinograsp.descriptions.values import Positive
from pinograsp.geometry.contact_faces import ContactFace, Ruling, Spot
from pinograsp.geometry.shapes import SURFACES, surface_of
from pinograsp.geometry.tessellation import Tessellation, refined, tessellation_of
from pinograsp.kinematics.robot import Robot
from pinograsp.verification.shapes import GEOMETRY, Core, PlacedShape
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


# ---- a shape that the package does not have


class Capsule(ShapeDescription):
    """A ball swept along the z axis, centred at the origin."""

    type: Literal["capsule"]
    radius: Positive
    height: Positive
    """Between the centres of the end balls."""


class CapsuleSurface:
    """Distance to the axis less the radius."""

    def __init__(self, shape: Capsule) -> None:
        self._radius, self._half = shape.radius, 0.5 * shape.height
        self.least_width = 2.0 * shape.radius
        self.radius = self._half + self._radius

    def signed_distance(self, points: Array) -> tuple[Array, Array, Array]:
        apart = points.copy()
        apart[:, 2] -= np.clip(points[:, 2], -self._half, self._half)
        length = np.linalg.norm(apart, axis=1)
        apart[length == 0.0] = [1.0, 0.0, 0.0]
        norm = np.where(length > 0.0, length, 1.0)
        normals = apart / norm[:, None]
        curved = np.eye(3) - normals[:, :, None] * normals[:, None, :]
        curved[np.abs(points[:, 2]) < self._half, 2, 2] = 0.0
        return length - self._radius, normals, curved / norm[:, None, None]

    def contact_face(self, point: Array) -> ContactFace:
        beyond = abs(point[2]) > self._half
        return Spot() if beyond else Ruling(np.array([0.0, 0.0, 1.0]), -self._half - point[2], self._half - point[2])

    def extent(self, direction: Array) -> float:
        return float(self._radius * np.linalg.norm(direction) + self._half * abs(direction[2]))

    def solids(self) -> tuple[Any, ...]:
        return (coal.Capsule(self._radius, 2.0 * self._half),)

    def tessellation(self) -> Tessellation:
        return tessellation_of(trimesh.creation.capsule(2.0 * self._half, self._radius, count=[24, 24]))


class CapsuleGeometry:
    """Two end balls and a rod between them."""

    def __init__(self, shape: Capsule) -> None:
        self._radius, self._top = shape.radius, np.array([0.0, 0.0, shape.height / 2])
        core = 1e-3 * shape.radius
        self.cores: tuple[Core, ...] = (Core(coal.Capsule(core, shape.height), shape.radius - core),)

    def _from_axis(self, point: Array) -> Array:
        share = np.clip(point @ self._top / (self._top @ self._top), -1.0, 1.0)
        return np.asarray(point - share * self._top)

    def distance(self, point: Array) -> float:
        return float(np.linalg.norm(self._from_axis(point))) - self._radius

    def inward(self, point: Array) -> Array:
        apart = self._from_axis(point)
        return np.asarray(-apart / np.linalg.norm(apart))

    def face(self, point: Array) -> Array:
        apart = self._from_axis(point)
        on_surface = self._radius / np.linalg.norm(apart) * apart
        if abs(point[2]) > self._top[2]:
            return np.asarray(point - apart + on_surface)[None]
        return np.array([on_surface - self._top, on_surface + self._top])

    def edge(self, point: Array) -> float:
        return math.inf

    def radius_about(self, point: Array) -> float:
        return self._radius + float(max(np.linalg.norm(point - end) for end in (self._top, -self._top)))


CAPSULE = Capsule(type="capsule", radius=0.0373, height=0.04)


@pytest.fixture
def registered() -> Iterator[None]:
    """The capsule is a shape like any other during a test."""
    with pytest.MonkeyPatch.context() as patch:
        SHAPES.add(Capsule)
        patch.setitem(SURFACES, Capsule, CapsuleSurface)
        patch.setitem(GEOMETRY, Capsule, CapsuleGeometry)
        yield
    SHAPES.remove(Capsule)


# ---- every shape


def test_every_described_shape_has_its_geometry_twice() -> None:
    assert set(SHAPES) == set(SURFACES) == set(GEOMETRY)
    assert set(SHAPES) == set(EXAMPLES)


every_shape = pytest.mark.parametrize("shape", [*EXAMPLES.values(), CAPSULE], ids=lambda shape: shape.type)
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
        assert min(apart) + 1e-3 == pytest.approx(distance, abs=1e-8)


@every_shape
def test_the_verification_sees_the_same_shape(shape: ShapeDescription, registered: None) -> None:
    surface, placed = surface_of(shape), PlacedShape("it", Body(shape=shape))
    points = scattered(surface.radius)
    distances, normals, _ = surface.signed_distance(points)
    assert distances.min() < 0.0 < distances.max()
    np.testing.assert_allclose([placed.distance(point) for point in points], distances, atol=1e-12)
    assert placed.radius == pytest.approx(surface.radius)
    on_surface = surface.tessellation().corners.mean(axis=1)  # next to it, off every edge
    _, normals, _ = surface.signed_distance(on_surface)
    np.testing.assert_allclose([placed.inward(point) for point in on_surface], -normals, atol=1e-12)


@every_shape
def test_cores_are_the_shape_less_their_inset(shape: ShapeDescription, registered: None) -> None:
    surface = surface_of(shape)
    far = 10.0 * surface.radius * np.array([0.0, 0.0, 1.0])
    ball, at = coal.Sphere(1e-3), coal.Transform3s(np.eye(3), far)
    for core in PlacedShape("it", Body(shape=shape)).cores:
        apart = coal.distance(core.solid, coal.Transform3s(), ball, at, coal.DistanceRequest(), coal.DistanceResult())
        assert apart + 1e-3 - core.inset == pytest.approx(far[2] - surface.extent(far / far[2]), abs=1e-6)


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


# ---- the registry


def test_two_shapes_of_one_name_are_refused() -> None:
    class Other(ShapeDescription):
        type: Literal["sphere"]

    before = tuple(SHAPES)
    with pytest.raises(TypeError, match="sphere"):
        SHAPES.add(Other)
    assert tuple(SHAPES) == before


SCENE = """
format: 1
name: capsules
enclosure:
  min: [0.0, -0.42, -0.237]
  max: [1.10, 0.42, 0.363]
mounting: {position: [0.0, 0.0, 0.0], rpy: [0.0, 1.5707963267948966, 0.0]}
objects:
  beam:
    shape: {type: capsule, radius: 0.02, height: 0.3}
    pose: {position: [1.05, 0.35, 0.0]}
  capsule:
    shape: {type: capsule, radius: 0.0373, height: 0.04}
    pose: {position: [0.801, 0.020, -0.1797]}
tasks:
  side: &side
    object: capsule
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
    with pytest.raises(pinograsp.InputError, match="'capsule' is not known"):
        pinograsp.load_scene(scene_file(tmp_path))
    assert "Capsule" not in schema("scene")["$defs"]


@pytest.mark.usefixtures("registered")
def test_a_new_shape_is_described_like_any_other(tmp_path: Path) -> None:
    scene = pinograsp.load_scene(scene_file(tmp_path))
    assert scene.objects["capsule"].shape == CAPSULE
    content = scene.model_dump()
    assert content["objects"]["capsule"]["shape"] == {"type": "capsule", "radius": 0.0373, "height": 0.04}
    assert '"beam":{"shape":{"type":"capsule","radius":0.02,"height":0.3}' in scene.model_dump_json()
    assert type(scene).model_validate(content) == scene
    assert type(scene).model_validate_json(scene.model_dump_json()) == scene
    assert "Capsule" in schema("scene")["$defs"]
    misspelt = scene_file(tmp_path, SCENE.replace("height: 0.04", "hieght: 0.04"))
    with pytest.raises(pinograsp.InputError, match=r"objects\.capsule\.shape\.hieght.*unknown key.*mean height"):
        pinograsp.load_scene(misspelt)
    unknown = scene_file(tmp_path, SCENE.replace("type: capsule, radius: 0.0373", "type: capsul, radius: 0.0373"))
    with pytest.raises(pinograsp.InputError, match=r"objects\.capsule\.shape\.type.*mean capsule"):
        pinograsp.load_scene(unknown)


@pytest.mark.usefixtures("registered")
def test_a_new_shape_is_drawn_and_painted(tmp_path: Path) -> None:
    scene = pinograsp.load_scene(scene_file(tmp_path))
    for task, painted in (("side", False), ("ring", True)):
        recorder = Recorder()
        draw_scene(Visualizer(window=recorder), scene, scene.task(task))
        drawn = {c["path"].rsplit("meshcat/")[-1]: c["object"] for c in recorder.commands if c["type"] == "set_object"}
        for name in ("object", "obstacles/beam"):
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
    surface = surface_of(CAPSULE)
    for contact in best.contacts:
        point = np.array(contact.point) - scene.objects["capsule"].pose.matrix[:3, 3]
        assert surface.signed_distance(point[None])[0] == pytest.approx(0.0, abs=2e-5)
        assert abs(point[2]) <= 0.02 + 1e-6
    pinograsp.write_json(result, tmp_path / "result.json")
    read = pinograsp.read_json(tmp_path / "result.json")
    assert not read.altered
    assert read.setup.scene == scene
    assert pinograsp.verify(read) == ()
    write_html(read, tmp_path / "grasp.html")
    assert (tmp_path / "grasp.html").stat().st_size > 100_000
