"""Smooth membership of regions: m(p) >= 0 only inside, with gradient, m.

A combination is joined by smooth minima and maxima that err to the safe side, by at most rho log(parts):

    all of:  -rho log sum exp(-m_j / rho)              <=  min m_j
    any of:   rho log sum exp(m_j / rho) - rho log n   <=  max m_j

and `outside` of a combination is pushed down to its parts (de Morgan), so that it errs to the safe side too.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions import regions as described
from .painted import painted_surface

SMOOTHING = 0.0003
"""rho, m."""

Membership = Callable[[Array], tuple[Array, Array]]
"""Takes points (n, 3) in the object's frame; returns m (n,) and its gradient (n, 3)."""


def membership(region: described.Region) -> Membership:
    """Return the smooth membership of a region."""
    made: Membership = _MAKERS[type(region)](region, 1.0)
    return made


def is_convex(region: described.Region) -> bool:
    """Whether a region is known to be convex: a segment is inside if its ends are."""
    match region:
        case described.AllOf():
            return all(is_convex(part) for part in region.parts)
        case described.Outside():
            return isinstance(region.part, described.HalfSpace)
        case described.Sector():
            return region.half_width <= 0.5 * math.pi
        case described.Near():
            return is_convex(region.balls)
        case described.AnyOf():
            return len(region.parts) == 1 and is_convex(region.parts[0])
        case described.Painted():
            return False
    return True


def _signed(function: Membership, sign: float) -> Membership:
    def signed(points: Array) -> tuple[Array, Array]:
        values, gradients = function(points)
        return sign * values, sign * gradients

    return signed


def _half_space(region: described.HalfSpace, sign: float) -> Membership:
    normal = np.array(region.normal)
    return _signed(lambda points: (points @ normal - region.offset, np.tile(normal, (len(points), 1))), sign)


def _plane(normal: list[float], offset: float) -> described.HalfSpace:
    return described.HalfSpace(type="half_space", normal=tuple(normal), offset=offset)


def _band(region: described.Band, sign: float) -> Membership:
    low, high = region.z
    sides = [_plane([0.0, 0.0, 1.0], low), _plane([0.0, 0.0, -1.0], -high)]
    return _joined([_half_space(side, sign) for side in sides], smallest=sign > 0)


def _cuboid(region: described.Cuboid, sign: float) -> Membership:
    sides = [_plane(list(np.eye(3)[i]), region.min[i]) for i in range(3)]
    sides += [_plane(list(-np.eye(3)[i]), -region.max[i]) for i in range(3)]
    return _joined([_half_space(side, sign) for side in sides], smallest=sign > 0)


def _sector(region: described.Sector, sign: float) -> Membership:
    toward = np.array([math.cos(region.middle), math.sin(region.middle), 0.0])
    cosine = math.cos(region.half_width)

    def inside(points: Array) -> tuple[Array, Array]:
        # rho (cos(angle - middle) - cos(half_width)) with rho the distance from the axis
        rho = np.hypot(points[:, 0], points[:, 1])
        radial = np.zeros_like(points)
        radial[:, :2] = points[:, :2] / np.where(rho > 0.0, rho, 1.0)[:, None]
        return points @ toward - cosine * rho, toward - cosine * radial

    return _signed(inside, sign)


def _ball(region: described.Ball, sign: float) -> Membership:
    center = np.array(region.center)

    def inside(points: Array) -> tuple[Array, Array]:
        apart = points - center
        length = np.sqrt((apart * apart).sum(axis=1))
        return region.radius - length, -apart / np.where(length > 0.0, length, 1.0)[:, None]

    return _signed(inside, sign)


def _near(region: described.Near, sign: float) -> Membership:
    return _any_of(region.balls, sign)


def _painted(region: described.Painted, sign: float) -> Membership:
    surface = painted_surface(region)

    def inside(points: Array) -> tuple[Array, Array]:
        depths, gradients = surface.membership(points)
        return depths + region.beyond, gradients

    return _signed(inside, sign)


def _all_of(region: described.AllOf, sign: float) -> Membership:
    return _joined([_MAKERS[type(part)](part, sign) for part in region.parts], smallest=sign > 0)


def _any_of(region: described.AnyOf, sign: float) -> Membership:
    return _joined([_MAKERS[type(part)](part, sign) for part in region.parts], smallest=sign < 0)


def _outside(region: described.Outside, sign: float) -> Membership:
    made: Membership = _MAKERS[type(region.part)](region.part, -sign)
    return made


def _joined(parts: list[Membership], *, smallest: bool) -> Membership:
    """Return the smooth minimum or maximum, never above the true one."""
    direction = -1.0 if smallest else 1.0
    shift = 0.0 if smallest else SMOOTHING * math.log(len(parts))

    def joined(points: Array) -> tuple[Array, Array]:
        results = [part(points) for part in parts]
        values = direction * np.array([value for value, _ in results])
        top = values.max(axis=0)
        weights = np.exp((values - top) / SMOOTHING)
        total = weights.sum(axis=0)
        gradients = np.einsum("jn,jni->ni", weights / total, np.array([gradient for _, gradient in results]))
        return direction * (top + SMOOTHING * np.log(total)) - shift, gradients

    return joined


_MAKERS: dict[type, Any] = {
    described.HalfSpace: _half_space,
    described.Band: _band,
    described.Sector: _sector,
    described.Ball: _ball,
    described.Cuboid: _cuboid,
    described.Near: _near,
    described.Painted: _painted,
    described.AllOf: _all_of,
    described.AnyOf: _any_of,
    described.Outside: _outside,
}
