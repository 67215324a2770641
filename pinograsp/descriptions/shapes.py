"""Shapes as they stand in a scene file: one class a shape, registered in `SHAPES`.

A shape also has its geometry, registered in `pinograsp.geometry.shapes.SURFACES`, and the independent one of the
verification, in `pinograsp.verification.shapes.GEOMETRY`. Nothing else knows which shapes there are.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .files import Frozen, Number
from .kinds import Kinds

Length = Annotated[Number, Field(gt=0.0)]


class ShapeDescription(Frozen):
    """A convex shape in its own frame; each class narrows `type` to its name."""

    type: str


class Sphere(ShapeDescription):
    """A ball around the origin of its frame; its radius in m."""

    type: Literal["sphere"]
    radius: Length


class Box(ShapeDescription):
    """A box centred at the origin of its frame, edges along its axes."""

    type: Literal["box"]
    size: tuple[Length, Length, Length]
    """Edge lengths along x, y, z, m."""


class Cylinder(ShapeDescription):
    """A cylinder around the z axis of its frame, centred at the origin; radius and height in m."""

    type: Literal["cylinder"]
    radius: Length
    height: Length


SHAPES = Kinds(Sphere, Box, Cylinder)
"""Every shape that a scene file may have."""

Shape = Annotated[ShapeDescription, SHAPES]
