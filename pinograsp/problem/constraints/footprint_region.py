"""Contact region on an uneven object: all that a pad touches is in the part of the surface where contact may be.

Pads lie on the mean of an uneven surface and touch it where the rubber, pressed in, reaches it. It is looked at from
points p of a grid on the face of a flat pad, with z the direction out of the pad, d the signed distance to the object
and m the membership of the region:

    q = p + d(p) z     about the place of the surface below p
    l = LIFT (d(p) - depth of the rubber)
    v = max(m(q), l)   not looked at if n(q) . z > -FACING, n being the normal of the object

A point is fine if what is below it is in the region, is not touched, or does not face the pad, as beyond an edge that
the pad stands over. There are two ways out: a pad that slides changes m, one that is tilted changes d. Sliding moves it
by as much as it is long, tilting lifts its rim by about the rubber's depth: hence `LIFT`. With less, all that is
outside would be lifted, against the contact gap.

Between a point i that is touched and inside and a neighbour j that is neither, v is less than at both where m and l
cross: by linear interpolation at a share t of the way to j. With the slopes m' and l' there along that way the value is

    v = (l' m(q) - m' l) / (l' - m'),    which does not change with t.

A row is the least v over a cell of a pad's face. The contact point always touches: a row of its own is its m.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Indices, cross
from ...descriptions.patches import LinePatch, Patch, PlanePatch
from ...descriptions.regions import Region
from ...geometry.patches import rectangle
from ...geometry.regions import membership
from ..constraint import PER_METRE, Inside, Residual, Violation
from ..footprint import frame
from ..state import State
from ..task_model import TaskModel

CELLS = 4
"""A pad's face has so many cells along each edge, each with a row: the places of least values move on with the pad."""
SPACING = 0.0025
"""Largest distance of neighbouring points along the edges of a face, m."""
LIFT = 20.0
"""Length of slide that counts as much as one of lift."""
NEAR = 0.004
"""Value of lift up to which it matters what is below a point, m."""
FACING = 0.5
"""Cosine of the largest angle between what is touched and the face of the pad."""
INACTIVE = 0.03
"""Value of a point that need not be in the region, m."""


class Grid(NamedTuple):
    """Points on the face of a flat pad."""

    points: Array
    """Patch frame, m, shape (n, 3)."""
    cells: Indices
    """Cell of each, shape (n,)."""
    edges: Indices
    """Pairs of neighbours along both axes and a diagonal, in either order, shape (e, 2)."""


class Looks(NamedTuple):
    """What is seen from points of a pad; world."""

    points: Array
    """p, m, shape (n, 3)."""
    feet: Array
    """q, m, shape (n, 3)."""
    lifts: Array
    """l, m, shape (n,)."""
    normals: Array
    """Gradient of d at p, shape (n, 3)."""
    inside: Array
    """m, shape (n,), m; infinite where q does not face the pad, minus infinite where l alone matters."""
    slopes: Array
    """Gradient of m at q, shape (n, 3)."""

    def at(self, which: Indices) -> Looks:
        """Return what is seen from some of the points."""
        return Looks(*(every[which] for every in self))


