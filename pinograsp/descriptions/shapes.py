"""Shapes as they stand in a scene file: one class a shape, registered in `SHAPES`.

A shape also has its geometry, registered in `pinograsp.geometry.shapes.SURFACES`, and the independent one of the
verification, in `pinograsp.verification.shapes.GEOMETRY`. Nothing else knows which shapes there are.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator

from .kinds import Kinds
from .model import Frozen
from .values import Positive, listed


class ShapeDescription(Frozen):
    """A convex shape in its own frame; each class narrows `type` to its name."""

    type: str


class Sphere(ShapeDescription):
    """A ball around the origin of its frame; its radius in m."""

    type: Literal["sphere"] = "sphere"
    radius: Positive
    """m."""


class Box(ShapeDescription):
    """A box centred at the origin of its frame, edges along its axes."""

    type: Literal["box"] = "box"
    size: Annotated[tuple[Positive, Positive, Positive], BeforeValidator(listed)]
    """Edge lengths along x, y, z, m."""


class Cylinder(ShapeDescription):
    """A cylinder around the z axis of its frame, centred at the origin; radius and height in m."""

    type: Literal["cylinder"] = "cylinder"
    radius: Positive
    """m."""
    height: Positive
    """Along z, m."""


SHAPES = Kinds(Sphere, Box, Cylinder)
"""Every shape that a scene file may have."""

Shape = Annotated[ShapeDescription, SHAPES]
