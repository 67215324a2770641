"""The least depth of a whole footprint in a region: how far inside is what is least far inside, m.

The depth d(p) of `regions.depth` is concave for half-spaces, bands, boxes, balls and all_of them: its least value over
a line or a polygon is at a vertex. For sectors, any_of and outside it may be between the vertices. There the footprint
is divided into cells (lines, triangles), and on each cell bounds of d are computed:

    linear pieces    between their values at the cell's vertices
    ball             concave: above its values at the vertices, below its tangent plane at the cell's centre
    painted          within the cell's half-size of its value at the centre
    sector           within L s of its value at the centre, s the cell's half-size across z, L = sqrt(1 + h^2) and h the
                     larger of the sector's half-width and pi less that

which min, max and minus combine. Cells whose lower bound is within `RESOLUTION` of the least value seen are done, the
others are halved. The result is never more than the true least depth, and at most `RESOLUTION` less, if the number of
cells stays below `CELLS`.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from ..arrays import Array
from ..descriptions import regions as described
from .painted import painted_depths

RESOLUTION = 5e-7
"""m"""
CELLS = 5_000
"""Most cells that are looked at together; beyond, the lower bounds as they are stand for the depth."""
HALVINGS = 384
"""So often cells are halved, every sixth time at their longest edge: a metre comes down to 0.3 nm.

Bounds that are still apart then are so by rounding.
"""


def least_depth(region: described.Region, vertices: Array) -> float:
    """Return the least depth, m, of a footprint.

    Args:
        region: the region.
        vertices: a point, the ends of a line, or corners in order, shape (k, 3); or triangles, shape (n, 3, 3).
    """
    corners = vertices if vertices.ndim == 2 else np.unique(vertices.reshape(-1, 3), axis=0)
    best = float(_bounds(region, corners[:, None])[0].min())
    if vertices.shape == (1, 3) or _concave(region):
        return best
    cells = vertices if vertices.ndim == 3 else vertices[None] if len(vertices) == 2 else _fan(vertices)
    floor = best
    for halvings in itertools.count():
        if not len(cells):
            break
        lower, _ = _bounds(region, cells)
        best = min(best, float(_bounds(region, cells.mean(axis=1, keepdims=True))[0].min()))
        going = lower < best - RESOLUTION
        floor = min(floor, best, float(lower[~going].min(initial=math.inf)))
        if halvings == HALVINGS or 2 * np.count_nonzero(going) > CELLS:
            return min(floor, float(lower.min()))
        cells = _halved(region, cells[going], longest=halvings % 6 == 5)
    return floor


def _concave(region: described.Region) -> bool:
    match region:
        case described.AllOf():
            return all(_concave(part) for part in region.parts)
        case described.Outside():
            return isinstance(region.part, described.HalfSpace)
        case _:
            return not isinstance(region, described.Sector | described.AnyOf | described.Near | described.Painted)


def _bounds(region: described.Region, cells: Array) -> tuple[Array, Array]:
    """Return lower and upper bounds of the depth on cells, shape (cells, vertices, 3); exact for single points."""
    match region:
        case described.HalfSpace():
            return _linear(np.array([region.normal]), np.array([region.offset]), cells)
        case described.Band():
            rows = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
            return _linear(rows, np.array([region.z[0], -region.z[1]]), cells)
        case described.Cuboid():
            return _linear(
                np.vstack([np.eye(3), -np.eye(3)]), np.concatenate([region.min, np.negative(region.max)]), cells
            )
        case described.Ball():
            return _ball(region, cells)
        case described.Sector():
            return _sector(region, cells)
        case described.Painted():
            return _painted(region, cells)
        case described.Near():
            return _bounds(region.balls, cells)
        case described.AllOf():
            lowers, uppers = zip(*(_bounds(part, cells) for part in region.parts), strict=True)
            return np.min(lowers, axis=0), np.min(uppers, axis=0)
        case described.AnyOf():
            lowers, uppers = zip(*(_bounds(part, cells) for part in region.parts), strict=True)
            return np.max(lowers, axis=0), np.max(uppers, axis=0)
        case described.Outside():
            lower, upper = _bounds(region.part, cells)
            return -upper, -lower


def _linear(rows: Array, offsets: Array, cells: Array) -> tuple[Array, Array]:
    """Return bounds of the least of row . p - offset."""
    values = cells @ rows.T - offsets
    return values.min(axis=(1, 2)), values.max(axis=1).min(axis=1)


def _ball(ball: described.Ball, cells: Array) -> tuple[Array, Array]:
    away = cells - ball.center
    lower = ball.radius - np.linalg.norm(away, axis=2).max(axis=1)
    middle = away.mean(axis=1)
    distance = np.linalg.norm(middle, axis=1)
    # The tangent plane of -distance; at the centre of the ball every direction will do.
    outward = middle / np.maximum(distance, 1e-300)[:, None]
    rise = -np.einsum("ckj,cj->ck", away - middle[:, None], outward).min(axis=1)
    return lower, ball.radius - distance + rise


def _sector(sector: described.Sector, cells: Array) -> tuple[Array, Array]:
    flat = cells[:, :, :2]
    middle = flat.mean(axis=1)
    size = np.linalg.norm(flat - middle[:, None], axis=2).max(axis=1)
    turn = np.arctan2(middle[:, 1], middle[:, 0]) - sector.middle
    off = np.abs(np.remainder(turn + math.pi, 2 * math.pi) - math.pi)
    value = (sector.half_width - off) * np.hypot(middle[:, 0], middle[:, 1])
    reach = math.hypot(1.0, max(sector.half_width, math.pi - sector.half_width)) * size
    return value - reach, value + reach


def _painted(region: described.Painted, cells: Array) -> tuple[Array, Array]:
    middle = cells.mean(axis=1)
    size = np.linalg.norm(cells - middle[:, None], axis=2).max(axis=1)
    value = painted_depths(region, middle)
    return value - size, value + size


def _fan(corners: Array) -> Array:
    """Return a convex polygon as triangles, shape (triangles, 3, 3)."""
    first = np.broadcast_to(corners[0], (len(corners) - 2, 3))
    return np.stack([first, corners[1:-1], corners[2:]], axis=1)


def _halved(region: described.Region, cells: Array, *, longest: bool) -> Array:
    """Return cells cut through the middle of their longest edges, or of those along which depths are least certain.

    Edges of equal depth stay whole the second way: along a border of the region few cells are wanted. But the first
    way alone makes every cell small.
    """
    if cells.shape[1] == 2:
        middle = cells.mean(axis=1)
        return np.concatenate([np.stack([cells[:, 0], middle], axis=1), np.stack([middle, cells[:, 1]], axis=1)])
    edges = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2)
    lower, upper = _bounds(region, edges.reshape(-1, 2, 3))
    lengths = np.linalg.norm(edges[:, :, 1] - edges[:, :, 0], axis=2)
    # Of two edges that are about as uncertain the shorter one.
    doubt = (upper - lower).reshape(-1, 3) * (1.0 - 0.1 * lengths / lengths.max(axis=1, keepdims=True))
    chosen = lengths if longest else doubt
    order = (chosen.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(cells, order[:, :, None], axis=1).transpose(1, 0, 2)
    middle = 0.5 * (a + b)
    return np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
