"""The robot file: everything that is particular to a robot.

    robots/<name>/robot.yaml

names a URDF and an SRDF, the arm's joints, the hand's synergies, the pads and the stiffnesses. Lengths in
metres, angles in radians, forces in newtons.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, field_validator, model_validator

from ..errors import InputError, close_names
from . import locate
from .files import FileRoot, Format1, Frozen, Interval, Number, ordered, read_file, wrong
from .patches import Patch
from .pose import Pose

Positive = Annotated[Number, Field(gt=0.0)]
Name = Annotated[str, Field(min_length=1)]


def _once(names: Sequence[str], *path: str) -> None:
    for index, name in enumerate(names):
        if name in names[:index]:
            raise wrong(f"{name!r} is given twice", index, *path)


class ArmDescription(Frozen):
    """The joints that carry the hand, from the base outwards, and the link called wrist."""

    joints: Annotated[tuple[Name, ...], Field(min_length=1)]
    wrist: Name
    """Link whose origin says where the wrist is (its z axis is the approach direction)."""
    limits: dict[Name, Interval] = Field(default_factory=dict)
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
                remedy = close_names(name, list(self.joints))
                raise wrong(f"{name!r} is not among the arm's joints", "limits", name, remedy=remedy)
            ordered(interval, "limits", name)
        return self


_SYNERGY = "a synergy is one joint, or has a name and joints"
_SYNERGY_REMEDY = "Write `joint: finger`, or `name: close` with `joints: {finger: 1.0, thumb: 0.5}`"


class SynergyDescription(Frozen):
    """One input of the hand, a column of the synergy matrix S (3): a joint, or several joints that move together.

    Joints that mimic these follow.
    """

    joint: Name | None = None
    """URDF joint: the synergy is its angle, rad (m)."""
    name: Name | None = None
    """Of a synergy of several joints."""
    joints: dict[Name, Number] = Field(default_factory=dict)
    """Angle of each joint, rad (m), per unit of the synergy; it adds to the others' and to `HandDescription.rest`."""
    limits: Interval | None = None
    """Limits in rad (m), or in units of the synergy; what the URDF allows its joints if not given."""

    @model_validator(mode="before")
    @classmethod
    def _names_joints(cls, value: Any) -> Any:
        """Refuse a column of a matrix, which does not say which joint a number is for."""
        if isinstance(value, list | str | int | float):
            raise wrong(_SYNERGY, remedy=_SYNERGY_REMEDY)
        if isinstance(value, dict) and isinstance(value.get("joints"), list):
            raise wrong("the angles of a synergy go with the names of joints", "joints", remedy=_SYNERGY_REMEDY)
        return value

    @field_validator("limits")
    @classmethod
    def _limits_ordered(cls, value: Interval | None) -> Interval | None:
        return None if value is None else ordered(value)

    @model_validator(mode="after")
    def _one_or_several(self) -> SynergyDescription:
        if (self.joint is None) == (not self.joints) or (self.joint is None) == (self.name is None):
            raise wrong(_SYNERGY, remedy=_SYNERGY_REMEDY)
        for name, factor in self.joints.items():
            if factor == 0.0:
                raise wrong("0 moves nothing", "joints", name, remedy="Leave it out")
        return self

    @property
    def label(self) -> str:
        """The name of the synergy: that of its joint, if it is one."""
        return self.joint or self.name or ""

    @property
    def column(self) -> dict[str, float]:
        """Angle of its joints per unit of the synergy."""
        return dict(self.joints) if self.joint is None else {self.joint: 1.0}


class HandDescription(Frozen):
    """The hand's synergies: angles of its joints = rest + S sigma, where column k of S (3) is synergy k."""

    synergies: Annotated[tuple[SynergyDescription, ...], Field(min_length=1)]
    rest: dict[Name, Number] = Field(default_factory=dict)
    """Angles, rad (m), with all synergies at 0; 0 if not given. A joint of no synergy stays there."""

    @model_validator(mode="after")
    def _joints_once(self) -> HandDescription:
        labels = [synergy.label for synergy in self.synergies]
        single = {synergy.joint for synergy in self.synergies}
        for index, synergy in enumerate(self.synergies):
            if synergy.label in labels[:index]:
                key = "name" if synergy.joint is None else "joint"
                raise wrong(f"{synergy.label!r} is given twice", "synergies", index, key)
            for name in synergy.joints:
                if name in single:
                    raise wrong(f"{name!r} is a synergy of its own", "synergies", index, "joints", name)
        for name in self.rest:
            if name in single:
                raise wrong(f"{name!r} is a synergy of its own: it has no rest", "rest", name)
        return self

    @property
    def joints(self) -> frozenset[str]:
        """The joints that synergies move, without those that mimic them."""
        return frozenset(name for synergy in self.synergies for name in synergy.column)


class HardFinger(Frozen):
    """Point contact with friction: three force components (the paper's model)."""

    model: Literal["hard_finger"]


class SoftFinger(Frozen):
    """Hard finger plus the spin torque about the normal, as a rubber pad gives it."""

    model: Literal["soft_finger"]
    torsion_radius: Positive
    """e in the friction term norm(f, m_n / e), m."""
    torsional_stiffness: Positive
    """Spin torque per angle of spin, N m / rad."""


