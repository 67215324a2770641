"""Regions of an object's surface as they stand in a scene file: where contact is allowed or forbidden.

All in the object's frame. A region is one of the shapes below or a combination of regions; the part of the surface
inside it is meant. Membership is smooth for the optimiser (`pinograsp.geometry.regions`) and exact in the verification.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Literal

from pydantic import Field

from .model import Frozen
from .values import Number, OrderedInterval, Points, Positive, UnitVector3, Vector3


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
    HalfSpace | Band | Sector | Ball | Cuboid | Near | AllOf | AnyOf | Outside,
    Field(discriminator="type"),
]
for _combination in (AllOf, AnyOf, Outside):
    _combination.model_rebuild()
