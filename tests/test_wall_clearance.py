"""Distances of links to walls: exact, and of few pairs, since a link may have a hull of a million corners."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from pinograsp.arrays import Array
from pinograsp.descriptions.enclosure import Enclosure
from pinograsp.verification import clearance
from pinograsp.verification.clearance import CAP, Placed, enclosure_figure
from pinograsp.verification.link_mesh import LinkMesh
from pinograsp.verification.meshes import _link_mesh as link_mesh
from pinograsp.verification.pair_clearances import wall_clearances

WALLS = Enclosure(min=(0.0, -0.5, -0.5), max=(1.2, 0.5, 0.5)).walls


def links(count: int, rng: np.random.Generator) -> list[LinkMesh]:
    """Return links of random corners, whose frames are beside them."""
    made = []
    for number in range(count):
        corners = rng.uniform(-0.1, 0.1, (30, 3)) * rng.uniform(0.1, 1.0, 3) + rng.uniform(-0.1, 0.1, 3)
        made.append(link_mesh(f"link {number}", [trimesh.convex.convex_hull(corners)]))
    return made


def placed_at(meshes: list[LinkMesh], poses: list[Array]) -> Placed:
    return Placed({mesh.link: mesh for mesh in meshes}, {m.link: T for m, T in zip(meshes, poses, strict=True)})


def pose(rng: np.random.Generator) -> Array:
    T = np.eye(4)
    T[:3, :3] = Rotation.random(rng=rng).as_matrix()
    T[:3, 3] = rng.uniform(-0.2, 1.3), *rng.uniform(-0.6, 0.6, 2)  # outside of the walls, too
    return T


def of_every_corner(meshes: list[LinkMesh], placed: Placed) -> dict[tuple[str, str], float]:
    return {
        (mesh.link, wall): float((placed.to_world(mesh.link, mesh.vertices) @ inward - offset).min())
        for mesh in meshes
        for wall, (inward, offset) in WALLS.items()
    }


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_the_least_distance_is_that_of_all_corners_to_all_walls(seed: int) -> None:
    rng = np.random.default_rng(seed)
    meshes = links(int(rng.integers(1, 6)), rng)
    placed = placed_at(meshes, [pose(rng) for _ in meshes])
    wanted = of_every_corner(meshes, placed)
    figure = enclosure_figure(meshes, WALLS, placed, 0.005)
    assert figure.value == pytest.approx(min(wanted.values()), abs=1e-12)
    link, wall = figure.where.split(" / ")
    assert wanted[link, wall] == pytest.approx(figure.value, abs=1e-12)
    near = {(pair.link, pair.other): pair.distance for pair in wall_clearances(meshes, WALLS, placed)}
    assert near == pytest.approx({pair: d for pair, d in wanted.items() if d < CAP}, abs=1e-12)


def test_only_pairs_that_could_be_the_nearest_are_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten links above each other: of 60 pairs, one can be the least, and two are nearer than `CAP`."""
    measured: list[tuple[str, float]] = []
    exact = clearance.wall_distance

    def counted(mesh: LinkMesh, inward: Array, offset: float, placed: Placed) -> float:
        measured.append((mesh.link, offset))
        return exact(mesh, inward, offset, placed)

    monkeypatch.setattr(clearance, "wall_distance", counted)
    monkeypatch.setattr("pinograsp.verification.pair_clearances.wall_distance", counted)
    meshes = [link_mesh(f"link {i}", [trimesh.creation.icosphere(subdivisions=3, radius=0.02)]) for i in range(10)]
    poses = [np.eye(4) for _ in meshes]
    for i, T in enumerate(poses):
        T[:3, 3] = 0.6, 0.0, -0.45 + 0.08 * i
    placed = placed_at(meshes, poses)
    figure = enclosure_figure(meshes, WALLS, placed, 0.005)
    assert len(measured) == 1 and figure.value == pytest.approx(0.03, abs=1e-6)
    measured.clear()
    assert [pair.link for pair in wall_clearances(meshes, WALLS, placed)] == ["link 0"]
    assert len(measured) == 1
