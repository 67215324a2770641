"""The robot file: everything that is particular to a robot.

    robots/<name>/robot.yaml

names a URDF and an SRDF, the arm's joints, the hand's synergies, the pads and the stiffnesses. Lengths in
metres, angles in radians, forces in newtons.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import Field, field_validator, model_validator

from .composition import Composition
from .hand import HandDescription, PadDescription, StiffnessDescription
from .model import Frozen
from .values import FileName, Interval, Name, Positive, Table, empty, ordered, wrong, wrong_name


class ArmDescription(Frozen):
    """The joints that carry the hand, from the base outwards, and the link called wrist."""

    joints: Annotated[tuple[Name, ...], Field(min_length=1)]
    """Names of its joints in the URDF, from the base outwards."""
    wrist: Name
    """Link whose origin says where the wrist is (its z axis is the approach direction)."""
    limits: Table[Name, Interval] = Field(default_factory=empty)
    """Limits in rad (m) that replace those of the URDF. A continuous joint has +-2 pi if none is given."""

    @field_validator("joints")
    @classmethod
    def _joints_once(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        _once(value)
        return value

    @model_validator(mode="after")
    def _limits_known(self) -> ArmDescription:
        for name, interval in self.limits.items():
            if name not in self.joints:
                raise wrong_name(f"{name!r} is not among the arm's joints", name, list(self.joints), "limits", name)
            ordered(interval, "limits", name)
        return self


PieceCount = Annotated[int, Field(ge=1, le=64, strict=True)]


class LinkCollisionDescription(Frozen):
    """How closely the collision meshes of one link are followed; what is not given is as for all links."""

    pieces: PieceCount | None = None
    """Largest number of pieces of a mesh; 1: its convex hull."""
    tolerance: Positive | None = None
    """Distance to the mesh below which a piece is not divided any more, m."""


class CollisionDescription(Frozen):
    """How closely the convex pieces that stand for a collision mesh follow it; together they contain it."""

    pieces: PieceCount = 8
    """Largest number of pieces of a mesh; 1: its convex hull."""
    tolerance: Positive = 0.004
    """A piece is not divided any more if 95 % of its outer surface are this near to the mesh, m."""
    links: Table[Name, LinkCollisionDescription] = Field(default_factory=empty)
    """Links that differ from this, by name."""

    def of(self, link: str) -> tuple[int, float]:
        """Return number of pieces and tolerance, m, for the meshes of a link."""
        own = self.links.get(link, LinkCollisionDescription())
        return own.pieces or self.pieces, own.tolerance or self.tolerance


class RobotDescription(Composition):
    """A robot file."""

    name: FileName
    """Of the robot; part of the names of its files of results."""
    description: str = ""
    """For who reads the file or `pinograsp list`."""
    arm: ArmDescription
    """The joints that carry the hand."""
    hand: HandDescription
    """The synergies that move the hand."""
    pads: Annotated[tuple[PadDescription, ...], Field(min_length=2)]
    """Surfaces of fingers that are to touch objects."""
    stiffness: StiffnessDescription
    """Compliance of the hand's joints and of its contacts."""
    collision: CollisionDescription = CollisionDescription()
    """How closely convex pieces follow the collision meshes."""

    @field_validator("pads", mode="before")
    @classmethod
    def _two_pads(cls, value: Any) -> Any:
        if value is None or (isinstance(value, list) and len(value) < 2):
            remedy = "Describe the finger surfaces that are to touch objects; `pinograsp robot check` shows flat ones"
            raise wrong(f"a hand holds with two pads or more, not with {len(value or ())}", remedy=remedy)
        return value

    @field_validator("pads")
    @classmethod
    def _pads_once(cls, value: tuple[PadDescription, ...]) -> tuple[PadDescription, ...]:
        _once([pad.name for pad in value], "name")
        return value


class UnfinishedRobot(RobotDescription):
    """A robot file of which the pads are still to be written: it can be looked at, and nothing else."""

    pads: tuple[PadDescription, ...] = ()
    """Those that are there."""

    @field_validator("pads", mode="before")
    @classmethod
    def _two_pads(cls, value: Any) -> Any:
        return () if value is None else value


def _once(names: Sequence[str], *path: str) -> None:
    for index, name in enumerate(names):
        if name in names[:index]:
            raise wrong(f"{name!r} is given twice", index, *path)
