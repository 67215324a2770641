"""Shapes as they stand in a scene file: one class a shape, registered in `SHAPES`.

A shape also has its geometry, registered in `pinograsp.geometry.shapes.SURFACES`, and the independent one of the
verification, in `pinograsp.verification.shapes.GEOMETRY`. Nothing else knows which shapes there are.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from .kinds import Kinds
from .mesh_files import MeshAddress, MeshFile
from .model import Frozen
from .pose import Pose
from .values import Size, SizeOrNone, Sizes3, listed, wrong


class ShapeDescription(Frozen):
    """A shape in its own frame; each class narrows `type` to its name."""

    type: str


class FormulaShape(ShapeDescription):
    """A shape of one part that formulas describe."""

    @property
    def centroid(self) -> tuple[float, float, float]:
        """Centre of mass of the shape filled evenly, in its own frame, m."""
        return 0.0, 0.0, 0.0

    @property
    def volume(self) -> float:
        """m^3."""
        raise NotImplementedError(f"the shape {self.type} has no volume")


class Sphere(FormulaShape):
    """A ball around the origin of its frame; its radius in m."""

    type: Literal["sphere"] = "sphere"
    radius: Size
    """m."""

    @property
    def volume(self) -> float:
        """m^3."""
        return 4.0 / 3.0 * math.pi * self.radius**3


class Box(FormulaShape):
    """A box centred at the origin of its frame, edges along its axes."""

    type: Literal["box"] = "box"
    size: Sizes3
    """Edge lengths along x, y, z, m."""

    @property
    def volume(self) -> float:
        """m^3."""
        return math.prod(self.size)


class Cylinder(FormulaShape):
    """A cylinder around the z axis of its frame, centred at the origin; radius and height in m."""

    type: Literal["cylinder"] = "cylinder"
    radius: Size
    """m."""
    height: Size
    """Along z, m."""

    @property
    def volume(self) -> float:
        """m^3."""
        return math.pi * self.radius**2 * self.height


class Capsule(FormulaShape):
    """A ball swept along a part of the z axis of its frame, centred at the origin; radius and length in m."""

    type: Literal["capsule"] = "capsule"
    radius: Size
    """m."""
    length: Size
    """Between the centres of the two end balls, m."""

    @property
    def volume(self) -> float:
        """m^3."""
        return math.pi * self.radius**2 * (self.length + 4.0 / 3.0 * self.radius)


class Cone(FormulaShape):
    """A cone around the z axis of its frame, whole or truncated; its height, along z, is centred at the origin."""

    type: Literal["cone"] = "cone"
    bottom_radius: SizeOrNone
    """At the lower end, m; 0 for a tip."""
    top_radius: SizeOrNone
    """At the upper end, m; 0 for a tip."""
    height: Size
    """Along z, m."""

    @model_validator(mode="after")
    def _not_a_line(self) -> Cone:
        if self.bottom_radius == self.top_radius == 0.0:
            raise wrong("both radii are 0", "bottom_radius", remedy="Give one of them more")
        return self

    @property
    def volume(self) -> float:
        """m^3."""
        bottom, top = self.bottom_radius, self.top_radius
        return math.pi / 3.0 * self.height * (bottom**2 + bottom * top + top**2)

    @property
    def centroid(self) -> tuple[float, float, float]:
        """Centre of mass of the cone filled evenly: on the axis, towards the wider end, m."""
        wider = max(self.bottom_radius, self.top_radius)
        bottom, top = self.bottom_radius / wider, self.top_radius / wider
        return 0.0, 0.0, 0.25 * self.height * (top**2 - bottom**2) / (bottom**2 + bottom * top + top**2)


class Ellipsoid(FormulaShape):
    """A ball stretched along the axes of its frame, centred at the origin; semi-axes in m."""

    type: Literal["ellipsoid"] = "ellipsoid"
    semi_axes: Sizes3
    """Along x, y, z, m."""

    @property
    def volume(self) -> float:
        """m^3."""
        return 4.0 / 3.0 * math.pi * math.prod(self.semi_axes)


class Mesh(ShapeDescription, MeshFile):
    """The body that the triangles of a file enclose, in the frame of the file."""

    type: Literal["mesh"] = "mesh"
    file: MeshAddress
    """STL, OBJ, PLY, GLB, DAE or OFF; relative to the scene file, absolute or `package://`; absolute once read."""


SHAPES = Kinds(Sphere, Box, Cylinder, Capsule, Cone, Ellipsoid, Mesh)
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
