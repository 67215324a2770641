"""Tasks: which object to hold, where, against which wrench, and what else is asked of the grasp.

Lengths in metres, angles in radians, forces in newtons.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, field_validator, model_validator

from ..arrays import Array
from ..frozen import frozen
from .hand import ContactModel
from .model import Frozen
from .pose import ZERO
from .regions import AllOf, Outside, Region
from .values import (
    Name,
    NotNegative,
    Number,
    OptionalContactPoints,
    Positive,
    Ranges,
    Table,
    UnitVector3,
    Vector3,
    as_default,
    empty,
    wrong,
)


class Wrench(Frozen):
    """External wrench on the object: force, N, and torque about the centre of mass, N m, world frame."""

    force: Vector3
    """N, world."""
    torque: Vector3 = as_default(ZERO)
    """About the centre of mass, N m, world."""

    @cached_property
    def vector(self) -> Array:
        """The wrench as (force, torque), N and N m, shape (6,); read-only."""
        return np.asarray(frozen(np.array([*self.force, *self.torque])))


class ContactConstants(Frozen):
    """Friction and force limits of the force problem, (17), (18) and appendix A."""

    friction: Positive
    """Static friction coefficient mu_s."""
    min_normal_force: NotNegative = 0.001
    """f_min, N."""
    max_force: Positive = 5.0
    """f_max on the norm of a contact force, N."""
    kappa: Positive = 0.01
    """Margin below which the barrier of (A6) becomes quadratic, N."""

    @model_validator(mode="after")
    def _ordered(self) -> ContactConstants:
        if self.min_normal_force >= self.max_force:
            raise wrong(f"must be below max_force, {self.max_force:g} N", "min_normal_force")
        return self


class Margins(Frozen):
    """Least distances, m."""

    enclosure: NotNegative = 0.005
    """Robot to walls, obstacles and other objects (16), m."""
    robot: NotNegative = 0.005
    """Robot to itself, m."""
    object: NotNegative = 0.001
    """Links that are no pads, and what stands out beside a pad, to the object, m: only pads are to carry it."""


class Reserves(Frozen):
    """How far a grasp keeps from where joints and pads end."""

    joint: NotNegative = 0.02
    """Arm joints from their limits, rad (m)."""
    rim: NotNegative = 0.0005
    """Contact points from the rims of their pads and from the edges of the object's surface, m.

    An object that a pad touches with its very rim tips over it: of such grasps up to half did not even hold still in
    simulation, of those half a millimetre away all.
    """


class ApproachCone(Frozen):
    """A cone of approach directions: the wrist's z axis lies within `angle` of `direction`."""

    direction: UnitVector3
    """Where the hand points, length 1: (0, 0, -1) is from above."""
    angle: Annotated[Number, Field(gt=0.0, le=math.pi)]
    """Half-angle of the cone, rad."""
    frame: Literal["world", "object"] = "world"
    """Frame of `direction`."""


class JointInterval(NamedTuple):
    """An interval in which an arm joint or a synergy is to be, rad (m)."""

    key: Literal["joint_ranges", "lock"]
    """Of the task, where it stands."""
    name: str
    """Of the arm joint or synergy."""
    lower: float
    """rad (m)."""
    upper: float
    """rad (m)."""


class Task(Frozen):
    """A job for the hand: which object to hold, where, and against which wrench."""

    object: Name
    """Name of an object of the scene."""
    desired_contacts: OptionalContactPoints = as_default(None)
    """Desired contact points on the object's surface, in the object's frame, m; one for each pad.

    If not given, each start is led to a pair of opposite points that is proposed to it, and Phi is zero.
    """
    pads: Annotated[tuple[Name, ...], Field(min_length=2)] | None = None
    """Names of the robot's pads that are to touch the object; all if not given. The nearest takes each point."""
    wrench: Wrench | None = None
    """External force, N, and torque, N m, that the contacts are to balance, world; all of it, the weight included.

    By default the weight of the object: its mass times the gravity of the scene, at its centre of mass.
    """
    contact: ContactConstants
    """Friction, and limits of the contact forces, N."""
    force_weight: NotNegative = 1.0
    """k of (10), mm^2: weight of V against the squared contact distances."""
    margin: Margins = Margins()
    """Least distances, m."""
    reserve: Reserves = Reserves()
    """Least distances of joints from their limits, rad (m), and of contacts from rims, m."""
    contact_model: ContactModel | None = None
    """Contact model of every pad, in place of what the robot file says."""
    allowed_contacts: Region | None = None
    """Part of the object's surface where contact is allowed, object's frame; everywhere if not given."""
    forbidden_contacts: Region | None = None
    """Part of the object's surface where contact is forbidden, object's frame."""
    contact_regions: Literal["footprint", "point"] = "footprint"
    """Part of a contact that has to be where contact may be: the footprint, or the contact point alone (the paper)."""
    withstand: Positive | None = None
    """Least acceleration of the object in any direction that its grasp must withstand, m/s^2; none if not given."""
    approach: ApproachCone | None = None
    """Approach directions that are wanted; every direction if not given."""
    joint_ranges: Ranges = Field(default_factory=empty)
    """Ranges of arm joints and synergies within the robot's limits, rad (m); one of no width locks its joint.

    Whole turns of a continuous joint do not count: [3.0, 3.5] holds the reported angle -3.1, which is 3.18 less a turn.
    """
    lock: Table[Name, Number] = Field(default_factory=empty)
    """Values at which arm joints and synergies stay, rad (m), within the robot's limits less the joint reserve.

    Whole turns of a continuous joint do not count. A joint may have a range, too, which then has to hold the value.
    """
    balance_wrench: bool = True
    """Whether the part of the wrench that no contact force balances must vanish (the paper: false)."""
    start_radius: Positive = 0.3
    """Starts have their wrist within this distance of the object's centre of mass, m."""

    @field_validator("pads")
    @classmethod
    def _pads_once(cls, value: tuple[str, ...] | None) -> tuple[str, ...] | None:
        for index, name in enumerate(value or ()):
            if name in (value or ())[:index]:
                raise wrong(f"{name!r} is given twice", index)
        return value

    @cached_property
    def contact_region(self) -> Region | None:
        """Where contact may be: allowed and not forbidden; None for everywhere."""
        parts: list[Region] = [] if self.allowed_contacts is None else [self.allowed_contacts]
        if self.forbidden_contacts is not None:
            parts.append(Outside(part=self.forbidden_contacts))
        return AllOf(parts=tuple(parts)) if len(parts) > 1 else parts[0] if parts else None

    @cached_property
    def intervals(self) -> tuple[JointInterval, ...]:
        """All that the task asks of joints: the ranges, then the locks as intervals of no width, rad (m)."""
        ranges = (JointInterval("joint_ranges", name, *ends) for name, ends in self.joint_ranges.items())
        locks = (JointInterval("lock", name, value, value) for name, value in self.lock.items())
        return (*ranges, *locks)
