"""The weight of an object."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import TaskError
from .task import Wrench
from .values import FARTHEST

if TYPE_CHECKING:
    from .scene import Scene


def weight_of(scene: Scene, name: str) -> Wrench:
    """Return the wrench on an object by its weight.

    Raises:
        TaskError: it has no mass, or the weight is out of range.
    """
    mass, key = scene.objects[name].mass, f"objects.{name}.mass"
    if mass is None:
        problem = f"no wrench is given, and object {name!r} has no mass that would weigh"
        raise TaskError(problem, file=scene.source, key=key, remedy=f"Give `{key}` in kg, or a wrench")
    x, y, z = (mass * g for g in scene.gravity)
    if max(abs(x), abs(y), abs(z)) > FARTHEST:
        remedy = f"Correct `{key}` (kg) or `gravity` (m/s^2)"
        raise TaskError(f"object {name!r} weighs more than {FARTHEST:g} N", file=scene.source, key=key, remedy=remedy)
    return Wrench(force=(x, y, z))
