"""Triangles as files have them, made into bodies by both sides: turned, doubled, seen from both sides, nested."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from pinograsp.arrays import Array, Integers
from pinograsp.descriptions.shapes import Mesh
from pinograsp.geometry import object_mesh as of_optimiser
from pinograsp.verification.mended import mended
from pinograsp.verification.object_mesh import object_mesh

Made = tuple[Array, Integers]
BAR = np.array([0.1, 0.02, 0.02])


def box(size: Array, x: float = 0.0, *, inverted: bool = False) -> trimesh.Trimesh:
    made = trimesh.creation.box(size).apply_translation((x, 0.0, 0.0))
    if inverted:
        made.invert()
    return made


def all_of(*parts: trimesh.Trimesh) -> Made:
    whole = trimesh.util.concatenate(parts)
    return np.array(whole.vertices), np.array(whole.faces)


def dumb_bell(*, inverted: bool = False, twice: bool = False) -> Made:
    ends = [box(np.array([0.03, 0.04, 0.04]), x, inverted=inverted and x > 0.0) for x in (-0.06, 0.06)]
    return all_of(box(BAR), *ends, *(ends[:1] if twice else []))


def flipped(*numbers: int) -> Made:
    vertices, faces = all_of(box(np.array([0.05, 0.04, 0.06])))
    chosen = np.array(numbers)
    faces[chosen] = faces[chosen, ::-1]
    return vertices, faces


def from_both_sides(whole: Made) -> Made:
    vertices, faces = whole
    return vertices, np.concatenate([faces, faces[:, ::-1]])


def hollow(outer: bool, inner: bool) -> Made:
    return all_of(box(np.full(3, 0.06), inverted=outer), box(np.full(3, 0.03), inverted=inner))


def sharing() -> Made:
    """A box within another one, which has an end of it in common: the end's triangles are there twice."""
    vertices, faces = all_of(box(BAR))
    within = vertices * [0.5, 1.0, 1.0] + [0.025, 0.0, 0.0]
    both = np.concatenate([vertices, within])
    kept, numbers = np.unique(both.round(9), axis=0, return_inverse=True)
    return kept, numbers.ravel()[np.concatenate([faces, faces + len(vertices)])]


def doubled_triangle() -> Made:
    vertices, faces = all_of(box(BAR))
    return vertices, np.concatenate([faces, faces[3:4]])


WHOLE = float(BAR.prod() + 2 * 0.03 * 0.04**2 - 2 * 0.005 * 0.02**2)
"""Of the dumb-bell: its bar is 5 mm in each of its ends."""
KINDS: dict[str, tuple[Callable[[], Made], float]] = {
    "a part inside out": (lambda: dumb_bell(inverted=True), WHOLE),
    "a part twice": (lambda: dumb_bell(twice=True), WHOLE),
    "all from both sides": (lambda: from_both_sides(all_of(box(BAR))), float(BAR.prod())),
    "one triangle flipped": (lambda: flipped(4), 1.2e-4),
    "every second one flipped": (lambda: flipped(0, 2, 4, 6, 8, 10), 1.2e-4),
    "one triangle twice": (doubled_triangle, float(BAR.prod())),
    "a cavity": (lambda: hollow(False, True), 0.06**3 - 0.03**3),
    "a hollow body inside out": (lambda: hollow(True, False), 0.06**3 - 0.03**3),
    "a solid in a solid": (lambda: hollow(False, False), 0.06**3),
    "both inside out": (lambda: hollow(True, True), 0.06**3),
    "a shared face": (sharing, float(BAR.prod())),
}


def file_of(folder: Path, made: Made) -> Mesh:
    file = folder / "body.obj"
    vertices, faces = made
    lines = [*("v {:.9f} {:.9f} {:.9f}".format(*v) for v in vertices), *("f {} {} {}".format(*(f + 1)) for f in faces)]
    file.write_text("\n".join(lines))
    return Mesh(file=file)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_enclosed(kind: str, tmp_path: Path) -> None:
    make, volume = KINDS[kind]
    body = object_mesh(file_of(tmp_path, make()))
    assert body.filled.volume == pytest.approx(volume, rel=2e-3)
    points = np.random.default_rng(0).uniform(-0.08, 0.08, (20_000, 3))
    inside = body.distances(points) < 0.0
    assert inside.mean() * 0.16**3 == pytest.approx(volume, rel=0.2)
    np.testing.assert_array_equal(inside, body.contains(points))


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in {"a hollow body inside out", "a shared face"}])
def test_both_sides_take_it_alike(kind: str, tmp_path: Path) -> None:
    shape = file_of(tmp_path, KINDS[kind][0]())
    own, other = object_mesh(shape), of_optimiser.object_mesh(shape)
    from pinograsp.geometry.winding import Winding

    points = np.random.default_rng(1).uniform(-0.08, 0.08, (5_000, 3))
    told = Winding(other.vertices, other.faces).numbers(points) > 0.5
    np.testing.assert_array_equal(own.contains(points), told)


def test_what_is_in_order_stays_as_it_is() -> None:
    vertices, faces = dumb_bell()
    assert mended(vertices, faces) is faces
