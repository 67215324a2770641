"""The object as a rigid body of MuJoCo: one entry a shape, registered in `BODIES`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..descriptions import Scene, Task
from ..descriptions.shapes import (
    Box,
    Capsule,
    Compound,
    Cone,
    Cylinder,
    Ellipsoid,
    Mesh,
    Part,
    ShapeDescription,
    Sphere,
)
from ..errors import InputError, TaskError
from ..geometry.filled import filled
from ..geometry.shapes import surface_of
from .drive import numbers
from .object_pieces import filled_inertia, object_pieces


class ObjectBody(NamedTuple):
    """A shape in its own frame."""

    geoms: tuple[dict[str, str], ...]
    """Attributes of the <geom> of each of its parts that MuJoCo knows."""
    pieces: tuple[Array, ...]
    """Vertices of the convex pieces of its other parts, each of shape (k, 3), m."""
    inertia: Array
    """Inertia of the solid about its centre per mass, m^2, shape (3, 3)."""


class _Solid(NamedTuple):
    """A shape of one part in its frame."""

    geom: dict[str, str]
    """Empty if it is pieces."""
    inertia: Array
    """About its centroid per mass, m^2, shape (3, 3)."""
    pieces: tuple[Array, ...] = ()
    """Vertices of convex pieces, each of shape (k, 3), m."""


def _sphere(shape: Sphere) -> _Solid:
    return _Solid({"type": "sphere", "size": f"{shape.radius!r}"}, 0.4 * shape.radius**2 * np.eye(3))


def _box(shape: Box) -> _Solid:
    squares = np.square(shape.size)
    half = " ".join(repr(edge / 2) for edge in shape.size)
    return _Solid({"type": "box", "size": half}, np.diag(squares.sum() - squares) / 12)


def _cylinder(shape: Cylinder) -> _Solid:
    across, along = shape.radius**2 / 2, shape.radius**2 / 4 + shape.height**2 / 12
    size = f"{shape.radius!r} {shape.height / 2!r}"
    return _Solid({"type": "cylinder", "size": size}, np.diag([along, along, across]))


def _capsule(shape: Capsule) -> _Solid:
    r, l = shape.radius, shape.length  # noqa: E741
    rod = l / (l + 4.0 / 3.0 * r)
    ends = 1.0 - rod
    across = rod * r**2 / 2 + ends * 0.4 * r**2
    along = rod * (r**2 / 4 + l**2 / 12) + ends * (0.4 * r**2 + l**2 / 4 + 3.0 / 8.0 * r * l)
    return _Solid({"type": "capsule", "size": f"{r!r} {l / 2!r}"}, np.diag([along, along, across]))


def _ellipsoid(shape: Ellipsoid) -> _Solid:
    squares = np.square(shape.semi_axes)
    return _Solid(
        {"type": "ellipsoid", "size": " ".join(map(repr, shape.semi_axes))}, np.diag(squares.sum() - squares) / 5
    )


def _cone(shape: Cone) -> _Solid:
    # Slices at heights z with radii r: what is integrated is of degree 4 in z, which 3 Gauss points do exactly.
    t, w = np.polynomial.legendre.leggauss(3)
    z = 0.5 * shape.height * t
    radii = shape.bottom_radius + (shape.top_radius - shape.bottom_radius) * (0.5 + 0.5 * t)
    shares = w * radii**2 / (w @ radii**2)
    across = float(shares @ radii**2) / 2
    along = across / 2 + float(shares @ (z - shape.centroid[2]) ** 2)
    return _Solid({}, np.diag([along, along, across]), (surface_of(shape).tessellation().vertices,))


def _mesh(shape: Mesh) -> _Solid:
    return _Solid({}, filled_inertia(shape), object_pieces(shape))


BODIES: dict[type[ShapeDescription], Callable[[Any], _Solid]] = {
    Sphere: _sphere,
    Box: _box,
    Cylinder: _cylinder,
    Capsule: _capsule,
    Ellipsoid: _ellipsoid,
    Cone: _cone,
    Mesh: _mesh,
}
"""The solid of each described shape of one part, made from its description. A new shape is registered here."""


def object_body(name: str, shape: ShapeDescription) -> ObjectBody:
    """Return the body of a shape; of a compound what parts share counts in each of them for the inertia.

    Raises:
        InputError: the hold test has none for shapes of this type, or the file of a mesh is gone or has changed.
    """
    parts = shape.parts if isinstance(shape, Compound) else (Part(shape=shape),)
    solids = [(_solid(name, part.shape), part.pose.matrix) for part in parts]
    each = [filled(part.shape) for part in parts]
    center, inertia = filled(shape).centroid, np.zeros((3, 3))
    volume = sum(of.volume for of in each)
    for of, (solid, T) in zip(each, solids, strict=True):
        R = T[:3, :3]
        arm = R @ of.centroid + T[:3, 3] - center
        turned = R @ solid.inertia @ R.T + arm @ arm * np.eye(3) - np.outer(arm, arm)
        inertia += of.volume / volume * turned
    geoms = tuple(solid.geom | placed(T) for solid, T in solids if solid.geom)
    pieces = tuple(piece @ T[:3, :3].T + T[:3, 3] for solid, T in solids for piece in solid.pieces)
    return ObjectBody(geoms, pieces, inertia)


def _solid(name: str, shape: ShapeDescription) -> _Solid:
    if type(shape) not in BODIES:
        known = ", ".join(kind.__name__.lower() for kind in BODIES)
        raise InputError(f"the hold test knows no {shape.type}, only {known}", key=f"objects.{name}.shape")
    return BODIES[type(shape)](shape)


def placed(T: Array) -> dict[str, str]:
    """Return the attributes of a pose, shape (4, 4)."""
    return {"pos": numbers(T[:3, 3]), "xyaxes": numbers([*T[:3, 0], *T[:3, 1]])}


def required_mass(scene: Scene, task: Task) -> float:
    """Return the mass of the object, kg.

    Raises:
        TaskError: the object has no mass, and the task no force, or the scene no gravity, that would tell.
    """
    mass = scene.mass_of(task)
    if mass is None:
        problem = "is not given, and the task has no external force, or the scene no gravity, that would tell"
        raise TaskError(problem, file=scene.source, key=f"objects.{task.object}.mass", remedy="Give it in kg")
    return mass
