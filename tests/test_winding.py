"""Nearest triangles and winding numbers of the geometry, against libigl's."""

from __future__ import annotations

import igl
import numpy as np
import pytest
import trimesh
from meshes import ball, box

from pinograsp.arrays import Array, Integers
from pinograsp.geometry.in_threads import AT_ONCE
from pinograsp.geometry.triangle_tree import nearest, pieces, triangle_tree
from pinograsp.geometry.winding import FEW, WAYS, Winding, _way_tree


def _parts(mesh: trimesh.Trimesh) -> tuple[Array, Integers]:
    return np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64)


BODIES = {
    "one triangle": lambda: trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
    "box": lambda: box([-1, -1, -1], [1, 1, 1]),
    "ball": lambda: ball(1.0, subdivisions=3),
    "needles": lambda: trimesh.creation.cylinder(0.3, 2.0, sections=400),
    "two that overlap": lambda: trimesh.util.concatenate([ball(1.0), box([0, 0, 0], [1.5, 1.5, 1.5])]),
    "shell": lambda: trimesh.util.concatenate([ball(1.0), trimesh.Trimesh(*_inverted(ball(0.7)))]),
}


def _inverted(mesh: trimesh.Trimesh) -> tuple[Array, Integers]:
    vertices, faces = _parts(mesh)
    return vertices, faces[:, ::-1]


