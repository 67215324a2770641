"""Shapes as they stand in a scene file: one class a shape, registered in `SHAPES`.

A shape also has its geometry, registered in `pinograsp.geometry.shapes.SURFACES`, and the independent one of the
verification, in `pinograsp.verification.shapes.GEOMETRY`. Nothing else knows which shapes there are.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, model_validator

from .kinds import Kinds
from .model import Frozen
from .pose import ZERO
from .values import NotNegative, Positive, listed, wrong


class ShapeDescription(Frozen):
    """A convex shape in its own frame; each class narrows `type` to its name."""

    type: str

    @property
    def centroid(self) -> tuple[float, float, float]:
        """Centre of mass of the shape filled evenly, in its own frame, m."""
        return ZERO


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

    @property
    def centroid(self) -> tuple[float, float, float]:
        """Centre of mass of the cone filled evenly: on the axis, towards the wider end, m."""
        wider = max(self.bottom_radius, self.top_radius)
        bottom, top = self.bottom_radius / wider, self.top_radius / wider
        return 0.0, 0.0, 0.25 * self.height * (top**2 - bottom**2) / (bottom**2 + bottom * top + top**2)


class Ellipsoid(ShapeDescription):
    """A ball stretched along the axes of its frame, centred at the origin; semi-axes in m."""

    type: Literal["ellipsoid"] = "ellipsoid"
    semi_axes: Annotated[tuple[Positive, Positive, Positive], BeforeValidator(listed)]
    """Along x, y, z, m."""


SHAPES = Kinds(Sphere, Box, Cylinder, Capsule, Cone, Ellipsoid)
"""Every shape that a scene file may have."""

Shape = Annotated[ShapeDescription, SHAPES]
