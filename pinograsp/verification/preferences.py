"""Figures of what a task prefers: approach direction and joint ranges."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import numpy as np

from ..arrays import Array
from ..descriptions.scene import ApproachCone
from .certificate import Figure
from .joints import Limits

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


def ranges_figure(ranges: Limits, angles: Mapping[str, float], endless: Collection[str]) -> Figure:
    """Return how far inside its range the least deep joint is, rad (m for sliding joints); negative outside.

    Args:
        ranges: by joint.
        angles: of these joints at least.
        endless: joints of which whole turns do not count.
    """
    depths: dict[str, float] = {}
    for name, (low, high) in ranges.items():
        off = angles[name] - 0.5 * (low + high)
        if name in endless:
            off = math.remainder(off, 2 * math.pi)
        depths[name] = 0.5 * (high - low) - abs(off)
    worst = min(depths, key=depths.__getitem__)
    return Figure("joint ranges", depths[worst], -TOLERANCE, "rad", "at least", worst)
