"""The signed distance of a mesh as splines on lattices, the normal that a pad feels, and points in trees against it."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import meshes
import numpy as np
import pytest
import trimesh
from conftest import Array

from pinograsp.cache_folder import cache_folder
from pinograsp.descriptions.mesh_contact import SIGMAS
from pinograsp.geometry.distance_field import APART, EXACT, DistanceField, distance_field, footprint_sigma
from pinograsp.geometry.exact_distance import ExactDistance
from pinograsp.geometry.field_bounds import bounds_of
from pinograsp.geometry.field_cache import mesh_field
from pinograsp.geometry.field_kernels import coarse_values, field_distances, field_normals, near_enough, nearest_points
from pinograsp.geometry.hulls import Hull
from pinograsp.geometry.point_trees import deepest_point, point_trees

THINGS = list(meshes.THINGS)


@cache
def thing(name: str) -> tuple[trimesh.Trimesh, ExactDistance, DistanceField]:
    mesh = meshes.THINGS[name]()
    vertices, faces = meshes.arrays(mesh)
    return mesh, ExactDistance(vertices, faces), mesh_field(name, ExactDistance(vertices, faces))


def on_surface(mesh: trimesh.Trimesh, count: int) -> tuple[Array, Array]:
    """Return points on a mesh and the normals of their facets."""
    points, which = trimesh.sample.sample_surface(mesh, count, seed=0)
    return np.array(points), np.array(mesh.face_normals[which])


@pytest.mark.parametrize("name", THINGS)
@pytest.mark.parametrize(("off", "mean", "most"), [(0.0, 2e-5, 3e-4), (0.001, 2e-5, 3e-4), (-0.001, 4e-5, 3e-4)])
def test_distances_are_next_to_exact_near_the_surface(name: str, off: float, mean: float, most: float) -> None:
    mesh, exact, field = thing(name)
    points, normals = on_surface(mesh, 4000)
    points += off * normals
    error = np.abs(field_distances(field, points)[0] - exact.signed(points))
    assert error.mean() < mean
    assert error.max() < most


@pytest.mark.parametrize("name", THINGS)
def test_distances_are_about_right_everywhere(name: str) -> None:
    mesh, exact, field = thing(name)
    points = np.random.default_rng(0).uniform(mesh.bounds[0] - 0.08, mesh.bounds[1] + 0.08, (3000, 3))
    distances, true = field_distances(field, points)[0], exact.signed(points)
    np.testing.assert_allclose(distances, true, atol=2e-3)
    deep = np.abs(true) > 5e-4
    np.testing.assert_array_equal(distances[deep] < 0.0, true[deep] < 0.0)
    assert deep.sum() > 2900


@pytest.mark.parametrize("name", THINGS)
@pytest.mark.parametrize("spread", [0.0, 0.004, 0.03, 0.3], ids=lambda spread: f"{1e3 * spread:g} mm")
def test_derivatives(name: str, spread: float) -> None:
    """On the surface, near it, within the coarse lattice and beyond."""
    mesh, _, field = thing(name)
    points = on_surface(mesh, 100)[0] + spread * np.random.default_rng(1).normal(size=(100, 3))
    _, gradients, hessians = field_distances(field, points)
    normals, turning = field_normals(field, points)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-12)
    for axis, step in enumerate(1e-7 * np.eye(3)):
        ahead, behind = field_distances(field, points + step), field_distances(field, points - step)
        np.testing.assert_allclose(gradients[:, axis], (ahead[0] - behind[0]) / 2e-7, atol=1e-6)
        np.testing.assert_allclose(hessians[:, :, axis], (ahead[1] - behind[1]) / 2e-7, atol=1e-4 * abs(hessians).max())
        change = (field_normals(field, points + step)[0] - field_normals(field, points - step)[0]) / 2e-7
        np.testing.assert_allclose(turning[:, :, axis], change, atol=1e-4 * abs(turning).max())


@pytest.mark.parametrize("name", THINGS)
def test_nothing_jumps_where_lattices_end(name: str) -> None:
    _, _, field = thing(name)
    for lattice, jump in ((field.distance, 2e-6), (field.coarse, 1e-6)):
        edge = lattice.origin + lattice.spacing
        middle = lattice.origin + 0.5 * lattice.spacing * np.array(lattice.coefficients.shape)
        for axis in range(3):
            point = middle.copy()
            point[axis] = edge[axis]
            around = np.array([point - 1e-9 * np.eye(3)[axis], point + 1e-9 * np.eye(3)[axis]])
            values, gradients, _ = field_distances(field, around)
            assert abs(values[1] - values[0]) < jump
            if lattice is field.distance:
                np.testing.assert_allclose(gradients[0], gradients[1], atol=0.02)


def test_distances_far_away_are_bounded() -> None:
    mesh, exact, field = thing("mug")
    directions = np.random.default_rng(0).normal(size=(200, 3))
    points = (
        mesh.centroid + directions / np.linalg.norm(directions, axis=1)[:, None] * np.linspace(0.3, 2.0, 200)[:, None]
    )
    true = exact.unsigned(points)
    assert (field_distances(field, points)[0] >= true - 1e-3).all()


def test_normals_of_a_ball_and_of_a_cylinder_are_those_of_the_shape() -> None:
    """What is symmetric stays so when it is smoothed; facets of half a millimetre do not show."""
    vertices, faces = meshes.arrays(meshes.ball(0.03, 5))
    points = 0.03 * np.random.default_rng(0).normal(size=(200, 3))
    points *= 0.03 / np.linalg.norm(points, axis=1)[:, None]
    normals, turning = field_normals(mesh_field("ball", ExactDistance(vertices, faces)), points)
    assert np.degrees(np.arccos((normals * points / 0.03).sum(axis=1).clip(-1.0, 1.0))).max() < 0.1
    expected = (np.eye(3) - normals[:, :, None] * normals[:, None, :]) / 0.03
    np.testing.assert_allclose(turning, expected, atol=2.0)  # 6 % of 1 / radius


def test_an_edge_is_rounded_by_the_width_of_a_footprint() -> None:
    """On a box the smoothed normal is the face's in its middle, and halfway between two faces on their edge."""
    vertices, faces = meshes.arrays(meshes.box([-0.02, -0.02, -0.02], [0.02, 0.02, 0.02]))
    field = mesh_field("box", ExactDistance(vertices, faces))
    points = np.array([[0.02, 0.003, -0.002], [0.02, 0.02, 0.0]])
    normals = field_normals(field, points)[0]
    np.testing.assert_allclose(normals, [[1.0, 0.0, 0.0], [0.5**0.5, 0.5**0.5, 0.0]], atol=1e-3)