class FootprintRegion(Inside):
    """Membership of what the pads touch, m.

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
        self._grids = [_grid(pad.patch) for pad in model.robot.pads]
        named = zip(model.robot.description.pads, self._grids, strict=True)
        self._pads = [pad.name for pad, grid in named for _ in range(1 if grid is None else 1 + CELLS * CELLS)]
        self.rows = tuple(f"contact region of {pad}, {row + 1}" for row, pad in enumerate(self._pads))

    def inside(self, state: State) -> Residual:
        contacts = state.contacts
        found = []
        for pad, grid in enumerate(self._grids):
            values, slopes = self._membership(contacts.points[pad][None])
            found.append(Residual(values, slopes @ contacts.d_points[pad]))
            if grid is not None:
                found.append(self._of_grid(state, pad, grid))
        return Residual(*(np.concatenate(part) for part in zip(*found, strict=True)))

    def _of_grid(self, state: State, pad: int, grid: Grid) -> Residual:
        """Return the rows of a flat pad's cells."""
        R, origin = frame(state, pad)
        z, depth = R[:, 2], self._depths[pad]
        seen = self._looks(grid.points @ R.T + origin, z, depth, grid.edges)
        values = np.maximum(seen.inside, seen.lifts)
        worst = _least(values, grid.cells)
        rows, at = values[worst], seen.at(worst)
        shares = (at.inside >= at.lifts).astype(np.float64)
        between = self._crossings(seen, grid, rows, z, depth)
        if between is not None:
            cells, of_m, looked = between
            facing = np.isfinite(looked.inside)
            v = of_m * np.where(facing, looked.inside, INACTIVE) + (1.0 - of_m) * looked.lifts
            less = facing & (v < rows[cells])
            cells = cells[less]
            rows[cells], shares[cells] = v[less], of_m[less]
            for every, part in zip(at, looked, strict=True):
                every[cells] = part[less]
        jacobian = _jacobian(state, pad, at, shares, z)
        jacobian[rows > INACTIVE] = 0.0
        return Residual(np.minimum(rows, INACTIVE), jacobian)

    def _looks(self, points: Array, z: Array, depth: float, edges: Indices | None = None) -> Looks:
        """Look at what is below points, world, shape (n, 3).

        Args:
            points: of a pad.
            z: direction out of it, world.
            depth: of its rubber, m.
            edges: with neighbours of points that are next to being touched, of which no others matter; None: all do.
        """
        distances, normals, _ = self._model.object_surface(points)
        lifts, feet = LIFT * (distances - depth), points + distances[:, None] * z
        near = np.ones(len(points), dtype=bool)
        if edges is not None:
            near = lifts < NEAR
            near[edges[near[edges[:, 0]], 1]] = True
        inside, slopes = np.full(len(points), -math.inf), np.zeros((len(points), 3))
        inside[near], slopes[near] = self._membership(feet[near])
        outside = np.flatnonzero(near & (inside < 0.0))
        facing = self._model.object_surface(feet[outside])[1] @ z < -FACING
        inside[outside[~facing]] = math.inf
        return Looks(points, feet, lifts, normals, inside, slopes)

    def _crossings(
        self, seen: Looks, grid: Grid, rows: Array, z: Array, depth: float
    ) -> tuple[Indices, Array, Looks] | None:
        """Return places between neighbours where m and l cross below the rows of their cells; None if there are none.

        Returns:
            cells, at most one place in each, shape (k,); the shares of m in the values there; what is seen there.
        """
        ahead = seen.inside - seen.lifts
        may_touch = (ahead > 0.0) & (seen.lifts < NEAR) & np.isfinite(ahead)
        i, j = grid.edges[may_touch[grid.edges[:, 0]] & (ahead[grid.edges[:, 1]] < 0.0)].T
        falling, rising = seen.inside[i] - seen.inside[j], seen.lifts[j] - seen.lifts[i]
        t = ahead[i] / (ahead[i] - ahead[j])
        expected, cells = seen.inside[i] - t * falling, grid.cells[i]
        lower = np.flatnonzero((falling > 0.0) & (rising > 0.0) & (expected < rows[cells]))
        if not len(lower):
            return None
        order = lower[np.lexsort([expected[lower], cells[lower]])]
        least = order[np.unique(cells[order], return_index=True)[1]]
        i, j, t = i[least], j[least], t[least, None]
        looked = self._looks((1.0 - t) * seen.points[i] + t * seen.points[j], z, depth)
        ways = seen.points[j] - seen.points[i]
        approach = (looked.normals * ways).sum(axis=1)
        falling = np.maximum(0.0, -(looked.slopes * ways).sum(axis=1) - (looked.slopes @ z) * approach)
        rising = np.maximum(0.0, LIFT * approach)
        return cells[least], rising / np.maximum(rising + falling, np.finfo(float).tiny), looked

    def _membership(self, points: Array) -> tuple[Array, Array]:
        """Return membership (n,) of world points and its gradient (n, 3) in the world."""
        R, origin = self._model.T_world_object[:3, :3], self._model.T_world_object[:3, 3]
        values, gradients = self._region((points - origin) @ R)
        return values, gradients @ R.T

    def violations(self, state: State) -> list[Violation]:
        return [self.largest_violation(state, "mm", 1e3, self._pads)]


def _least(values: Array, cells: Indices) -> Indices:
    """Return the number of the least value of each cell, shape (cells,)."""
    order = np.lexsort([values, cells])
    return np.asarray(order[np.unique(cells[order], return_index=True)[1]])


def _jacobian(state: State, pad: int, seen: Looks, shares: Array, z: Array) -> Array:
    """Return the derivatives in x of shares of m and the rest of l, shape (r, v).

    The velocity of a point of the pad at p is that of the contact point and a turn, to which a gradient g there adds
    the moment of g about the contact point.
    """
    contacts, B = state.contacts, state.model.robot.B
    at_feet = shares[:, None] * seen.slopes
    at_points = ((at_feet @ z) + LIFT * (1.0 - shares))[:, None] * seen.normals
    moments = cross(seen.feet - contacts.points[pad], at_feet) + cross(seen.points - contacts.points[pad], at_points)
    jacobian = np.zeros((len(shares), len(state.x)))
    jacobian[:, : B.shape[1]] = ((at_feet + at_points) @ contacts.linear[pad] + moments @ contacts.angular[pad]) @ B
    return jacobian


def _grid(patch: Patch) -> Grid | None:
    """Return points on the face of a flat pad; None of another pad."""
    if not isinstance(patch, PlanePatch | LinePatch):
        return None
    lines = []
    for low, high in rectangle(patch):
        lines.append(np.linspace(low, high, 1 + CELLS * max(1, math.ceil((high - low) / (CELLS * SPACING)))))
    x, y = lines
    points = np.stack(np.meshgrid(x, y, [0.0], indexing="ij"), axis=-1).reshape(-1, 3)
    rows, columns = (np.minimum(np.arange(len(line)) * CELLS // (len(line) - 1), CELLS - 1) for line in lines)
    number = np.arange(len(points)).reshape(len(x), len(y))
    ways = (number[:-1], number[1:]), (number[:, :-1], number[:, 1:]), (number[:-1, :-1], number[1:, 1:])
    pairs = np.concatenate([np.column_stack([first.ravel(), second.ravel()]) for first, second in ways])
    return Grid(points, (CELLS * rows[:, None] + columns).ravel(), np.concatenate([pairs, pairs[:, ::-1]]))
