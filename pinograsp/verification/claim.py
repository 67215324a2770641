"""The claim of a solver in terms that anyone can recompute: joint angles by name, contacts and forces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..frozen import Record

_LARGEST = 1e9
"""In any unit."""


@dataclass(frozen=True, eq=False, repr=False)
class Claim(Record):
    """A grasp as claimed. Contact i belongs to pad i of the robot file."""

    joints: Mapping[str, float]
    """Angle (rad) or displacement (m) of every movable joint of the URDF, mimic joints included."""
    points: Array
    """Contact points in the world, m, shape (contacts, 3)."""
    forces: Array
    """Forces on the object in the world, N, shape (contacts, 3)."""
    spin_torques: Array
    """Torques on the object about its inward normals at the points, N m, shape (contacts,); 0 for hard fingers.

    Where pads are tangent these are the outward normals of the pads.
    """

    @property
    def is_finite(self) -> bool:
        """Whether no number is so large that it is no part of a grasp, or is not a number at all."""
        numbers = [*self.joints.values(), *self.points.flat, *self.forces.flat, *self.spin_torques.flat]
        return bool((np.abs(numbers) < _LARGEST).all())  # false for nan too

    def require_complete(self, joints: Sequence[str], contacts: int) -> None:
        """Refuse a claim that leaves something out.

        Args:
            joints: names of the movable joints of the URDF.
            contacts: how many there are, one a pad.

        Raises:
            InputError: a joint is missing, or there is not one contact a pad.
        """
        for name in joints:
            if name not in self.joints:
                raise InputError(f"the claim gives no value for joint {name}")
        if self.points.shape != (contacts, 3) or self.forces.shape != (contacts, 3):
            raise InputError(f"the claim must have points and forces of shape ({contacts}, 3), one a pad")
        if self.spin_torques.shape != (contacts,):
            raise InputError(f"the claim must have spin torques of shape ({contacts},), one a pad")
