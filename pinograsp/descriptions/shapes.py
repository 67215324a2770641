"""Shapes as they stand in a scene file: one class a shape, registered in `SHAPES`.

A shape also has its geometry, registered in `pinograsp.geometry.shapes.SURFACES`, and the independent one of the
verification, in `pinograsp.verification.shapes.GEOMETRY`. Nothing else knows which shapes there are.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from .kinds import Kinds
from .model import Frozen
from .pose import Pose
from .values import NotNegative, Positive, listed, wrong


class ShapeDescription(Frozen):
    """A shape in its own frame; each class narrows `type` to its name."""

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


class Capsule(ShapeDescription):
    """A ball swept along a part of the z axis of its frame, centred at the origin; radius and length in m."""

    type: Literal["capsule"] = "capsule"
    radius: Positive
    """m."""
    length: Positive
    """Between the centres of the two end balls, m."""


class Cone(ShapeDescription):
    """A cone around the z axis of its frame, whole or truncated; its height, along z, is centred at the origin."""

    type: Literal["cone"] = "cone"
    bottom_radius: NotNegative
    """At the lower end, m; 0 for a tip."""
    top_radius: NotNegative
    """At the upper end, m; 0 for a tip."""
    height: Positive
    """Along z, m."""

    @model_validator(mode="after")
    def _not_a_line(self) -> Cone:
        if self.bottom_radius == self.top_radius == 0.0:
            raise wrong("both radii are 0", "bottom_radius", remedy="Give one of them more")
        return self


class Ellipsoid(ShapeDescription):
    """A ball stretched along the axes of its frame, centred at the origin; semi-axes in m."""

    type: Literal["ellipsoid"] = "ellipsoid"
    semi_axes: Annotated[tuple[Positive, Positive, Positive], BeforeValidator(listed)]
    """Along x, y, z, m."""


SHAPES = Kinds(Sphere, Box, Cylinder, Capsule, Cone, Ellipsoid)
"""Every shape that a scene file may have."""

Shape = Annotated[ShapeDescription, SHAPES]


def _single(shape: ShapeDescription) -> ShapeDescription:
    if isinstance(shape, Compound):
        raise wrong("a compound cannot be part of another one", remedy="List its parts in the outer one")
    return shape


class Part(Frozen):
    """A part of a compound: a shape at a pose."""

    shape: Annotated[ShapeDescription, SHAPES.besides("compound"), AfterValidator(_single)]
    """In its own frame, m; no compound."""
    pose: Pose = Pose()
    """Of the shape's frame in the compound's, m and rad."""


class Compound(ShapeDescription):
    """All that is in one of several parts, which may overlap: a can with a lid and a handle, a dumb-bell."""

    type: Literal["compound"] = "compound"
    parts: Annotated[tuple[Part, ...], BeforeValidator(listed), Field(min_length=1)]
    """At least one, in the compound's frame."""


SHAPES.add(Compound)
