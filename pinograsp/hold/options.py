"""How a grasp is shaken, and what counts as held."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from ..errors import InputError, positive_number, real_number, require_kind


@dataclass(frozen=True)
class HoldOptions:
    """Loads, limits and control of a hold test.

    Raises:
        InputError: a number is out of range, or there is no such control.
    """

    acceleration: float = 5.0
    """Of the base along each axis of the world, both ways, m/s^2."""
    spin: float = 10.0
    """Angular acceleration of the base about each axis of the world through the object's centre of mass, rad/s^2."""
    slip_distance: float = 1e-3
    """Displacement of the object from which on it is not held, m."""
    slip_angle: float = math.radians(2.0)
    """Rotation of the object from which on it is not held, rad."""
    first_slip: bool = False
    """Whether to search for the acceleration at which the object first slips."""
    ramp: float = 10.0
    """How fast the acceleration grows in that search, m/s^2 per second."""
    strongest: float = 60.0
    """Acceleration at which that search ends, m/s^2."""
    control: Literal["auto", "torque", "position"] = "auto"
    """Driver torque, or position control to q_r; auto: torque for hands of one synergy, position for others."""
    controls: bool = False
    """Whether to run the two negative controls of every grasp: no squeeze, and next to no friction."""
    squeeze: bool = True
    """Whether the hand squeezes; if not, it stands at the angles of the grasp without torque."""
    friction: float | None = None
    """Friction coefficient in place of the task's."""

    def __post_init__(self) -> None:
        """Refuse numbers that make no sense."""
        for name in ("acceleration", "spin"):
            real_number(name, getattr(self, name), 0.0)
        for name in ("slip_distance", "slip_angle", "ramp", "strongest"):
            positive_number(name, getattr(self, name))
        if self.friction is not None:
            positive_number("friction", self.friction)
        if self.control not in ("auto", "torque", "position"):
            raise InputError(f"{self.control!r} is not auto, torque or position", key="control")


def given_options(options: HoldOptions | None) -> HoldOptions:
    """Return options that were given as an argument; None: the default ones.

    Raises:
        InputError: they are of another class.
    """
    if options is not None:
        require_kind("options", options, HoldOptions, remedy="Give HoldOptions(...)")
    return options or HoldOptions()
