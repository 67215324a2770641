"""Patches: the surfaces of finger links where contact is wanted, in the link's frame.

A patch has a frame (x, y, normal) at its origin, normal = outward, away from the finger, and one or two contact
parameters u, v:

    plane       origin + u x + v y
    line        origin + u x                       a plane patch without width: one parameter
    cylinder    around x through the origin: u along x, v the angle from the normal towards y
    sphere      around the origin: u the angle from the normal towards x, v from there towards y
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from ..arrays import Array
from ..frozen import frozen
from .model import Frozen
from .values import Interval, NotNegative, Positive, Vector3, ordered, wrong


class _Framed(Frozen):
    """A patch frame in the link's frame."""

    origin: Vector3
    """Origin of the patch frame in the link's frame, m."""
    normal: Vector3
    """Outward: away from the finger, towards the object."""
    x_axis: Vector3
    """Direction of the first contact parameter in the link's frame, length 1, perpendicular to the normal."""
    u: Interval
    """Range of the first contact parameter, m (sphere: rad)."""

    @field_validator("u", "v", check_fields=False)
    @classmethod
    def _ordered(cls, value: Interval) -> Interval:
        return ordered(value)

    @model_validator(mode="after")
    def _frame(self) -> _Framed:
        for name in ("normal", "x_axis"):
            length = float(np.linalg.norm(getattr(self, name)))
            if abs(length - 1.0) > 1e-6:
                raise wrong(f"must have length 1 (it has {length:.7g})", name)
        if abs(np.dot(self.normal, self.x_axis)) > 1e-6:
            raise wrong("must be perpendicular to normal", "x_axis")
        return self

    @cached_property
    def rotation(self) -> Array:
        """Rotation (3, 3) of the patch frame in the link frame; columns x, y, normal."""
        normal = np.array(self.normal) / np.linalg.norm(self.normal)  # a file gives a few digits
        x_axis = np.array(self.x_axis) - np.dot(self.x_axis, normal) * normal
        x_axis /= np.linalg.norm(x_axis)
        return np.asarray(frozen(np.column_stack([x_axis, np.cross(normal, x_axis), normal])))

    @property
    def parameters(self) -> tuple[Interval, ...]:
        """Ranges of the contact parameters."""
        second: Any = getattr(self, "v", None)
        return (self.u,) if second is None else (self.u, second)


class PlanePatch(_Framed):
    """A rectangle."""

    type: Literal["plane"] = "plane"
    v: Interval
    """Range of the second contact parameter, along normal cross x_axis, m."""


class LinePatch(_Framed):
    """A segment of a flat face: contact is wanted on the segment, and the face is tangent to the object there."""

    type: Literal["line"] = "line"
    width: NotNegative = 0.0
    """Of the face, half to each side of the segment: so far across it the footprint of a contact reaches, m."""


class CylinderPatch(_Framed):
    """A part of a cylinder's side."""

    type: Literal["cylinder"] = "cylinder"
    radius: Positive
    """m."""
    v: Interval
    """Range of the angle about the axis, rad, within -pi .. pi."""

    @field_validator("v")
    @classmethod
    def _within_turn(cls, value: Interval) -> Interval:
        return _within(value, math.pi, "pi")


class SpherePatch(_Framed):
    """A part of a sphere."""

    type: Literal["sphere"] = "sphere"
    radius: Positive
    """m."""
    v: Interval
    """Range of the second angle, rad, within -1.5 .. 1.5 (its poles have no direction)."""

    @field_validator("u")
    @classmethod
    def _within_turn(cls, value: Interval) -> Interval:
        return _within(value, math.pi, "pi")

    @field_validator("v")
    @classmethod
    def _off_the_poles(cls, value: Interval) -> Interval:
        return _within(value, 1.5, "1.5")


Patch = Annotated[PlanePatch | LinePatch | CylinderPatch | SpherePatch, Field(discriminator="type")]


def _within(value: Interval, most: float, name: str) -> Interval:
    if max(abs(end) for end in value) > most + 1e-9:
        raise wrong(f"the angles must be within -{name} .. {name}")
    return value
