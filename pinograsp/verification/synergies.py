"""The hand's synergies, seen from the joint angles: what they amount to, and whether the joints keep to them.

Written apart from `kinematics.robot`, which goes from synergies to joints.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..descriptions import RobotDescription
from .certificate import Figure
from .joints import Limits
from .kinematics import Joint


@dataclass(frozen=True)
class Synergies:
    """Angles = rest + matrix sigma, of the joints that are neither the arm's nor mimic another."""

    names: tuple[str, ...]
    joints: tuple[str, ...]
    matrix: Array
    """Shape (joints, synergies)."""
    rest: Array
    """Rad (m), shape (joints,)."""
    given: dict[str, tuple[float, float]]
    """Limits of synergies of several joints that the robot file gives, by name."""

    @classmethod
    def of(cls, robot: RobotDescription, joints: Iterable[Joint]) -> Synergies:
        """Return the synergies of a robot file."""
        hand = robot.hand
        own = [joint.name for joint in joints if joint.mimics is None and joint.name not in robot.arm.joints]
        return cls(
            names=tuple(synergy.label for synergy in hand.synergies),
            joints=tuple(own),
            matrix=np.array([[s.column.get(name, 0.0) for s in hand.synergies] for name in own]),
            rest=np.array([hand.rest.get(name, 0.0) for name in own]),
            given={s.label: s.limits for s in hand.synergies if s.joint is None and s.limits is not None},
        )

    def values(self, angles: Mapping[str, float]) -> dict[str, float]:
        """Return the synergies that come nearest to the angles."""
        moved = np.array([angles[name] for name in self.joints]) - self.rest
        return dict(zip(self.names, np.linalg.lstsq(self.matrix, moved, rcond=None)[0].tolist(), strict=True))

    def rates(self, joints: Iterable[Joint]) -> dict[str, Array]:
        """Return by how much each joint that synergies move changes per unit of each synergy, shape (synergies,).

        Args:
            joints: all movable joints of the URDF; those that mimic a joint of the hand change with it.
        """
        named = {joint.name: joint for joint in joints}
        own = {name: row for name, row in zip(self.joints, self.matrix, strict=True) if row.any()}
        found: dict[str, Array] = {}
        for name in named:
            leader, factor = named[name], 1.0
            while leader.mimics is not None:
                leader, factor = named[leader.mimics], factor * leader.multiplier
            if leader.name in own:
                found[name] = factor * own[leader.name]
        return found

    def angles(self, values: dict[str, float]) -> dict[str, float]:
        """Return the angles of the joints at the synergies."""
        sigma = np.array([values[name] for name in self.names])
        return dict(zip(self.joints, (self.rest + self.matrix @ sigma).tolist(), strict=True))

    def limits(self, of_joints: Limits) -> Limits:
        """Return the limits of the synergies; joints that several synergies move do not narrow them."""
        found: Limits = {}
        for name, column in zip(self.names, self.matrix.T, strict=True):
            low, high = self.given.get(name, (-math.inf, math.inf))
            for row in np.flatnonzero(column):
                if np.count_nonzero(self.matrix[row]) == 1 and self.joints[row] in of_joints:
                    first, second = ((end - self.rest[row]) / column[row] for end in of_joints[self.joints[row]])
                    low, high = max(low, min(first, second)), min(high, max(first, second))
            if math.isfinite(low) and math.isfinite(high):
                found[name] = (low, high)
        return found

    def figure(self, angles: Mapping[str, float]) -> Figure | None:
        """Return the largest deviation of a joint from what the synergies give, rad (m for sliding joints).

        None if every joint is a synergy of its own.
        """
        if len(self.joints) == np.linalg.matrix_rank(self.matrix):
            return None
        wanted = self.angles(self.values(angles))
        errors = {name: abs(angles[name] - angle) for name, angle in wanted.items()}
        worst = max(errors, key=errors.__getitem__)
        return Figure("synergies", errors[worst], 1e-9, "rad", "at most", worst)
