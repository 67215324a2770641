"""Looks beside triangles, which tell on which sides of them the inside of a body is.

A triangle is looked at in front and behind beside a place on it, its seat: where nothing else is between it and the
look, if there is such a place. Over an edge that two triangles share, a way leads from the seat of one to that of the
other. Where no triangle crosses it, both have the same sides: one look tells of all that hang together.

A triangle bounds the body if there is an outside next to it somewhere. Of one that others cross, or that has no seat of
which that can be said, it is looked at many places. A look is as another one that a straight way leads to, clear of all
triangles; of the rest it is asked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..arrays import Array, Indices, Mask
from .crossings import Around, Crossings, crossings_of
from .openings import Openings, rods
from .plain_faces import Triangles

BESIDE = 1e-6
"""How far beside a triangle it is asked whether there is an outside, m."""
ALONE = 0.999 * BESIDE
"""How far all that does not lie on a triangle is from a look that tells of it, at least, m: nothing is between them."""
PLACES = 4
"""On a triangle, along each of its edges."""

Distances = Callable[[Array], Array]
"""From points, shape (n, 3), to the nearest triangle, m, shape (n,)."""
Contains = Callable[[Array], Mask]
"""Whether points, shape (n, 3), are inside, shape (n,)."""


def _places() -> Array:
    """Return shares of the corners of a triangle, shape (n, 3), its middle first."""
    grid = [(i, j, PLACES - 1 - i - j) for i in range(PLACES) for j in range(PLACES - i)]
    shares = (np.array(grid) + 0.1) / (PLACES - 1 + 0.3)
    return np.asarray(shares[(shares * shares).sum(axis=1).argsort(kind="stable")])


_PLACES = _places()


def seen(of: Triangles, openings: Openings, distances: Distances, contains: Contains) -> dict[str, Any]:
    """Return what `Sides` needs of triangles.

    Args:
        of: the triangles.
        openings: of their surface.
        distances: to the triangles.
        contains: whether points are inside of what they enclose.
    """
    looks = np.stack([of.middles + step * of.normals for step in (BESIDE, -BESIDE)], axis=1)
    crossings, around, close = crossings_of(of.vertices, of.faces, of.normals, looks, ALONE)
    longest, heights = rods(of.corners)
    closed = ~openings.near(longest, heights + BESIDE)
    clear, seats = closed.copy(), of.middles.copy()
    doubtful = np.flatnonzero(clear & close.any(axis=1))
    clear[doubtful], seats[doubtful] = _seats(of, doubtful, distances)
    told, teller = one_for_all(of.beside, linked(of, crossings, clear, seats), of.radii)
    front, back = contains(seats[told] + BESIDE * of.normals[told]), np.zeros(len(told), dtype=bool)
    asked = clear[told] | front  # what has an outside in front of it bounds the body, whatever is behind it
    back[asked] = contains((seats[told] - BESIDE * of.normals[told])[asked])
    front, back = front[teller], back[teller]
    inner = np.flatnonzero(front & back & (crossings.crossed | ~clear))
    bounding = ~front | ~back
    within = _Inner(of, inner, seats[inner], closed[inner], clear[inner])
    bounding[inner] = _has_outside(within, crossings, around, distances, contains)
    return {
        **{"front": front, "back": back, "clear": clear, "seats": seats, "bounding": bounding},
        **{"starts": crossings.starts, "others": crossings.others},
    }


def _seats(of: Triangles, numbers: Indices, distances: Distances) -> tuple[Mask, Array]:
    """Return of which triangles there is a place where they are alone, shape (n,), and it or else their middle."""
    found, seats = np.zeros(len(numbers), dtype=bool), of.middles[numbers]
    for shares in _PLACES:
        rest = np.flatnonzero(~found)
        places = of.at(shares, numbers[rest])
        alone = _alone(of, numbers[rest], places, distances)
        found[rest[alone]], seats[rest[alone]] = True, places[alone]
    return found, seats


def _alone(of: Triangles, numbers: Indices, places: Array, distances: Distances) -> Mask:
    """Return at which places on triangles, shape (n, 3), nothing else is near to looks in front of them and behind."""
    return np.asarray((distances(_beside(of, numbers, places)) > ALONE).reshape(2, -1).all(axis=0))


def _beside(of: Triangles, numbers: Indices, places: Array) -> Array:
    """Return looks in front of places on triangles, shape (n, 3), and after them those behind, m, shape (2 n, 3)."""
    steps = BESIDE * of.normals[numbers]
    return np.concatenate([places + steps, places - steps])


@dataclass(frozen=True)
class _Inner:
    """Triangles with the inside on both sides of their seats."""

    of: Triangles
    """All triangles."""
    numbers: Indices
    """Of these, shape (n,)."""
    seats: Array
    """Shape (n, 3), m."""
    closed: Mask
    """Which have no opening near to them, shape (n,)."""
    clear: Mask
    """Which of these are alone at their seats, shape (n,)."""


def _has_outside(inner: _Inner, crossings: Crossings, around: Around, distances: Distances, contains: Contains) -> Mask:
    """Return which triangles have an outside next to them elsewhere, shape (n,).

    Where a way on a triangle leads to from a place that tells, a seat or another one where it is alone, is as it is
    there; so is a look that a way leads to from the look at the seat, clear of all triangles.
    """
    of, numbers = inner.of, inner.numbers
    found = np.zeros(len(numbers), dtype=bool)
    known, tells = inner.seats[:, None], inner.clear[:, None]
    looks = _beside(of, numbers, inner.seats).reshape(2, -1, 3)
    for shares in _PLACES:
        rest = np.flatnonzero(~found)
        places = of.at(shares, numbers)
        told = np.zeros(len(numbers), dtype=bool)
        for other in range(known.shape[1]):
            told[rest] |= tells[rest, other] & crossings.free(numbers[rest], known[rest, other], places[rest])
        rest = rest[~told[rest]]
        asked = _beside(of, numbers[rest], places[rest])
        doubtful = ~np.tile(inner.closed[rest], 2) | ~around.avoided(looks[:, rest].reshape(-1, 3), asked)
        outside = np.zeros(len(asked), dtype=bool)
        outside[doubtful] = ~contains(asked[doubtful])
        found[rest] = outside.reshape(2, -1).any(axis=0)
        rest = rest[inner.clear[rest]]
        told[rest] = _alone(of, numbers[rest], places[rest], distances)
        known = np.concatenate([known, places[:, None]], axis=1)
        tells = np.column_stack([tells, told])
    return found


def linked(of: Triangles, crossings: Crossings, clear: Mask, seats: Array) -> Mask:
    """Return at which edges, opposite each corner, a way leads from one triangle to its neighbour, shape (f, 3).

    Both face the same way, and are clear of what would keep one look from telling of them.

    Args:
        of: the triangles.
        crossings: of them.
        clear: which are, shape (f,).
        seats: places on them, shape (f, 3), m.
    """
    one, corner = np.nonzero((of.beside >= 0) & clear[:, None] & clear[of.beside])
    other = of.beside[one, corner]
    start, end = of.faces[one, (corner + 1) % 3], of.faces[one, (corner + 2) % 3]
    along = of.faces[other] == start[:, None]
    against = np.roll(of.faces[other], 1, axis=1) == end[:, None]
    alike = (along & against).any(axis=1)  # each has the edge the other way round
    over = 0.5 * (of.vertices[start] + of.vertices[end])
    for number in (one, other):
        alike &= crossings.free(number, seats[number], over)
    found = np.zeros(of.faces.shape, dtype=bool)
    found[one, corner] = alike
    return found


def one_for_all(beside: Indices, linked: Mask, sizes: Array) -> tuple[Indices, Indices]:
    """Return triangles that tell of all which side of them is inside: of those that hang together, the largest.

    Args:
        beside: their neighbours, as of `neighbours`, shape (f, 3).
        linked: to which of these each is linked, shape (f, 3).
        sizes: shape (f,).

    Returns:
        the triangles, shape (n,), and of each triangle the index of the one that tells of it, shape (f,).
    """
    one, other = np.nonzero(linked)[0], beside[linked]
    graph = coo_matrix((np.ones(len(one)), (one, other)), shape=(len(sizes), len(sizes)))
    _, group = connected_components(graph, directed=False)
    order = np.lexsort((sizes, group))
    last = np.append(group[order][1:] != group[order][:-1], True)
    return order[last], group
