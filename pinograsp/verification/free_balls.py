"""Points on the same side of a surface, because a way from one to the other crosses none of it.

No triangle reaches into the ball around a point whose radius is its distance from the nearest one. Where two such balls
overlap, the straight way from one middle to the other is in them. So the winding number is the same at both, if no
opening of the surface is near to this way.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arrays import Array, Indices, Mask
from ..compiled import compiled
from .openings import Openings

_OVERLAP = 1e-9
"""Least overlap of balls, m."""


def sides(
    points: Array, radii: Array, told: Mask, inside: Mask, openings: Openings, contains: Callable[[Array], Mask]
) -> Mask:
    """Return which points are inside, shape (n,), asking for few of those of which that is not told.

    Args:
        points: shape (n, 3), m.
        radii: their distances from the surface, m, shape (n,).
        told: of which points `inside` tells, shape (n,).
        inside: which are inside, shape (n,).
        openings: of the surface.
        contains: whether points, shape (n, 3), are inside.
    """
    rest = np.flatnonzero(~told)
    rest = rest[(-radii[rest]).argsort(kind="stable")]  # of large balls few lie apart
    partners = _partners(points, radii, np.concatenate([np.flatnonzero(told), rest]), len(rest), _OVERLAP)
    linked = np.flatnonzero(partners >= 0)
    ways = np.stack([points[rest[linked]], points[partners[linked]]], axis=1)
    doubtful = openings.near(ways, np.zeros(len(ways)))
    partners[linked[doubtful]] = -1
    found, asked = inside.copy(), rest[partners < 0]
    found[asked] = contains(points[asked])
    for point, partner in zip(rest.tolist(), partners.tolist(), strict=True):
        if partner >= 0:
            found[point] = found[partner]
    return found


@compiled
def _partners(points: Array, radii: Array, order: Indices, count: int, overlap: float) -> Indices:
    """Return of each of the last points of an order the one before it whose ball overlaps its own most; -1 if none."""
    found = np.full(count, -1)
    for k in range(count):
        at = len(order) - count + k
        one, most = order[at], overlap
        for other in order[:at]:
            square = 0.0
            for axis in range(3):
                square += (points[one, axis] - points[other, axis]) ** 2
            if square < (radii[one] + radii[other] - most) ** 2 and radii[one] + radii[other] > most:
                most, found[k] = radii[one] + radii[other] - np.sqrt(square), other
    return found
