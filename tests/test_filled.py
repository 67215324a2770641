"""Bodies filled evenly, by both sides: what parts share counts once, what is open is closed."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from pinograsp.arrays import Array
from pinograsp.descriptions.shapes import Box, Capsule, Compound, Cylinder, Mesh, ShapeDescription, Sphere
from pinograsp.geometry.filled import filled
from pinograsp.verification.shapes import geometry_of
from pinograsp.verification.shapes.filled import filled as filled_by_check

SIDES = (filled, lambda shape: filled_by_check(shape, geometry_of))


def mesh_of(folder: Path, *parts: trimesh.Trimesh) -> Mesh:
    file = folder / "body.ply"
    trimesh.util.concatenate(parts).export(file)
    return Mesh(file=file, largest_hole=0.07)


def box(size: tuple[float, float, float], x: float = 0.0) -> trimesh.Trimesh:
    return trimesh.creation.box(size).apply_translation((x, 0.0, 0.0))


def at(shape: ShapeDescription, x: float) -> dict[str, object]:
    return {"shape": shape, "pose": {"position": (x, 0.0, 0.0)}}


def open_cylinder() -> trimesh.Trimesh:
    """Without its upper cap."""
    whole = trimesh.creation.cylinder(0.03, 0.08)
    return trimesh.Trimesh(whole.vertices, whole.faces[whole.face_normals[:, 2] < 0.9])


def cup() -> trimesh.Trimesh:
    """A ball with an empty ball in it, off the middle."""
    outer, inner = trimesh.creation.icosphere(4, 0.03), trimesh.creation.icosphere(4, 0.01)
    inner.apply_translation((0.01, 0.0, 0.0)).invert()
    return trimesh.util.concatenate([outer, inner])


BOLT = (box((0.10, 0.02, 0.02)), box((0.02, 0.06, 0.06), 0.05))
"""Of 40 and 72 cm^3; what they share is 4 cm^3 around x = 45 mm."""
MESHES: dict[str, tuple[Callable[[], tuple[trimesh.Trimesh, ...]], float, Array]] = {
    "alone": (lambda: (box((0.05, 0.03, 0.02), 0.1),), 3e-5, np.array([0.1, 0.0, 0.0])),
    "overlapping": (lambda: BOLT, 1.08e-4, np.array([(72.0 * 0.05 - 4.0 * 0.045) / 108.0, 0.0, 0.0])),
    "inside": (lambda: (box((0.10, 0.02, 0.02)), box((0.05, 0.01, 0.01), 0.02)), 4e-5, np.zeros(3)),
    "open": (lambda: (open_cylinder(),), trimesh.creation.cylinder(0.03, 0.08).volume, np.zeros(3)),
    "hollow": (
        lambda: (cup(),),
        cup().volume,
        np.array([-0.01 / 26.0, 0.0, 0.0]),  # as of balls: the inner one has a 27th of the volume
    ),
}


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("of", SIDES, ids=["optimiser", "check"])
def test_meshes(of: Callable[[ShapeDescription], object], name: str, tmp_path: Path) -> None:
    parts, volume, centroid = MESHES[name]
    found = of(mesh_of(tmp_path, *parts()))
    exact = name not in {"overlapping", "inside"}
    assert found.volume == pytest.approx(volume, rel=1e-6 if exact else 2e-3)  # type: ignore[attr-defined]
    np.testing.assert_allclose(found.centroid, centroid, atol=1e-8 if exact else 3e-5)  # type: ignore[attr-defined]


@pytest.mark.parametrize("of", SIDES, ids=["optimiser", "check"])
def test_compounds(of: Callable[[ShapeDescription], object]) -> None:
    """Two balls with their centres a radius apart share 5/8 of a ball, in their middle; a rod through a can."""
    radius = 0.03
    ball = 4.0 / 3.0 * math.pi * radius**3
    twins = of(Compound(parts=(at(Sphere(radius=radius), 0.0), at(Sphere(radius=radius), radius))))
    assert twins.volume == pytest.approx(2.0 * ball - 5.0 / 16.0 * ball, rel=1e-3)  # type: ignore[attr-defined]
    np.testing.assert_allclose(twins.centroid, [radius / 2.0, 0.0, 0.0], atol=2e-5)  # type: ignore[attr-defined]
    bolt = of(Compound(parts=(at(Box(size=(0.10, 0.02, 0.02)), 0.0), at(Box(size=(0.02, 0.06, 0.06)), 0.05))))
    np.testing.assert_allclose(bolt.centroid, MESHES["overlapping"][2], atol=3e-5)  # type: ignore[attr-defined]
    apart = of(Compound(parts=(at(Box(size=(0.01, 0.01, 0.01)), 0.0), at(Box(size=(0.01, 0.01, 0.03)), 0.05))))
    np.testing.assert_allclose(apart.centroid, [0.0375, 0.0, 0.0], atol=1e-12)  # type: ignore[attr-defined]


def test_both_sides_say_the_same_of_a_can_and_a_handle() -> None:
    can = Compound(parts=(at(Cylinder(radius=0.033, height=0.1), 0.0), at(Capsule(radius=0.02, length=0.08), 0.02)))
    one, other = (of(can) for of in SIDES)
    np.testing.assert_allclose(one.centroid, other.centroid, atol=3e-5)  # type: ignore[attr-defined]
    np.testing.assert_allclose(one.centroid, [0.00235, 0.0, 0.0], atol=3e-5)  # type: ignore[attr-defined]
