"""Shapes as they stand in a scene file: one class a shape, registered in `SHAPES`.

A shape also has its geometry, registered in `pinograsp.geometry.shapes.SURFACES`, and the independent one of the
verification, in `pinograsp.verification.shapes.GEOMETRY`. Nothing else knows which shapes there are.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from .kinds import Kinds
from .mesh_files import MeshAddress, MeshFile
from .model import Frozen
from .pose import Pose
from .values import Size, SizeOrNone, Sizes3, listed, wrong

if TYPE_CHECKING:
    from .filled_mesh import Filled


class ShapeDescription(Frozen):
    """A shape in its own frame; each class narrows `type` to its name."""

    type: str

    @property
    def centroid(self) -> tuple[float, float, float]:
        """Centre of mass of the shape filled evenly, in its own frame, m."""
        return 0.0, 0.0, 0.0

    @property
    def volume(self) -> float:
        """m^3."""
        raise NotImplementedError(f"the shape {self.type} has no volume")


class Sphere(ShapeDescription):
    """A ball around the origin of its frame; its radius in m."""

    type: Literal["sphere"] = "sphere"
    radius: Size
    """m."""

    @property
    def volume(self) -> float:
        """m^3."""
        return 4.0 / 3.0 * math.pi * self.radius**3


class Box(ShapeDescription):
    """A box centred at the origin of its frame, edges along its axes."""

    type: Literal["box"] = "box"
    size: Sizes3
    """Edge lengths along x, y, z, m."""

    @property
    def volume(self) -> float:
        """m^3."""
        return math.prod(self.size)


class Cylinder(ShapeDescription):
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


class Capsule(ShapeDescription):
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


class Cone(ShapeDescription):
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


class Ellipsoid(ShapeDescription):
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

    @property
    def centroid(self) -> tuple[float, float, float]:
        """Centre of mass of the body filled evenly, m; the file is read when it is first asked.

        Raises:
            FileError: the file cannot be read, is not that which was described, or encloses nothing.
        """
        return self._filled.centroid

    @property
    def volume(self) -> float:
        """m^3; what parts of the body share counts in each of them. Errors as of `centroid`."""
        return self._filled.volume

    @cached_property
    def _filled(self) -> Filled:
        from .filled_mesh import filled  # which needs more time to import than all of the descriptions

        return filled(self)


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

    @property
    def volume(self) -> float:
        """m^3; what parts share counts in each of them."""
        return sum(part.shape.volume for part in self.parts)

    @property
    def centroid(self) -> tuple[float, float, float]:
        """Centre of mass of the parts filled evenly, in the compound's frame, m; what they share counts in each."""
        sums = [0.0, 0.0, 0.0]
        for part in self.parts:
            T, share = part.pose.matrix, part.shape.volume / self.volume
            for axis in range(3):
                turned = sum(T[axis, k] * part.shape.centroid[k] for k in range(3))
                sums[axis] += share * float(turned + T[axis, 3])
        return sums[0], sums[1], sums[2]


SHAPES.add(Compound)
