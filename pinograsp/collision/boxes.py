"""What is near by bounding boxes: they are much tighter than bounding spheres around long solids."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled

ROUNDING = 1e-9
"""What a bound may be too large by, m."""


def half_edges(shape: Any) -> Array:
    """Return half the edges of the bounding box of a Coal geometry, m, shape (3,)."""
    return np.asarray(0.5 * (shape.aabb_local.max_ - shape.aabb_local.min_))


@compiled
def _box_gap(first: Array, half: Array, second: Array, other_half: Array, apart: Array) -> float:
    """Return how far two boxes are apart at least: their gap along that edge of one of them where it is widest, m.

    Args:
        first: rotation of the first box, its edges as columns, shape (3, 3).
        half: half its edges, m, shape (3,).
        second: rotation of the second box, shape (3, 3).
        other_half: half its edges, m, shape (3,).
        apart: from the centre of the first to that of the second, m, shape (3,).
    """
    widest = -np.inf
    for side in range(2):
        axes, others = (first, second) if side == 0 else (second, first)
        own, theirs = (half, other_half) if side == 0 else (other_half, half)
        for i in range(3):
            gap = abs(axes[0, i] * apart[0] + axes[1, i] * apart[1] + axes[2, i] * apart[2]) - own[i]
            for j in range(3):
                along = axes[0, i] * others[0, j] + axes[1, i] * others[1, j] + axes[2, i] * others[2, j]
                gap -= theirs[j] * abs(along)
            widest = max(widest, gap)
    return widest


@compiled
def near_pairs(
    candidates: Indices,
    rotations: Array,
    translations: Array,
    at: Array,
    radii: Array,
    halves: Array,
    normals: Array,
    offsets: Array,
    first: Indices,
    second: Indices,
    reach: Array,
) -> Indices:
    """Return the pairs that can be nearer than their reach, from bounding spheres and boxes.

    Args:
        candidates: pairs that are looked at, shape (candidates,).
        rotations: rotations of the solids, shape (solids, 3, 3).
        translations: translations of the solids, world, m, shape (solids, 3).
        at: centres of the bounding spheres and boxes, world, m, shape (solids, 3).
        radii: of the solids, m, shape (solids,); infinite for walls.
        halves: half edges of the bounding boxes, m, shape (solids, 3).
        normals: of the walls, inward, in their own frames, shape (solids, 3).
        offsets: of the walls: normal . p on them, m, shape (solids,).
        first: solid of every pair, shape (pairs,).
        second: solid or wall of every pair, shape (pairs,).
        reach: of every pair, m, shape (pairs,).
    """
    near = np.empty(len(candidates), dtype=np.intp)
    count, apart = 0, np.empty(3)
    for pair in candidates:
        a, b = first[pair], second[pair]
        if math.isinf(radii[b]):
            height, extent = -offsets[b], 0.0
            apart[:] = 0.0  # the wall's normal in the frame of the other solid
            for axis in range(3):
                inward = 0.0
                for k in range(3):
                    inward += rotations[b, axis, k] * normals[b, k]
                height += (at[a, axis] - translations[b, axis]) * inward
                for k in range(3):
                    apart[k] += rotations[a, axis, k] * inward
            for k in range(3):
                extent += halves[a, k] * abs(apart[k])
            close = height - min(radii[a], extent) < reach[pair] + ROUNDING
        else:
            square, limit = 0.0, reach[pair] + radii[a] + radii[b]
            for axis in range(3):
                apart[axis] = at[b, axis] - at[a, axis]
                square += apart[axis] ** 2
            close = square < limit * limit
            if close:
                close = _box_gap(rotations[a], halves[a], rotations[b], halves[b], apart) < reach[pair] + ROUNDING
        if close:
            near[count] = pair
            count += 1
    return near[:count].copy()


@compiled
def near_pieces(
    rows: Indices,
    members: Indices,
    R: Array,
    p: Array,
    placements: Array,
    centers: Array,
    halves: Array,
    rotations: Array,
    theirs: Array,
    their_halves: Array,
    most: Array,
) -> tuple[Indices, Indices, Indices, Array]:
    """Return the pairs of a link's pieces and obstacles' whose boxes may be nearer than `most`, with their gap.

    Args:
        rows: configurations in which the link's hull is near to an obstacle's piece, shape (k,).
        members: which pieces these are, shape (k,).
        R: rotations of the link's group, shape (N, 3, 3).
        p: its translations, m, shape (N, 3).
        placements: rotations of the link's pieces in the group, shape (pieces, 3, 3).
        centers: of their boxes in the group, m, shape (pieces, 3).
        halves: half edges of their boxes, m, shape (pieces, 3).
        rotations: of the obstacles' pieces in the world, shape (n, 3, 3).
        theirs: centres of their boxes in the world, m, shape (n, 3).
        their_halves: half edges of their boxes, m, shape (n, 3).
        most: m, shape (N,).
    """
    size = len(rows) * len(centers)
    which, pieces, found = np.empty(size, dtype=np.intp), np.empty(size, dtype=np.intp), np.empty(size, dtype=np.intp)
    bounds, count = np.empty(size), 0
    turned, apart = np.empty((3, 3)), np.empty(3)
    for k in range(len(rows)):
        n, member = rows[k], members[k]
        for piece in range(len(centers)):
            for i in range(3):
                apart[i] = theirs[member, i] - p[n, i]
                for j in range(3):
                    apart[i] -= R[n, i, j] * centers[piece, j]
                    turned[i, j] = 0.0
                    for m in range(3):
                        turned[i, j] += R[n, i, m] * placements[piece, m, j]
            gap = _box_gap(turned, halves[piece], rotations[member], their_halves[member], apart)
            if gap < most[n] + ROUNDING:
                which[count], pieces[count], found[count], bounds[count] = n, piece, member, gap - ROUNDING
                count += 1
    return which[:count].copy(), pieces[:count].copy(), found[:count].copy(), bounds[:count].copy()
