"""Contact region on an uneven object: all that a pad touches is in the part of the surface where contact may be.

Pads lie on the mean of an uneven surface and touch it where the rubber, pressed in, reaches it. It is looked at from
points p all over the face of a pad, with z the direction out of the pad, d the signed distance to the object and
m the membership of the region:

    q = p + d(p) z     about the place of the surface below p
    value              max(m(q), d(p) - depth of the rubber, FACING (n(p) . z + 1/2)),  n the normal of the object

A point is fine if what is below it is in the region, is not touched, or does not face the pad, as beyond an edge that
the pad stands over. A row is the least value over a cell of a pad's face, or that of the contact point of a pad that is
not flat.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ...arrays import Array
from ...descriptions.patches import LinePatch, Patch, PlanePatch
from ...descriptions.regions import Region
from ...geometry.patches import rectangle
from ...geometry.regions import membership
from ..constraint import PER_METRE, Inside, Residual, Violation
from ..footprint import frame, moves
from ..state import State
from ..task_model import TaskModel

CELLS = 4
"""A pad's face has so many cells along each edge, each with a row: the places of least values move on with the pad."""
SPACING = 0.0025
"""Largest distance of neighbouring points of a cell, m."""
FACING = 0.01
"""Value of a point whose normal is 90 degrees off that of the pad, twice, m."""


class FootprintRegion(Inside):
    """Smooth membership of what the pads touch, m.

    Args:
        model: the task, of an uneven object.
        region: where contact may be, object's frame.
    """

    name = "contact region"
    figures: Mapping[str, str] = {"contact region": "mm"}
    scale = PER_METRE
    least = 2e-5
    """How far inside its region a footprint must be, m: between the points it may come nearer to the border."""

    def __init__(self, model: TaskModel, region: Region) -> None:
        self._region, self._model = membership(region), model
        self._depths = [pad.rubber_depth for pad in model.robot.description.pads]
        self._cells = [_cells(pad.patch) for pad in model.robot.pads]
        named = zip(model.robot.description.pads, self._cells, strict=True)
        self._pads = [pad.name for pad, cells in named for _ in range(max(1, len(cells)))]
        self.rows = tuple(f"contact region of {pad}, {row + 1}" for row, pad in enumerate(self._pads))

    def inside(self, state: State) -> Residual:
        values, jacobian, row = np.empty(len(self.rows)), np.zeros((len(self.rows), len(state.x))), 0
        for pad, cells in enumerate(self._cells):
            if not len(cells):
                found, slopes = self._membership(state.contacts.points[pad][None])
                values[row], jacobian[row] = found[0], slopes[0] @ state.contacts.d_points[pad]
                row += 1
                continue
            R, origin = frame(state, pad)
            points = cells.reshape(-1, 3) @ R.T + origin
            distances, normals, hessians = state.model.object_surface(points)
            z = R[:, 2]
            feet = points + distances[:, None] * z
            found, slopes = self._membership(feet)
            values_of = np.array([found, distances - self._depths[pad], FACING * (normals @ z + 0.5)])
            inside, size = values_of.max(axis=0).reshape(len(cells), -1), cells.shape[1]
            for worst in (inside.argmin(axis=1) + np.arange(len(cells)) * size).tolist():
                with_pad = moves(state, pad, points[worst])
                nearer = normals[worst] @ with_pad
                match int(values_of[:, worst].argmax()):
                    case 0:
                        slope = slopes[worst] @ moves(state, pad, feet[worst]) + (slopes[worst] @ z) * nearer
                    case 1:
                        slope = nearer
                    case _:
                        turn = moves(state, pad, points[worst] + z) - with_pad
                        slope = FACING * (z @ hessians[worst] @ with_pad + normals[worst] @ turn)
                values[row], jacobian[row] = values_of[:, worst].max(), slope
                row += 1
        return Residual(values, jacobian)

    def _membership(self, points: Array) -> tuple[Array, Array]:
        """Return membership (n,) of world points and its gradient (n, 3) in the world."""
        R, origin = self._model.T_world_object[:3, :3], self._model.T_world_object[:3, 3]
        values, gradients = self._region((points - origin) @ R)
        return values, gradients @ R.T

    def violations(self, state: State) -> list[Violation]:
        return [self.largest_violation(state, "mm", 1e3, self._pads)]


def _cells(patch: Patch) -> Array:
    """Return points of the face of a flat pad in its frame, shape (cells, n, 3), m; none of another pad."""
    if not isinstance(patch, PlanePatch | LinePatch):
        return np.zeros((0, 0, 3))
    lines = []
    for low, high in rectangle(patch):
        count = max(1, math.ceil((high - low) / (CELLS * SPACING)))
        every = np.linspace(low, high, CELLS * count + 1)
        lines.append([every[k * count : (k + 1) * count + 1] for k in range(CELLS)])
    grids = [np.stack(np.meshgrid(x, y, [0.0]), axis=-1).reshape(-1, 3) for x in lines[0] for y in lines[1]]
    return np.array(grids)
