"""Exact membership of regions: the depth of a point in a region, negative outside, m."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..descriptions import regions as described
from .painted import painted_depths


def depth(region: described.Region, point: Array) -> float:
    """Return how deep a point (3,), in the object's frame, is in a region; negative outside.

    A lower bound of the distance to the region's border inside; the sign is exact.
    """
    match region:
        case described.HalfSpace():
            return float(np.dot(region.normal, point)) - region.offset
        case described.Band():
            return min(float(point[2]) - region.z[0], region.z[1] - float(point[2]))
        case described.Sector():
            off = math.remainder(math.atan2(point[1], point[0]) - region.middle, 2 * math.pi)
            return (region.half_width - abs(off)) * math.hypot(point[0], point[1])
        case described.Ball():
            return region.radius - math.dist(point, region.center)
        case described.Cuboid():
            return float(min(np.min(point - region.min), np.min(np.array(region.max) - point)))
        case described.Near():
            return depth(region.balls, point)
        case described.Painted():
            return float(painted_depths(region, point[None])[0])
        case described.AllOf():
            return min(depth(part, point) for part in region.parts)
        case described.AnyOf():
            return max(depth(part, point) for part in region.parts)
        case described.Outside():
            return -depth(region.part, point)
