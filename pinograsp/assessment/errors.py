"""Errors of the world against the plan of a grasp, and how they are drawn.

Vectors (position, orientation, centre of mass) are uniform in a ball, joints and the two factors uniform in an
interval; all are independent of each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import InputError, real_number
from ..frozen import Record

Interval = tuple[float, float]

SAMPLES = 200
"""Number of sets of errors that an assessment draws by default."""
FRICTION = (0.8, 1.2)
"""Friction by default, in parts of the task's coefficient."""
_MOST = 1e3
"""Largest friction coefficient and factor of the weight."""
_UNITS = {"position": "m", "orientation": "rad", "center_of_mass": "m", "joint": "rad"}
_LARGEST = {"position": 1.0, "orientation": math.pi, "center_of_mass": 1.0, "joint": math.pi}


@dataclass(frozen=True, eq=False, repr=False)
class Errors(Record):
    """How large the errors are. Zero and intervals of one value are allowed.

    Raises:
        InputError: a number is not finite, negative, absurdly large, or an interval is not in order; it names the key.
    """

    position: float = 0.002
    """Of the object, m: the radius of a ball."""
    orientation: float = math.radians(2.0)
    """Of the object, rad: the largest angle, about any axis through the origin of its frame."""
    friction: Interval | None = None
    """Static friction coefficient, least and greatest; None: 0.8 to 1.2 times the task's."""
    weight: Interval = (0.9, 1.1)
    """Factor of the task's wrench, least and greatest."""
    center_of_mass: float = 0.002
    """Of the object, m: the radius of a ball."""
    joint: float = 0.001
    """Of every arm joint, rad (m if it slides), to either side."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name in _LARGEST:
                number = real_number(field.name, value, 0.0, _LARGEST[field.name], unit=_UNITS[field.name])
                object.__setattr__(self, field.name, number)
            elif field.name != "friction" or value is not None:
                object.__setattr__(self, field.name, _interval(field.name, value))

    @classmethod
    def none(cls) -> Errors:
        """Return errors of size zero; friction and weight are the task's."""
        return cls(0.0, 0.0, None, (1.0, 1.0), 0.0, 0.0)

    def for_task(self, friction: float) -> Errors:
        """Return the errors with an interval of friction, given the task's coefficient."""
        if self.friction is not None:
            return self
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return Errors(**(values | {"friction": (FRICTION[0] * friction, FRICTION[1] * friction)}))


@dataclass(frozen=True, eq=False, repr=False)
class Draw(Record):
    """One set of errors; world frame."""

    position: Array
    """By how much the origin of the object's frame is off, m, shape (3,)."""
    orientation: Array
    """Rotation vector by which the object is turned about that origin, rad, shape (3,)."""
    friction: float
    """Friction coefficient."""
    weight: float
    """Factor of the task's wrench."""
    center_of_mass: Array
    """By how much the centre of mass is off in the object, m, shape (3,)."""
    joints: Array
    """By how much the arm joints are off, rad (m), shape (l,)."""

    @classmethod
    def none(cls, friction: float, joints: int) -> Draw:
        """Return no errors.

        Args:
            friction: the task's coefficient.
            joints: number of the arm's joints.
        """
        zero = np.zeros(3)
        return cls(zero, zero, friction, 1.0, zero, np.zeros(joints))


def draws(errors: Errors, samples: int, joints: int, seed: int) -> list[Draw]:
    """Return sets of errors, the same for the same seed; of fewer samples the first ones.

    Args:
        errors: their sizes, friction among them (`Errors.for_task`).
        samples: number of sets.
        joints: number of the arm's joints.
        seed: of the random numbers.
    """
    assert errors.friction is not None
    rng = np.random.default_rng(seed)
    return [
        Draw(
            position=errors.position * _in_ball(rng),
            orientation=errors.orientation * _in_ball(rng),
            friction=float(rng.uniform(*errors.friction)),
            weight=float(rng.uniform(*errors.weight)),
            center_of_mass=errors.center_of_mass * _in_ball(rng),
            joints=errors.joint * rng.uniform(-1.0, 1.0, joints),
        )
        for _ in range(samples)
    ]


def _in_ball(rng: np.random.Generator) -> Array:
    """Return a point that is uniform in the unit ball, shape (3,)."""
    direction = rng.normal(size=3)
    return np.asarray(direction / np.linalg.norm(direction) * rng.uniform() ** (1.0 / 3.0))


def _interval(key: str, value: Any) -> Interval:
    try:
        low, high = value
    except (TypeError, ValueError):
        raise InputError(f"must be two numbers, least and greatest, not {value!r}", key=key) from None
    low, high = real_number(key, low, 0.0, _MOST), real_number(key, high, 0.0, _MOST)
    if low > high:
        raise InputError(f"the least, {low:g}, is above the greatest, {high:g}", key=key)
    return low, high
