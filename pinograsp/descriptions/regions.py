"""Regions of an object's surface as they stand in a scene file: where contact is allowed or forbidden.

All in the object's frame. A region is one of the shapes below or a combination of regions; the part of the surface
inside it is meant. Membership is smooth for the optimiser (`pinograsp.geometry.regions`) and exact in the verification.
"""

from __future__ import annotations

import math
import re
from functools import cached_property
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from ..errors import InputError
from .mesh_files import MeshAddress, MeshFile
from .model import Frozen
from .shapes import Mesh, ShapeDescription
from .values import Name, Number, OrderedInterval, Points, Positive, UnitVector3, Vector3, listed, wrong


class HalfSpace(Frozen):
    """Points p with normal . p >= offset; the normal has length 1."""

    type: Literal["half_space"] = "half_space"
    normal: UnitVector3
    """Length 1, into the half-space."""
    offset: Number
    """Of the plane from the origin along the normal, m."""


class Band(Frozen):
    """Points between two heights z: a ring of a cylinder's side, a zone of a sphere."""

    type: Literal["band"] = "band"
    z: OrderedInterval
    """Lower and upper height, m."""


class Sector(Frozen):
    """Points whose angle about z, from x towards y, is within `half_width` of `middle`."""

    type: Literal["sector"] = "sector"
    middle: Number
    """rad."""
    half_width: Annotated[Number, Field(gt=0.0, lt=math.pi)]
    """rad."""


class Ball(Frozen):
    """Points within `radius` of `center`, m."""

    type: Literal["ball"] = "ball"
    center: Vector3
    """m."""
    radius: Positive
    """m."""


class Cuboid(Frozen):
    """Points between two corners of a box, m, edges along the axes."""

    type: Literal["box"] = "box"
    min: Vector3
    """Corner of the least coordinates, m."""
    max: Vector3
    """Corner of the greatest coordinates, m."""


class Near(Frozen):
    """Points within `radius` of one of the `points`: contact where it is painted with a round brush."""

    type: Literal["near"] = "near"
    points: Points
    """m, shape (n, 3)."""
    radius: Positive
    """m."""

    @cached_property
    def balls(self) -> AnyOf:
        """The same region as balls."""
        return AnyOf(parts=tuple(Ball(center=point, radius=self.radius) for point in self.points))


COLORS_ALIKE = 16
"""Colours are one if no channel differs by more, of 255."""


def _channels(value: object) -> object:
    """Return a colour as HTML writes it, "#rrggbb", as three numbers."""
    if isinstance(value, str):
        if not re.fullmatch("#[0-9a-fA-F]{6}", value):
            raise wrong(f"{value!r} is no colour", remedy='Write it as "#rrggbb", in quotes, or as three numbers')
        return tuple(bytes.fromhex(value[1:]))
    return listed(value)


Channel = Annotated[int, Field(ge=0, le=255, strict=True)]


class Painted(MeshFile):
    """The part of a surface that is painted in a mesh file: triangles of a colour, a material and a group, where given.

    A triangle has a colour if two of its corners have it at least.
    """

    type: Literal["painted"] = "painted"
    file: MeshAddress | None = None
    """Mesh whose surface is that of the object, in the object's frame; by default the object's own."""
    color: Annotated[tuple[Channel, Channel, Channel], BeforeValidator(_channels)] | None = None
    """Red, green and blue from 0 to 255, or "#rrggbb": of triangles, of their corners, or of a texture there."""
    material: Name | None = None
    """Name of a material."""
    group: Name | None = None
    """Name of an object, a group or a part of the file."""
    beyond: Number = 0.0
    """How far the region reaches beyond the border of the paint, m; negative: it ends so far inside."""

    @model_validator(mode="after")
    def _something(self) -> Painted:
        if self.color is None and self.material is None and self.group is None:
            raise wrong("nothing says what is painted", remedy="Give `color`, `material` or `group`")
        for key, field in MeshFile.model_fields.items():
            if self.file is None and getattr(self, key) != field.default:
                raise wrong("belongs to a `file`, which is not given", key, remedy="Give it in the object's shape")
        return self

    @cached_property
    def mesh(self) -> Mesh | None:
        """The mesh that carries the paint; None: that of the object."""
        if self.file is None:
            return None
        return Mesh(**{name: getattr(self, name) for name in MeshFile.model_fields})

    @property
    def words(self) -> str:
        """Colour, material and group, in words."""
        color = None if self.color is None else "#" + bytes(self.color).hex()
        given = {"color": color, "material": self.material, "group": self.group}
        return " and ".join(f"{name} {value!r}" for name, value in given.items() if value is not None)


class AllOf(Frozen):
    """Points in every part."""

    type: Literal["all_of"] = "all_of"
    parts: Annotated[tuple[Region, ...], Field(min_length=1)]
    """Regions that all hold the point."""


class AnyOf(Frozen):
    """Points in some part."""

    type: Literal["any_of"] = "any_of"
    parts: Annotated[tuple[Region, ...], Field(min_length=1)]
    """Regions of which at least one holds the point."""


class Outside(Frozen):
    """Points that are not in the part."""

    type: Literal["outside"] = "outside"
    part: Region
    """Region that does not hold the point."""


Region = Annotated[
    HalfSpace | Band | Sector | Ball | Cuboid | Near | Painted | AllOf | AnyOf | Outside,
    Field(discriminator="type"),
]
for _combination in (AllOf, AnyOf, Outside):
    _combination.model_rebuild()


def on_object(region: Region, shape: ShapeDescription) -> Region:
    """Return a region of an object of a shape: what is painted without a file is so on the object's mesh.

    Raises:
        InputError: the object is no mesh, and a painted region names no file.
    """
    match region:
        case Painted(file=None):
            if not isinstance(shape, Mesh):
                problem = f"nothing is painted on an object of type {shape.type}"
                raise InputError(problem, remedy="Give the painted region a `file`, or make the object a mesh")
            of_mesh = {name: getattr(shape, name) for name in MeshFile.model_fields}
            words = {"color": region.color, "material": region.material, "group": region.group}
            return Painted(**of_mesh, **words, beyond=region.beyond)
        case AllOf() | AnyOf():
            return region.model_copy(update={"parts": tuple(on_object(part, shape) for part in region.parts)})
        case Outside():
            return Outside(part=on_object(region.part, shape))
    return region
