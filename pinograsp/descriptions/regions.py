"""Regions of an object's surface as they stand in a scene file: where contact is allowed or forbidden.

All in the object's frame. A region is one of the shapes below or a combination of regions; the part of the surface
inside it is meant. Membership is smooth for the optimiser (`pinograsp.models.regions`) and exact in the verification.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator

from .files import Frozen, Interval, Number, Vector3, wrong

Positive = Annotated[Number, Field(gt=0.0)]


class HalfSpace(Frozen):
    """Points p with normal . p >= offset."""

    type: Literal["half_space"]
    normal: Vector3
    offset: Number
    """m"""

    @field_validator("normal")
    @classmethod
    def _unit(cls, value: Vector3) -> Vector3:
        length = float(np.linalg.norm(value))
        if abs(length - 1.0) > 1e-6:
            raise wrong(f"must have length 1, not {length:.4g}")
        return value


class Band(Frozen):
    """Points between two heights z: a ring of a cylinder's side, a zone of a sphere."""

    type: Literal["band"]
    z: Interval
    """m"""

    @field_validator("z")
    @classmethod
    def _ordered(cls, value: Interval) -> Interval:
        if value[0] >= value[1]:
            raise wrong(f"the lower end {value[0]} is not below the upper end {value[1]}")
        return value


class Sector(Frozen):
    """Points whose angle about z, from x towards y, is within `half_width` of `middle`."""

    type: Literal["sector"]
    middle: Number
    """rad"""
    half_width: Annotated[Number, Field(gt=0.0, lt=math.pi)]
    """rad"""


class Ball(Frozen):
    """Points within `radius` of `center`."""

    type: Literal["ball"]
    center: Vector3
    radius: Positive


class Cuboid(Frozen):
    """Points between two corners."""

    type: Literal["box"]
    min: Vector3
    max: Vector3


class AllOf(Frozen):
    """Points in every part."""

    type: Literal["all_of"]
    parts: Annotated[tuple[Region, ...], Field(min_length=1)]


class AnyOf(Frozen):
    """Points in some part."""

    type: Literal["any_of"]
    parts: Annotated[tuple[Region, ...], Field(min_length=1)]


class Outside(Frozen):
    """Points that are not in the part."""

    type: Literal["outside"]
    part: Region


Region = Annotated[
    HalfSpace | Band | Sector | Ball | Cuboid | AllOf | AnyOf | Outside,
    Field(discriminator="type"),
]
for _combination in (AllOf, AnyOf, Outside):
    _combination.model_rebuild()
