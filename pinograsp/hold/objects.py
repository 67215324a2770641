"""The object as a rigid body of MuJoCo: one entry a shape, registered in `BODIES`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..descriptions import Scene, Task
from ..descriptions.shapes import Box, Cylinder, ShapeDescription, Sphere
from ..errors import InputError, TaskError


class ObjectBody(NamedTuple):
    """A shape in its own frame."""

    geom: dict[str, str]
    """Attributes of its <geom>."""
    inertia: Array
    """Diagonal of the inertia of the solid about its centre per mass, m^2, shape (3,)."""


def _sphere(shape: Sphere) -> ObjectBody:
    return ObjectBody({"type": "sphere", "size": f"{shape.radius!r}"}, np.full(3, 0.4 * shape.radius**2))


def _box(shape: Box) -> ObjectBody:
    squares = np.square(shape.size)
    half = " ".join(repr(edge / 2) for edge in shape.size)
    return ObjectBody({"type": "box", "size": half}, (squares.sum() - squares) / 12)


def _cylinder(shape: Cylinder) -> ObjectBody:
    across, along = shape.radius**2 / 2, shape.radius**2 / 4 + shape.height**2 / 12
    size = f"{shape.radius!r} {shape.height / 2!r}"
    return ObjectBody({"type": "cylinder", "size": size}, np.array([along, along, across]))


BODIES: dict[type[ShapeDescription], Callable[[Any], ObjectBody]] = {Sphere: _sphere, Box: _box, Cylinder: _cylinder}
"""The body of each described shape, made from its description. A new shape is registered here."""


def object_body(name: str, shape: ShapeDescription) -> ObjectBody:
    """Return the body of a shape.

    Raises:
        InputError: the hold test has none for shapes of this type.
    """
    if type(shape) not in BODIES:
        known = ", ".join(kind.__name__.lower() for kind in BODIES)
        raise InputError(f"the hold test knows no {shape.type}, only {known}", key=f"objects.{name}.shape")
    return BODIES[type(shape)](shape)


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
