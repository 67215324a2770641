"""Points all over convex solids: one is near to every point, on the same facet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pinograsp.geometry.hull_points import hull_points, simplified, solid_points
from pinograsp.geometry.hulls import Hull, spread
from pinograsp.geometry.primitives import primitive_triangles

BOX = 0.5 * np.array([0.1, 0.04, 0.0007]) * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
ROUND = np.random.default_rng(0).normal(size=(400, 3))
VERTICES = {
    "box": BOX,
    "cylinder": primitive_triangles("cylinder", (0.02, 0.05)).reshape(-1, 3),
    "ball": 0.03 * ROUND / np.linalg.norm(ROUND, axis=1)[:, None],
    "needle": np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.1, 0.001, 0.0], [0.1, 0.0, 0.001]]),
}


@pytest.mark.parametrize("name", VERTICES)
@pytest.mark.parametrize("apart", [0.001, 0.004])
def test_a_point_is_near_on_the_same_facet(name: str, apart: float) -> None:
    hull = Hull(VERTICES[name])
    points = hull_points(hull, apart)
    assert np.abs(hull.outside(points)).max() < 1e-6
    on = points @ hull.normals.T > hull.offsets - 1e-6
    for i, triangle in enumerate(hull.triangles):
        some = spread(triangle[None], hull.areas[i : i + 1], 50)
        distances = np.linalg.norm(some[:, None] - points[on[:, i]], axis=2)
        assert distances.min(axis=1).max() < 1.001 * apart
    corners = hull.vertices
    assert np.linalg.norm(corners[:, None] - points, axis=2).min(axis=1).max() < 1e-12


def test_edges_have_points_of_their_own() -> None:
    """What is nearest on an edge has a point on that edge, though facets have nearer ones."""
    points = hull_points(Hull(BOX), 0.003)
    edge = points[(np.abs(points[:, 1] - 0.02) < 1e-9) & (np.abs(points[:, 2] - 0.00035) < 1e-9), 0]
    along = np.linspace(-0.05, 0.05, 500)
    assert np.abs(along[:, None] - edge).min(axis=1).max() <= 0.003 + 1e-9


def test_points_are_few() -> None:
    """About one for each square of a grid, though the facets of the cylinder are needles."""
    hull, _ = simplified(VERTICES["cylinder"], 4e-4)
    assert len(hull_points(hull, 0.004)) < 2.0 * hull.areas.sum() / 0.004**2


@pytest.mark.parametrize("name", VERTICES)
def test_a_simplified_hull_is_within_its_tolerance(name: str) -> None:
    vertices = VERTICES[name]
    hull, within = simplified(vertices, 3e-4)
    assert within <= 3e-4
    assert hull.outside(vertices).max() == pytest.approx(within, abs=1e-9)
    assert {tuple(corner) for corner in hull.vertices} <= {tuple(corner) for corner in vertices}
    if name == "ball":
        assert len(hull.vertices) < 0.8 * len(vertices)


def test_points_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is read again is what was made; other vertices and other distances have points of their own."""
    monkeypatch.setattr("pinograsp.array_cache.cache_folders", lambda: [tmp_path])
    monkeypatch.setattr("pinograsp.array_cache.in_cache", lambda write: write(tmp_path))
    hull, within = simplified(BOX, 1e-4)
    made = [solid_points(BOX, 0.003, 1e-4) for _ in range(2)]
    assert len(list((tmp_path / "points").iterdir())) == 1
    for points, beyond in made:
        np.testing.assert_array_equal(points, hull_points(hull, 0.003))
        assert beyond == within
    assert len(solid_points(BOX, 0.004, 1e-4)[0]) < len(made[0][0])
    np.testing.assert_allclose(solid_points(2.0 * BOX, 0.003, 1e-4)[0].max(axis=0), 2.0 * BOX.max(axis=0), atol=1e-12)
    assert len(list((tmp_path / "points").iterdir())) == 3
