"""Exact membership of regions: the depth of points in a region, negative outside, m."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..descriptions import regions as described
from .painted import painted_depths


def depth(region: described.Region, point: Array) -> float:
    """Return how deep a point (3,), in the object's frame, is in a region; negative outside: see `depths`."""
    return float(depths(region, point[None])[0])


def depths(region: described.Region, points: Array) -> Array:
    """Return how deep points (n, 3), in the object's frame, are in a region, shape (n,); negative outside.

    Lower bounds of the distances to the region's border inside; the signs are exact.
    """
    match region:
        case described.HalfSpace():
            return np.asarray(points @ np.array(region.normal) - region.offset)
        case described.Band():
            return np.asarray(np.minimum(points[:, 2] - region.z[0], region.z[1] - points[:, 2]))
        case described.Sector():
            off = np.arctan2(points[:, 1], points[:, 0]) - region.middle
            off -= 2 * math.pi * np.rint(off / (2 * math.pi))
            return np.asarray((region.half_width - np.abs(off)) * np.hypot(points[:, 0], points[:, 1]))
        case described.Ball():
            return np.asarray(region.radius - np.linalg.norm(points - np.array(region.center), axis=1))
        case described.Cuboid():
            return np.asarray(np.minimum(points - np.array(region.min), np.array(region.max) - points).min(axis=1))
        case described.Near():
            return depths(region.balls, points)
        case described.Painted():
            return painted_depths(region, points)
        case described.AllOf():
            return np.asarray(np.min([depths(part, points) for part in region.parts], axis=0))
        case described.AnyOf():
            return np.asarray(np.max([depths(part, points) for part in region.parts], axis=0))
        case described.Outside():
            return -depths(region.part, points)
