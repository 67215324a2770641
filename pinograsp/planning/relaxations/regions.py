"""Larger regions of contact."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...descriptions.regions import AllOf, AnyOf, Ball, Band, Cuboid, HalfSpace, Near, Outside, Region
from ...errors import InputError
from .variant import SMALL, Failure, Variant, place


def regions(failure: Failure) -> Iterator[Variant]:
    """Yield larger regions of contact: what is allowed grows, what is forbidden shrinks."""
    task = failure.task
    if task.contact_region is None:
        return

    def changes(size: float) -> Mapping[str, Any]:
        found = {}
        for key, by in (("allowed_contacts", size), ("forbidden_contacts", -size)):
            region = getattr(task, key)
            if region is not None:
                found[place("tasks", failure.task_name, key)] = grown(region, by).model_dump(mode="json")
        return found

    def text(size: float) -> str:
        return f"a contact region that is {1e3 * size:.1f} mm larger on every side"

    yield Variant("region", "m", 1e-4, changes, lambda size: size, text, SMALL)


def grown(region: Region, by: float) -> Region:
    """Return a region that reaches farther on every side, or less far, m.

    Raises:
        InputError: nothing is left of it, or a part has no size that could be grown.
    """
    match region:
        case AllOf() | AnyOf():
            return region.model_copy(update={"parts": tuple(grown(part, by) for part in region.parts)})
        case Outside():
            return Outside(part=grown(region.part, -by))
        case Ball() | Near():
            return region.model_copy(update={"radius": region.radius + by})
        case Band():
            return Band(z=(region.z[0] - by, region.z[1] + by))
        case HalfSpace():
            return region.model_copy(update={"offset": region.offset - by})
        case Cuboid():
            low, high = (np.array(corner) for corner in (region.min, region.max))
            return Cuboid(min=tuple((low - by).tolist()), max=tuple((high + by).tolist()))
    raise InputError(f"a region of type {region.type} has no size that grows")
