"""Looks beside triangles, which tell on which sides of them the inside of a body is.

A triangle is looked at in front and behind beside a place on it, its seat: where nothing else is between it and the
look, if there is such a place. Over an edge that two triangles share, a way leads from the seat of one to that of the
other. Where no triangle crosses it, both have the same sides: one look tells of all that hang together.

A triangle bounds the body if there is an outside next to it somewhere. Of one that others cross, or that has no seat of
which that can be said, it is asked at many places.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..arrays import Array, Indices, Mask
from .crossings import Crossings, crossings_of
from .openings import Openings
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
    crossings, close = crossings_of(of.vertices, of.faces, of.normals, looks, ALONE)
    clear = ~openings.near(of.middles, of.radii)
    seats = of.middles.copy()
    doubtful = np.flatnonzero(clear & close.any(axis=1))
    clear[doubtful], seats[doubtful] = _seats(of, doubtful, distances)
    told, teller = one_for_all(of.beside, linked(of, crossings, clear, seats), of.radii)
    front, back = contains(seats[told] + BESIDE * of.normals[told]), np.zeros(len(told), dtype=bool)
    asked = clear[told] | front  # what has an outside in front of it bounds the body, whatever is behind it
    back[asked] = contains((seats[told] - BESIDE * of.normals[told])[asked])
    front, back = front[teller], back[teller]
    inner = np.flatnonzero(front & back & (crossings.crossed | ~clear))
    bounding = ~front | ~back
    bounding[inner] = _has_outside(of, inner, crossings, clear[inner], seats[inner], distances, contains)
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
    steps = BESIDE * of.normals[numbers]
    return np.asarray((distances(places + steps) > ALONE) & (distances(places - steps) > ALONE))


def _has_outside(
    of: Triangles,
    numbers: Indices,
    crossings: Crossings,
    clear: Mask,
    seats: Array,
    distances: Distances,
    contains: Contains,
) -> Mask:
    """Return which triangles that have the inside on both sides of their seats have an outside next to them elsewhere.

    Where a way leads to from a place that tells, a seat or another one where they are alone, is as it is there.
    """
    found = np.zeros(len(numbers), dtype=bool)
    known, tells = seats[:, None], clear[:, None]
    for shares in _PLACES:
        rest = np.flatnonzero(~found)
        places = of.at(shares, numbers)
        told = np.zeros(len(numbers), dtype=bool)
        for other in range(known.shape[1]):
            told[rest] |= tells[rest, other] & crossings.free(numbers[rest], known[rest, other], places[rest])
        rest = rest[~told[rest]]
        for step in (BESIDE, -BESIDE):
            asked = rest[~found[rest]]
            found[asked] = ~contains(places[asked] + step * of.normals[numbers[asked]])
        rest = rest[clear[rest]]
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
