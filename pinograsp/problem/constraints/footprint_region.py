"""Footprint region: all that pad and object touch is in the part of the surface where contact may be, (14).

The paper asks this of the contact point alone (`contact_region`). Here every ray of a footprint counts, at its end, and
at some points on the way if the region is not convex. A ray that the object ends has no slope where it ends, so that
its row reads

    inside by INACTIVE      if the last points of the footprint there are in the region,
    membership of its end   if they are not: what moves the pad away from there is then known.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...arrays import Array
from ...geometry.regions import Membership, is_convex
from ..constraint import PER_METRE, Inside, Residual, Violation
from ..footprint import RAYS, Ray, rays
from ..state import State
from ..task_model import TaskModel

INACTIVE = 0.03
"""Value of a row that has nothing to say, m."""
ON_THE_BORDER = 1e-6
"""How far last points may be outside: an edge of the object may be the border of the region, m."""
SHARES = (1.0,), (0.25, 0.5, 0.75, 1.0)
"""Where on a ray points are looked at, of a convex region and of another one."""


class FootprintRegion(Inside):
    """Smooth membership of the footprint along each ray, or of the contact point where there are no rays, m.

    Args:
        model: the task.
        region: where contact may be, object's frame.
        convex: whether the region is convex.
    """

    name = "contact region"
    figures: Mapping[str, str] = {"contact region": "mm"}
    scale = PER_METRE
    least = 2e-6
    """How far inside its region a footprint must be, m: the solver's tolerance must not let it out."""

    def __init__(self, model: TaskModel, region: Membership, convex: bool) -> None:
        self._region, self._T_world_object = region, model.T_world_object
        self._shares = np.array(SHARES[0] if convex else SHARES[1])[:, None]
        self._rays = [RAYS.get(type(pad.patch), 0) for pad in model.robot.pads]
        names = [pad.name for pad in model.robot.description.pads]
        self._pad_of = [name for name, count in zip(names, self._rays, strict=True) for _ in range(max(1, count))]
        self.rows = tuple(
            f"contact region of {name}{f', ray {ray + 1}' if count else ''}"
            for name, count in zip(names, self._rays, strict=True)
            for ray in range(max(1, count))
        )

    def inside(self, state: State) -> Residual:
        values, jacobian = np.full(len(self.rows), INACTIVE), np.zeros((len(self.rows), len(state.x)))
        row = 0
        for pad, count in enumerate(self._rays):
            c, d_c = state.contacts.points[pad], state.contacts.d_points[pad]
            found = rays(state, pad) or [Ray(c, d_c)]
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
        values = self.inside(state).values
        worst = int(values.argmin())
        outside = max(0.0, 1e3 * float(self.least - values[worst]))
        return [Violation("contact region", outside, "mm", self._pad_of[worst], size=outside)]


def footprint_region(model: TaskModel) -> FootprintRegion | None:
    """Return the constraint, or None if the whole surface is allowed, or only contact points are to be in a region."""
    region = model.task.contact_region
    if model.region is None or region is None or model.task.contact_regions != "footprint":
        return None
    return FootprintRegion(model, model.region, is_convex(region))