class PadDescription(Frozen):
    """The surface patch of a finger link where contact is wanted."""

    name: Name
    link: Name
    patch: Patch
    contact: Annotated[HardFinger | SoftFinger, Field(discriminator="model")]


class StiffnessDescription(Frozen):
    """Compliance of the hand, section 3.1 of the paper."""

    joint: Positive
    """k_ss, N m / rad (N / m if it slides), of every hand joint."""
    contact: Positive
    """k_stru, N / m, of every contact force component."""


PieceCount = Annotated[int, Field(ge=1, le=64, strict=True)]


class LinkCollisionDescription(Frozen):
    """How closely the collision meshes of one link are followed; what is not given is as for all links."""

    pieces: PieceCount | None = None
    tolerance: Positive | None = None


class CollisionDescription(Frozen):
    """How closely the convex pieces that stand for a collision mesh follow it; together they contain it."""

    pieces: PieceCount = 8
    """Largest number of pieces of a mesh; 1: its convex hull."""
    tolerance: Positive = 0.004
    """A piece is not divided any more if 95 % of its outer surface are this near to the mesh, m."""
    links: dict[Name, LinkCollisionDescription] = Field(default_factory=dict)

    def of(self, link: str) -> tuple[int, float]:
        """Return number of pieces and tolerance, m, for the meshes of a link."""
        own = self.links.get(link, LinkCollisionDescription())
        return own.pieces or self.pieces, own.tolerance or self.tolerance


class UrdfPart(Frozen):
    """What is taken of one URDF: all, or what `root` carries, less what the links under `leave_out` carry."""

    urdf: Name
    srdf: str | None = None
    root: Name | None = None
    """Link with which it begins; the URDF's own root if not given."""
    leave_out: tuple[Name, ...] = ()
    """Links that are left out, with all that they carry."""


class Attachment(UrdfPart, Pose):
    """A further URDF, fixed to a link: a hand on an arm, an arm on a rail. The pose is that of its root in the link."""

    to: Name
    """Link of what is there so far."""
    prefix: str = ""
    """Put before every name of links and joints of this URDF."""


class UrdfFiles(NamedTuple):
    """Files on disk."""

    urdf: Path
    srdf: Path | None


class Composition(FileRoot, UrdfPart):
    """What a robot file says of URDFs: one, or several put together, and where they are."""

    format: Format1
    attach: tuple[Attachment, ...] = ()
    packages: tuple[Path, ...] = ()
    """Folders, besides those of the installed wheels, in which `package://` is looked up."""

    @cached_property
    def folders(self) -> list[Path]:
        """Folders in which `package://` is looked up."""
        return locate.package_folders(self.source, self.packages)

    @cached_property
    def urdf_file(self) -> Path:
        """The URDF on disk."""
        return self._resolve("urdf", self.urdf)

    @cached_property
    def srdf_file(self) -> Path | None:
        """The SRDF on disk, if the file names one."""
        return None if self.srdf is None else self._resolve("srdf", self.srdf)

    @cached_property
    def attached_files(self) -> tuple[UrdfFiles, ...]:
        """The files of what is attached."""
        return tuple(
            UrdfFiles(
                self._resolve(f"attach[{i}].urdf", part.urdf),
                None if part.srdf is None else self._resolve(f"attach[{i}].srdf", part.srdf),
            )
            for i, part in enumerate(self.attach)
        )

    @property
    def files(self) -> dict[str, Path]:
        """All files that the robot file names, by key."""
        parts = [("", UrdfFiles(self.urdf_file, self.srdf_file))]
        parts += [(f"attach[{i}].", files) for i, files in enumerate(self.attached_files)]
        named = {f"{key}{role}": file for key, files in parts for role, file in files._asdict().items()}
        return {key: file for key, file in named.items() if file is not None}

    def _resolve(self, key: str, address: str) -> Path:
        found = locate.resolve(address, beside=self.source, folders=self.folders)
        if found is None:
            raise InputError(
                f"{address} was not found",
                file=self.source,
                key=key,
                remedy="Looked in " + ", ".join(str(folder) for folder in self.folders),
            )
        return found


class RobotDescription(Composition):
    """A robot file."""

    name: Name
    description: str = ""
    arm: ArmDescription
    hand: HandDescription
    pads: Annotated[tuple[PadDescription, ...], Field(min_length=2)]
    stiffness: StiffnessDescription
    collision: CollisionDescription = CollisionDescription()

    @field_validator("pads", mode="before")
    @classmethod
    def _two_pads(cls, value: Any) -> Any:
        if value is None or (isinstance(value, list) and len(value) < 2):
            remedy = "Describe the finger surfaces that are to touch objects; `pinograsp robot new` finds flat ones"
            raise wrong(f"a hand holds with two pads or more, not with {len(value or ())}", remedy=remedy)
        return value

    @field_validator("pads")
    @classmethod
    def _pads_once(cls, value: tuple[PadDescription, ...]) -> tuple[PadDescription, ...]:
        _once([pad.name for pad in value], "name")
        return value


def load_robot_description(name: str | Path) -> RobotDescription:
    """Read a robot file, given by path, by folder or by the name of a shipped robot.

    Raises:
        InputError: the file, its URDF or its SRDF is missing, or a key or value is wrong.
    """
    description = read_file(locate.robot_file(name), RobotDescription)
    _ = description.files
    return description