@pytest.mark.parametrize(("thickness", "sigma"), [(0.02, 0.002), (0.0035, 0.0015), (0.0022, 0.001), (0.0005, 0.0005)])
def test_footprints_are_narrower_on_thin_bodies(thickness: float, sigma: float) -> None:
    mesh = meshes.box([-0.03, -0.03, 0.0], [0.03, 0.03, thickness]).subdivide_to_size(0.01)
    vertices, faces = meshes.arrays(mesh)
    assert sigma in SIGMAS
    assert footprint_sigma(ExactDistance(vertices, faces)) == sigma


def test_thin_sheets_have_two_sides() -> None:
    mesh = meshes.box([-0.03, -0.03, 0.0], [0.03, 0.03, 0.0015]).subdivide_to_size(0.01)
    vertices, faces = meshes.arrays(mesh)
    field = mesh_field("sheet", ExactDistance(vertices, faces))
    points = np.array([[0.01, 0.0, 0.0], [0.01, 0.0, 0.0015]])
    np.testing.assert_allclose(field_normals(field, points)[0], [[0, 0, -1], [0, 0, 1]], atol=1e-3)
    np.testing.assert_allclose(field_distances(field, points)[0], 0.0, atol=5e-5)


@pytest.mark.parametrize("size", [(1.0, 0.4, 0.2), (0.13, 0.13, 0.13), (0.5, 0.5, 0.001)])
def test_what_is_kept_stays_small(
    size: tuple[float, float, float], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A large body has a coarser lattice: no more than 30 MB."""
    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path))
    half = 0.5 * np.array(size)
    vertices, faces = meshes.arrays(meshes.box(-half, half))
    field = mesh_field("large", ExactDistance(vertices, faces))
    [file] = (cache_folder() / "fields").iterdir()
    assert 15e6 < file.stat().st_size < 30e6
    points = half * [[1.0, 0.5, 0.3], [0.4, -1.0, 0.0]]
    np.testing.assert_allclose(field_distances(field, points)[0], 0.0, atol=2e-4)


@pytest.mark.parametrize("name", THINGS)
def test_next_to_the_surface_nodes_are_exact(name: str) -> None:
    """Those within four spacings."""
    _, exact, field = thing(name)
    counts = np.array(field.distance.coefficients.shape)
    compare_nodes(field, exact, np.random.default_rng(0).integers(1, counts - 1, (100_000, 3)), least=1000)


def test_nodes_are_exact_however_wrong_the_coarse_spline_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """In narrow gaps it may be millimetres above the distance."""
    _, exact, _ = thing("mug")
    path = "pinograsp.geometry.distance_field.coarse_values"
    monkeypatch.setattr(path, lambda *lattice: 0.03 + coarse_values(*lattice))
    field = distance_field(exact, 0.002)
    counts = np.array(field.distance.coefficients.shape)
    compare_nodes(field, exact, np.random.default_rng(0).integers(1, counts - 1, (100_000, 3)), least=1000)


def compare_nodes(field: DistanceField, exact: ExactDistance, which: Array, least: int) -> None:
    """Compare the field at some nodes of the fine lattice, those next to the surface, with exact distances."""
    places = field.distance.origin + field.distance.spacing * which
    true = exact.signed(places)
    near = np.abs(true) < EXACT * field.distance.spacing
    assert near.sum() >= least
    np.testing.assert_allclose(field_distances(field, places[near])[0], true[near], atol=2e-7)


def test_the_coarse_lattice_leads_away_from_the_body_to_its_end() -> None:
    """What is assumed beyond its border does not show in the slopes: all around a ball they are radial."""
    vertices, faces = meshes.arrays(meshes.ball(0.03, 4))
    field = mesh_field("fine ball", ExactDistance(vertices, faces))
    low = field.coarse.origin + field.coarse.spacing
    high = field.coarse.origin + field.coarse.spacing * (np.array(field.coarse.coefficients.shape) - 2)
    rng = np.random.default_rng(0)
    points, ends = rng.uniform(low, high, (600, 3)), np.arange(600)
    points[ends, ends % 3] = np.where(ends % 2, high[ends % 3] - 1e-9, low[ends % 3] + 1e-9)
    radii = np.linalg.norm(points, axis=1)[:, None]
    distances, gradients, _ = field_distances(field, points)
    np.testing.assert_allclose(distances, radii[:, 0] - 0.03, atol=1e-4)
    np.testing.assert_allclose(gradients, points / radii, atol=7e-3)  # facets of a degree


def test_fields_are_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """By content: a second field comes from the file, a damaged file is made again."""
    monkeypatch.setenv("PINOGRASP_CACHE", str(tmp_path))
    vertices, faces = meshes.arrays(meshes.ball(0.01, 2))
    first = mesh_field("ball", ExactDistance(vertices, faces))
    [file] = (cache_folder() / "fields").iterdir()
    before = file.read_bytes()
    second = mesh_field("ball", ExactDistance(vertices, faces))
    for one, other in zip(first[:3], second[:3], strict=True):
        np.testing.assert_array_equal(one.coefficients, other.coefficients)
    assert first.error == second.error
    mesh_field("ball", ExactDistance(1.1 * vertices, faces))
    assert len(list((cache_folder() / "fields").iterdir())) == 2
    file.write_bytes(before[:1000])
    np.testing.assert_array_equal(
        mesh_field("ball", ExactDistance(vertices, faces)).distance.coefficients, first.distance.coefficients
    )


@pytest.mark.parametrize("name", THINGS)
def test_the_nearest_of_many_points_is_found(name: str) -> None:
    """As if every point were asked, for bodies near and far, apart and in each other: the nearer, the more exactly."""
    mesh, _, field = thing(name)
    rng = np.random.default_rng(0)
    sets = [
        rng.uniform(-0.03, 0.03, (count, 3)) * size for count, size in ((1, 1.0), (7, 0.2), (300, 1.0), (2000, 3.0))
    ]
    trees, bounds = point_trees(sets, [0, 1, 2, 3]), bounds_of(field.distance, field.above, APART)
    rotations = np.array([np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in sets])
    for _ in range(20):
        translations = mesh.centroid + rng.normal(scale=0.06, size=(len(sets), 3))
        caps = np.array([0.05, 0.09, 0.02, 0.03])
        least = rng.uniform(-0.01, 0.01, len(sets))
        indices, values, nearest, gradients = nearest_points(trees, field, bounds, rotations, translations, least, caps)
        assert (values < caps[indices]).all()
        found = dict(zip(indices.tolist(), values.tolist(), strict=True))
        for i, points in enumerate(sets):
            distances = field_distances(field, points @ rotations[i].T + translations[i])[0]
            value, true = found.get(i, caps[i]), min(distances.min(), caps[i])
            assert near_enough(value, least[i]) - 1e-9 < true < value + 1e-9
        again, slopes, _ = field_distances(field, nearest)
        np.testing.assert_allclose(again, values, atol=1e-12)
        np.testing.assert_allclose(slopes, gradients, atol=1e-12)


@pytest.mark.parametrize("name", THINGS)
def test_bounds_lie_below_the_distance_and_next_to_it_near_the_surface(name: str) -> None:
    """They always lie below the spline; below the distance where it counts."""
    mesh, exact, field = thing(name)
    bounds = bounds_of(field.distance, field.above, APART)
    points = np.concatenate(
        [
            np.random.default_rng(0).uniform(mesh.bounds[0], mesh.bounds[1], (3000, 3)),
            on_surface(mesh, 3000)[0] + np.random.default_rng(1).normal(scale=0.001, size=(3000, 3)),
        ]
    )
    steps = (points - bounds.origin) / bounds.spacing
    cells = np.rint(steps).astype(int)
    linear = bounds.values[tuple(cells.T)].astype(float)
    below = linear[:, 0] + bounds.spacing * (linear[:, 1:] * (steps - cells)).sum(axis=1)
    true = exact.signed(points)
    assert (below <= field_distances(field, points)[0] + 1e-9).all()
    assert (below <= true + 1e-4)[true > -0.005].all()  # deeper inside the spline of the coarse lattice is no better
    near = np.abs(true) < 0.002
    assert np.median((true - below)[near]) < 0.5 * bounds.spacing


def test_distances_are_the_more_exact_the_nearer_they_are_to_what_is_wanted() -> None:
    """Below it, a tenth of the difference, a fifth of 10 mm, and never more than four tenths of it; most above it."""
    for apart, missed in ((0.0, 0.0), (0.0001, 0.0000101), (0.01, 0.002), (0.03, 0.012), (0.1, 0.04)):
        assert 0.005 - apart - near_enough(0.005 - apart, 0.005) == pytest.approx(missed)
        assert near_enough(0.005 + apart, 0.005) == pytest.approx(0.005 + 0.3 * apart)


def test_the_deepest_point_in_a_solid_is_found() -> None:
    """As if every point and facet were asked, for solids that hold some of the points, and none."""
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.05, 0.05, (2000, 3))
    trees = point_trees([points], [0])
    for scale in (0.01, 0.03, 0.1):
        hull = Hull(rng.normal(size=(30, 3)) * scale + rng.normal(scale=0.05, size=3))
        depth, point, facet = deepest_point(trees, hull.normals, hull.offsets)
        beyond = points @ hull.normals.T - hull.offsets
        assert depth == pytest.approx(beyond.max(axis=1).min())
        assert point in points
        assert point @ hull.normals[facet] - hull.offsets[facet] == pytest.approx(depth)


def test_faces_inside_overlapping_parts_are_no_surface() -> None:
    """Two boxes that overlap: the depth in the middle is that below the outer faces."""
    boxes = [trimesh.creation.box((0.04, 0.03, 0.03)) for _ in range(2)]
    boxes[1].apply_translation([0.02, 0.0, 0.0])
    both = trimesh.util.concatenate(boxes).subdivide().subdivide()
    vertices, faces = np.array(both.vertices), np.array(both.faces)
    places = vertices[faces].mean(axis=1)[:, 0]
    inner = (np.abs(places - 0.02) < 1e-9) | (np.abs(places) < 1e-9)  # the end of each box is in the other one
    exact = ExactDistance(vertices, faces, ~inner)
    middle = np.array([[0.019, 0.0, 0.0], [0.001, 0.0, 0.0]])
    np.testing.assert_allclose(exact.signed(middle), -0.015, atol=1e-9)
    assert ExactDistance(vertices, faces).signed(middle).max() > -0.0011
    np.testing.assert_allclose(field_distances(mesh_field("boxes", exact), middle)[0], -0.015, atol=2e-3)
