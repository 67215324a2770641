"""Figures of a task's preferences: approach direction and joint ranges."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping

import numpy as np

from ..arrays import Array
from ..descriptions.task import ApproachCone, JointInterval
from .certificate import Figure

TOLERANCE = 1e-9
"""rad (m for sliding joints)."""


def approach_figure(approach: ApproachCone, T_world_object: Array, T_world_wrist: Array, wrist: str) -> Figure:
    """Return the angle of the wrist's z axis from the direction that is wanted, rad."""
    given = np.array(approach.direction)
    wanted = given if approach.frame == "world" else T_world_object[:3, :3] @ given
    wanted = wanted / np.linalg.norm(wanted)
    z = T_world_wrist[:3, 2]
    # Exact for small and large angles alike, which arccos is not.
    angle = 2 * math.atan2(float(np.linalg.norm(z - wanted)), float(np.linalg.norm(z + wanted)))
    return Figure("approach", angle, approach.angle + TOLERANCE, "rad", "at most", wrist)


def ranges_figure(ranges: Iterable[JointInterval], angles: Mapping[str, float], endless: Collection[str]) -> Figure:
    """Return how far inside its range the least deep joint is, rad (m for sliding joints); negative outside.

    A joint that is locked is 0 deep at its value.

    Args:
        ranges: and locks, each with its joint; one joint may have both.
        angles: of these joints at least.
        endless: joints of which whole turns do not count.
    """
    depths: list[tuple[float, str]] = []
    for _, name, low, high in ranges:
        off = angles[name] - 0.5 * (low + high)
        if name in endless:
            off = math.remainder(off, 2 * math.pi)
        depths.append((0.5 * (high - low) - abs(off), name))
    depth, worst = min(depths, key=lambda pair: pair[0])
    return Figure("joint ranges", depth, -TOLERANCE, "rad", "at least", worst)
