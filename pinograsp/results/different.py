"""The best grasps that differ from each other, each with what stands behind it.

The difference of two grasps is the largest of

    |p_1 - p_2| / 20 mm,    angle(R_1^T R_2) / 15 degrees,    max over arm joints |q_1 - q_2| / 30 degrees,

p and R those of the wrist, whole turns of joints not counted. They differ if it is above 1. The object lies still
during a plan, so that this is the difference of hand poses relative to the object, too.

In rank order a grasp is shown if it differs from all that are shown before it. Every other grasp stands behind the
shown one that it differs least from, unless it differs from all of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array, without_turns
from ..errors import whole_number
from .grasp import Grasp

POSITION = 0.02
"""Wrist positions farther apart differ, m."""
ROTATION = math.radians(15.0)
"""Wrist orientations farther apart differ, rad."""
JOINT = math.radians(30.0)
"""Postures with an arm joint farther apart differ, rad (m)."""


class Different(NamedTuple):
    """A grasp that differs from the others that are shown."""

    grasp: Grasp
    """The best of those that it stands for."""
    starts: int
    """Number of starts that found it or a grasp behind it."""
    grasp_count: int
    """Number of distinct grasps that it stands for, itself included."""


def different(ranked: Sequence[Grasp], most: int) -> tuple[Different, ...]:
    """Return the first grasps, at most so many, that differ from each other.

    Args:
        ranked: the best first.
        most: number of grasps.

    Raises:
        InputError: the number is none, or negative.
    """
    most = whole_number("most", most, 0)
    if not ranked:
        return ()
    T = np.array([grasp.T_world_wrist for grasp in ranked])
    q = np.array([grasp.q_arm for grasp in ranked])
    least, nearest = np.full(len(ranked), np.inf), np.zeros(len(ranked), dtype=np.intp)
    shown: list[int] = []
    while len(shown) < most and (least > 1.0).any():
        chosen = int(np.argmax(least > 1.0))
        apart = differences(T, q, chosen)
        nearer = apart < least
        least[nearer], nearest[nearer] = apart[nearer], len(shown)
        shown.append(chosen)
    behind = [np.flatnonzero((least <= 1.0) & (nearest == i)).tolist() for i in range(len(shown))]
    return tuple(
        Different(ranked[i], sum(ranked[j].count for j in others), len(others))
        for i, others in zip(shown, behind, strict=True)
    )


def differences(T: Array, q: Array, one: int) -> Array:
    """Return how much grasps differ from one of them, shape (n,).

    Args:
        T: T_world_wrist, shape (n, 4, 4).
        q: arm joints, rad, shape (n, l).
        one: index of the one.
    """
    position = np.linalg.norm(T[:, :3, 3] - T[one, :3, 3], axis=1)
    # The chord of a rotation keeps its digits at small angles, where the arc cosine of the trace loses them.
    chord = np.linalg.norm(T[:, :3, :3] - T[one, :3, :3], axis=(1, 2)) / math.sqrt(8.0)
    rotation = 2.0 * np.arcsin(np.minimum(chord, 1.0))
    joint = np.abs(without_turns(q - q[one])).max(axis=1)
    return np.asarray(np.max([position / POSITION, rotation / ROTATION, joint / JOINT], axis=0))
