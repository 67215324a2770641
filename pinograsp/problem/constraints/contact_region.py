"""Contact region: all that pad and object touch is in the part of the surface where contact may be, (14).

The paper asks this of the contact point alone, and so does a task with `contact_regions: point`. Otherwise every ray of
a footprint counts, at its end, and at some points on the way if the region is not convex. A ray that the object ends
has no slope where it ends, so that its row reads

    inside by INACTIVE      if the last points of the footprint there are in the region,
    membership of its end   if they are not: what moves the pad away from there is then known.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ...arrays import Array
from ...descriptions.regions import Region
from ...geometry.regions import is_convex, membership
from ..constraint import PER_METRE, Inside, Residual, Violation
from ..footprint import RAYS, Ray, rays
from ..state import State
from ..task_model import TaskModel
from .footprint_region import FootprintRegion

INACTIVE = 0.03
"""Value of a row that has nothing to say, m."""
ON_THE_BORDER = 1e-6
"""How far last points may be outside: an edge of the object may be the border of the region, m."""
SHARES = (1.0,), (0.25, 0.5, 0.75, 1.0)
"""Where on a ray points are looked at, of a convex region and of another one."""

Reach = Callable[[State, int], list[Ray]]
"""How far the contact of a pad reaches beyond its point."""


class ContactRegion(Inside):
    """Smooth membership of the footprint along each ray, or of the contact point where there are no rays, m.

    Args:
        model: the task.
        region: where contact may be, object's frame.
        reach: rays of the contact of a pad.
        most: rays of each pad at most.
    """

    name = "contact region"
    figures: Mapping[str, str] = {"contact region": "mm"}
    scale = PER_METRE
    least = 2e-6
    """How far inside its region a footprint must be, m: the solver's tolerance must not let it out."""

    def __init__(self, model: TaskModel, region: Region, reach: Reach, most: list[int]) -> None:
        self._region, self._T_world_object = membership(region), model.T_world_object
        self._shares = np.array(SHARES[0] if is_convex(region) else SHARES[1])[:, None]
        self._reach, self._most = reach, most
        rows = [
            (pad.name, f", ray {ray + 1}" if count else "")
            for pad, count in zip(model.robot.description.pads, most, strict=True)
            for ray in range(max(1, count))
        ]
        self._pads = [pad for pad, _ in rows]
        self.rows = tuple(f"contact region of {pad}{ray}" for pad, ray in rows)

    def inside(self, state: State) -> Residual:
        values, jacobian = np.full(len(self.rows), INACTIVE), np.zeros((len(self.rows), len(state.x)))
        row = 0
        for pad, count in enumerate(self._most):
            c, d_c = state.contacts.points[pad], state.contacts.d_points[pad]
            found = self._reach(state, pad) or [Ray(c, d_c)]
            ends = np.array([ray.end for ray in found])
            inside, slopes = self._membership((c + self._shares * (ends[:, None] - c)).reshape(-1, 3))
            inside, slopes = inside.reshape(len(found), -1), slopes.reshape(len(found), -1, 3)
            for i, ray in enumerate(found):
                if ray.last is None or self._is_outside(c, ray.last):
                    worst = int(inside[i].argmin())
                    share = self._shares[worst, 0]
                    values[row + i] = inside[i, worst]
                    jacobian[row + i] = slopes[i, worst] @ ((1.0 - share) * d_c + share * ray.d_end)
            row += max(1, count)
        return Residual(values, jacobian)

    def _is_outside(self, point: Array, last: Array) -> bool:
        """Return whether some of the footprint on the way to its last points is outside the region."""
        between = (point + self._shares * (last[:, None] - point)).reshape(-1, 3)
        return bool(self._membership(between)[0].min() < -ON_THE_BORDER)

    def _membership(self, points: Array) -> tuple[Array, Array]:
        """Return membership (n,) of world points and its gradient (n, 3) in the world."""
        R, origin = self._T_world_object[:3, :3], self._T_world_object[:3, 3]
        values, gradients = self._region((points - origin) @ R)
        return values, gradients @ R.T

    def violations(self, state: State) -> list[Violation]:
        return [self.largest_violation(state, "mm", 1e3, self._pads)]


def contact_region(model: TaskModel) -> ContactRegion | FootprintRegion | None:
    """Return the constraint, or None if the whole surface is allowed."""
    region, pads = model.scene.region_of(model.task), model.robot.pads
    if region is None:
        return None
    if model.task.contact_regions == "point":
        return ContactRegion(model, region, lambda state, pad: [], [0] * len(pads))
    if model.surface.uneven:
        return FootprintRegion(model, region)
    return ContactRegion(model, region, rays, [RAYS.get(type(pad.patch), 0) for pad in pads])
