"""Shapes as they stand in a scene file: one class a shape, registered in `Shape`.

The geometry of a shape is in `pinograsp.geometry.shapes`; the verification has its own.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .files import Frozen, Number

Length = Annotated[Number, Field(gt=0.0)]


class Sphere(Frozen):
    """A ball around the origin of its frame."""

    type: Literal["sphere"]
    radius: Length


class Box(Frozen):
    """A box centred at the origin of its frame, edges along its axes."""

    type: Literal["box"]
    size: tuple[Length, Length, Length]
    """Edge lengths along x, y, z."""


class Cylinder(Frozen):
    """A cylinder around the z axis of its frame, centred at the origin."""

    type: Literal["cylinder"]
    radius: Length
    height: Length


Shape = Annotated[Sphere | Box | Cylinder, Field(discriminator="type")]
