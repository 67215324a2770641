"""Larger regions of contact."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...descriptions.regions import AllOf, AnyOf, Ball, Band, Cuboid, HalfSpace, Near, Outside, Painted, Region, Sector
from ...errors import InputError
from ...geometry.shapes import surface_of
from .variant import SMALL, Change, Failure, Variant, place


def regions(failure: Failure) -> Iterator[Change]:
    """Yield larger regions of contact: what is allowed grows, what is forbidden shrinks."""
    task = failure.task
    if task.contact_region is None:
        return

    corners = surface_of(failure.target.shape).tessellation().vertices
    about = float(np.hypot(corners[:, 0], corners[:, 1]).max())

    def changes(size: float) -> Mapping[str, Any]:
        found = {}
        for key, by in (("allowed_contacts", size), ("forbidden_contacts", -size)):
            region = getattr(task, key)
            if region is not None:
                found[place("tasks", failure.task_name, key)] = grown(region, by, about).model_dump(
                    mode="json", exclude_none=True
                )
        return found

    def text(size: float) -> str:
        return f"a contact region that is {1e3 * size:.1f} mm larger on every side"

    def tried(size: float) -> str:
        return f"a contact region that is up to {1e3 * size:.1f} mm larger on every side"

    yield Change("region", "m", 1e-4, SMALL, (Variant(changes, lambda size: size, text),), tried, True)


def grown(region: Region, by: float, about: float) -> Region:
    """Return a region that reaches farther on every side, or less far, m.

    Args:
        region: in the object's frame.
        by: how much farther, m; negative: less far.
        about: distance of the surface from the z axis at most, m: there a sector is wider by as much.

    Raises:
        InputError: nothing is left of it.
    """
    match region:
        case AllOf() | AnyOf():
            return region.model_copy(update={"parts": tuple(grown(part, by, about) for part in region.parts)})
        case Outside():
            return Outside(part=grown(region.part, -by, about))
        case Ball() | Near():
            return region.model_copy(update={"radius": region.radius + by})
        case Band():
            return Band(z=(region.z[0] - by, region.z[1] + by))
        case Sector():
            return _sector(region.middle, region.half_width + by / about)
        case HalfSpace():
            return region.model_copy(update={"offset": region.offset - by})
        case Cuboid():
            low, high = (np.array(corner) for corner in (region.min, region.max))
            return Cuboid(min=tuple((low - by).tolist()), max=tuple((high + by).tolist()))
        case Painted():
            return region.model_copy(update={"beyond": region.beyond + by})


def _sector(middle: float, half_width: float) -> Region:
    """Return a sector; as two of them where it is all around."""
    if half_width <= 0.0:
        raise InputError("nothing is left of a sector")
    if half_width < math.pi:
        return Sector(middle=middle, half_width=half_width)
    half = 0.75 * math.pi
    return AnyOf(parts=(Sector(middle=middle, half_width=half), Sector(middle=middle + math.pi, half_width=half)))
