"""The robot file: everything that is particular to a robot.

    robots/<name>/robot.yaml

names a URDF and an SRDF, the arm's joints, the hand's synergies, the pads and the stiffnesses. Lengths in
metres, angles in radians, forces in newtons.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from ..errors import InputError, close_names
from . import locate
from .files import FileRoot, Format1, Frozen, Interval, Number, Vector3, read_file, wrong

Positive = Annotated[Number, Field(gt=0.0)]
Name = Annotated[str, Field(min_length=1)]


def _ordered(interval: Interval, *path: str | int) -> Interval:
    if interval[0] >= interval[1]:
        raise wrong(f"the lower end {interval[0]:g} is not below the upper end {interval[1]:g}", *path)
    return interval


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
            _ordered(interval, "limits", name)
        return self


class SynergyDescription(Frozen):
    """One input of the hand: a URDF joint, followed by the joints that mimic it."""

    joint: Name
    limits: Interval | None = None
    """Limits in rad (m); those of the URDF if not given."""

    @field_validator("limits")
    @classmethod
    def _limits_ordered(cls, value: Interval | None) -> Interval | None:
        return None if value is None else _ordered(value)


class HandDescription(Frozen):
    """The hand's synergies: column k of the synergy matrix S (3) is synergy k."""

    synergies: Annotated[tuple[SynergyDescription, ...], Field(min_length=1)]

    @field_validator("synergies")
    @classmethod
    def _joints_once(cls, value: tuple[SynergyDescription, ...]) -> tuple[SynergyDescription, ...]:
        _once([synergy.joint for synergy in value], "joint")
        return value


class PlanePatch(Frozen):
    """A rectangle on a link: contact point origin + u x + v y, outward normal z = x cross y; link frame."""

    type: Literal["plane"]
    origin: Vector3
    normal: Vector3
    """Outward: away from the finger, towards the object."""
    x_axis: Vector3
    u: Interval
    """Range of the first contact parameter along x_axis, m."""
    v: Interval
    """Range of the second contact parameter along normal cross x_axis, m."""

    @field_validator("u", "v")
    @classmethod
    def _ordered(cls, value: Interval) -> Interval:
        return _ordered(value)

    @model_validator(mode="after")
    def _frame(self) -> PlanePatch:
        for name in ("normal", "x_axis"):
            length = float(np.linalg.norm(getattr(self, name)))
            if abs(length - 1.0) > 1e-6:
                raise wrong(f"must have length 1 (it has {length:.7g})", name)
        if abs(np.dot(self.normal, self.x_axis)) > 1e-6:
            raise wrong("must be perpendicular to normal", "x_axis")
        return self

    @cached_property
    def rotation(self) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        """Rotation (3, 3) of the patch frame in the link frame; columns x, y, normal."""
        normal, x_axis = np.array(self.normal), np.array(self.x_axis)
        return np.column_stack([x_axis, np.cross(normal, x_axis), normal])


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
    patch: PlanePatch
    contact: Annotated[HardFinger | SoftFinger, Field(discriminator="model")]


class StiffnessDescription(Frozen):
    """Compliance of the hand, section 3.1 of the paper."""

    joint: Positive
    """k_ss, N m / rad, of every hand joint."""
    contact: Positive
    """k_stru, N / m, of every contact force component."""


class RobotDescription(FileRoot):
    """A robot file."""

    format: Format1
    name: Name
    description: str = ""
    urdf: Name
    srdf: str | None = None
    packages: tuple[Path, ...] = ()
    """Folders, besides those of the installed wheels, in which `package://` is looked up."""
    arm: ArmDescription
    hand: HandDescription
    pads: Annotated[tuple[PadDescription, ...], Field(min_length=2)]
    stiffness: StiffnessDescription

    @field_validator("pads")
    @classmethod
    def _pads_once(cls, value: tuple[PadDescription, ...]) -> tuple[PadDescription, ...]:
        _once([pad.name for pad in value], "name")
        return value

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


def load_robot_description(name: str | Path) -> RobotDescription:
    """Read a robot file, given by path, by folder or by the name of a shipped robot.

    Raises:
        InputError: the file, its URDF or its SRDF is missing, or a key or value is wrong.
    """
    description = read_file(locate.robot_file(name), RobotDescription)
    _ = description.urdf_file, description.srdf_file
    return description