def _around(vertices: Array, rng: np.random.Generator) -> Array:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    lattice = np.stack(np.meshgrid(*np.linspace(low - 0.3, high + 0.3, 9).T, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.concatenate([rng.uniform(low - 0.5, high + 0.5, (2000, 3)), lattice])


@pytest.mark.parametrize("name", BODIES)
def test_nearest_triangles(name: str) -> None:
    vertices, faces = _parts(BODIES[name]())
    points = _around(vertices, np.random.default_rng(0))
    squares, _, _ = igl.point_mesh_squared_distance(points, vertices, faces)
    distances, numbers = nearest(triangle_tree(vertices, faces), points)
    np.testing.assert_allclose(distances, np.sqrt(squares), atol=1e-12)
    own = np.sqrt(
        [
            igl.point_mesh_squared_distance(p[None], vertices, faces[k : k + 1])[0][0]
            for p, k in zip(points, numbers, strict=True)
        ]
    )
    np.testing.assert_allclose(own, distances, atol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 7, 8, 9, 16, 17, 40, 64, 65, 129, 600])
def test_nearest_of_any_number_of_triangles(count: int) -> None:
    """However deep the tree is, and however many parts of its boxes are empty."""
    rng = np.random.default_rng(count)
    vertices = (rng.uniform(-1.0, 1.0, (count, 1, 3)) + 0.02 * rng.normal(size=(count, 3, 3))).reshape(-1, 3)
    faces, points = np.arange(3 * count).reshape(-1, 3), rng.uniform(-1.5, 1.5, (500, 3))
    squares, which, _ = igl.point_mesh_squared_distance(points, vertices, faces)
    distances, numbers = nearest(triangle_tree(vertices, faces), points)
    np.testing.assert_allclose(distances, np.sqrt(squares), atol=1e-12)
    np.testing.assert_array_equal(numbers, which)


@pytest.mark.parametrize("count", [FEW, FEW + 1, 3 * AT_ONCE + 1])
def test_winding_numbers_of_few_and_of_many_points(count: int) -> None:
    """Few are counted without a tree, many in several threads."""
    vertices, faces = _parts(ball(1.0, subdivisions=3))
    points = np.random.default_rng(0).uniform(-1.2, 1.2, (count, 3))
    radii = np.linalg.norm(points, axis=1)
    clear = np.abs(radii - 1.0) > 0.02
    np.testing.assert_array_equal(Winding(vertices, faces).numbers(points)[clear], radii[clear] < 1.0)


def test_the_number_of_cores_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not the last digit either."""
    vertices, faces = _parts(ball(1.0, subdivisions=3))
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (2 * AT_ONCE + 5, 3))
    found = []
    for cores in (1, 5):
        monkeypatch.setattr("pinograsp.threads._cores", lambda cores=cores: cores)
        found.append((*nearest(triangle_tree(vertices, faces), points), Winding(vertices, faces).numbers(points)))
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", [name for name in BODIES if name != "one triangle"])
def test_winding_numbers(name: str) -> None:
    """Also of points in the planes of triangles, on the ways through their corners and edges."""
    vertices, faces = _parts(BODIES[name]())
    points = _around(vertices, np.random.default_rng(0))
    points = points[nearest(triangle_tree(vertices, faces), points)[0] > 1e-6]
    np.testing.assert_allclose(
        Winding(vertices, faces).numbers(points), igl.winding_number(vertices, faces, points), atol=1e-7
    )


def test_winding_numbers_next_to_an_opening() -> None:
    """A ball without a cap, and with a slit: they change along the way by the solid angle of the opening."""
    vertices, faces = _parts(ball(1.0, subdivisions=3))
    faces = np.delete(faces[~(vertices[faces][:, :, 2] > 0.8).all(axis=1)], 100, axis=0)
    points = np.random.default_rng(0).uniform(-1.3, 1.3, (3000, 3))
    exact = igl.winding_number(vertices, faces, points)
    found = Winding(vertices, faces).numbers(points)
    assert np.abs(found - exact).max() < 0.1
    near = np.linalg.norm(points - [0.0, 0.0, 0.85], axis=1) < 0.8
    assert np.ptp(exact[near]) > 0.5
    np.testing.assert_allclose(found[near], exact[near], atol=0.01)


def test_ways_through_corners_and_edges() -> None:
    """Points from which the way goes through a corner, or the middle of an edge, exactly."""
    vertices, faces = _parts(box([-1, -1, -1], [1, 1, 1]))
    ends = np.concatenate([vertices, vertices[faces[:, [0, 1]]].mean(axis=1)])
    along = np.array([*WAYS[0], 1.0])
    points = np.concatenate([ends - share * along for share in (0.125, 0.25, 0.5, 4.0)])
    points = points[nearest(triangle_tree(vertices, faces), points)[0] > 1e-6]
    inside = (np.abs(points) < 1.0).all(axis=1)
    np.testing.assert_array_equal(Winding(vertices, faces).numbers(points), inside)


def _rod(sections: int) -> trimesh.Trimesh:
    """Return a cylinder along no axis, of radius 0.3 and length 0.8: all of its triangles are long and thin."""
    rod = trimesh.creation.cylinder(0.3, 0.8, sections=sections)
    return rod.apply_transform(trimesh.transformations.rotation_matrix(0.7, [1.0, 2.0, 0.5]))


@pytest.mark.parametrize("sections", [50, 400, 10_000])
def test_long_thin_triangles_have_few_pieces(sections: int) -> None:
    """Which are all of their triangles."""
    vertices, faces = _parts(_rod(sections))
    corners, owners = pieces(vertices, faces)
    assert len(faces) < len(corners) <= 2 * len(faces) + 100_000
    areas = np.bincount(owners, weights=trimesh.triangles.area(corners))
    np.testing.assert_allclose(areas, trimesh.triangles.area(vertices[faces]), rtol=1e-6)


def test_winding_numbers_of_a_body_of_long_thin_triangles() -> None:
    mesh = _rod(10_000)
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (20_000, 3))
    back = points @ trimesh.transformations.rotation_matrix(0.7, [1.0, 2.0, 0.5])[:3, :3]
    beyond = np.maximum(np.linalg.norm(back[:, :2], axis=1) - 0.3, np.abs(back[:, 2]) - 0.4)
    clear = np.abs(beyond) > 1e-6
    np.testing.assert_array_equal(Winding(*_parts(mesh)).numbers(points)[clear], beyond[clear] < 0.0)


def test_boxes_lie_along_long_thin_triangles() -> None:
    """Those that hold eight triangles of a fan, one in each part, are not much larger than these: few hold a point.

    Along the axes they would be hundreds of times as large.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, 8 * 1024 + 1)
    rim = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    corners = np.stack([np.zeros((8 * 1024, 3)), rim[:-1], rim[1:]], axis=1)
    tree = _way_tree(corners)
    sizes = tree.parts[-1024:, 3:5] - tree.parts[-1024:, :2]
    assert sizes.prod(axis=1).sum() < 6.0 * trimesh.triangles.area(corners).sum()
