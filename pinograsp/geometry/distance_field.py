"""The signed distance of a mesh as a smooth function of space, and the normal that a pad feels.

Two fields, each twice continuously differentiable (see `lattice`):

    d(p)    signed distance: exact at the nodes of a fine lattice within `EXACT` spacings of the surface
    s(p)    d convolved with a Gaussian of standard deviation sigma (see `descriptions.mesh_contact`);
            its gradient g gives the footprint normal n = g / |g|, dn/dp = (I - n n^T) Hess s / |g|

Farther from the surface the values at the nodes go over, until `BLENDED` spacings from it, to those of a coarse lattice
that reaches `AROUND` beyond the body. A fine node there has the value of the coarse spline, so that both functions are
the same where the fine lattice ends. Which nodes are near is known from the distances at every `APART`-th of them: at
others it is no less than there, less the way. Beyond the coarse lattice, with q the nearest point of it to p,

    d(p) = d(q) + |p - q|     an upper bound of the distance;     AROUND + |p - q| is a lower one.

Signs: the segment between two nodes that are farther from the surface, together, than from each other does not cross
it. So nodes are joined to regions of one sign, and only one node of each region, and those next to the surface, are
asked whether the surface goes around them.
"""

from __future__ import annotations

import math
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, label, maximum_filter

from ..arrays import Array, Indices
from ..descriptions.mesh_contact import FACES, SIGMAS, THICK_SHARE
from .exact_distance import ExactDistance
from .field_kernels import AROUND, coarse_values
from .field_nodes import farthest_nodes, nodes_between, some_nodes
from .hulls import areas
from .lattice import RIM, Lattice, lattice_of, nodes

VERSION = 12
"""Of how fields are made; to be raised with every change that gives others."""

EXACT, BLENDED = 4.0, 6.0
"""Distances from the surface up to which nodes are exact, and from which on they are those of the coarse lattice, in
spacings."""
MARGIN = 8
"""Spacings from the body to where the fine lattice ends."""
FINEST, MOST_NODES = 0.0005, 3_100_000
"""Least spacing, m, and largest number of nodes of the fine lattice, which needs 8 bytes for each: with what is kept of
the mesh itself, less than 30 MB."""
COARSE_NODES = 60_000
APART = 4
"""Nodes of the fine lattice from one where the distance is asked for first to the next."""
ASKED = 1
"""Nodes of the coarse lattice's rim whose distances are asked for; those beyond go on as the last ones do."""
ROUGH = 0.1
"""How far the fine spline may lie above the distance between nodes where it is exact, in its spacings."""
SAFELY = 1.5
"""How far a spline may lie above the distance elsewhere, in parts of the most that is found at nodes around."""
_TRUNCATED = 3.0
"""Standard deviations where the Gaussian ends."""


class DistanceField(NamedTuple):
    """Splines of both fields; frame of the mesh."""

    distance: Lattice
    smoothed: Lattice
    coarse: Lattice
    above: NDArray[np.float32]
    """How far the fine spline may lie above the distance around every `APART`-th node of the fine lattice before its
    rim was cut off, m, shape (nx, ny, nz)."""
    error: float
    """How far the coarse spline may lie above the distance beyond the fine lattice, m."""


def footprint_sigma(exact: ExactDistance) -> float:
    """Return the standard deviation sigma that the thickness of a body allows, m: see `descriptions.mesh_contact`."""
    triangles = exact.vertices[exact.faces[:: math.ceil(len(exact.faces) / FACES)]]
    sizes = areas(triangles)
    a, b, c = triangles[sizes > 0.0].transpose(1, 0, 2)
    sizes = sizes[sizes > 0.0]
    normals = np.cross(b - a, c - a) / (2.0 * sizes[:, None])
    for sigma in SIGMAS[:-1]:
        thick = np.ones(len(sizes), dtype=bool)
        for depth in (sigma, 2.0 * sigma):
            thick[thick] = exact.inside(((a + b + c) / 3.0 - depth * normals)[thick])
            if sizes[thick].sum() < THICK_SHARE * sizes.sum():
                break
        else:
            return sigma
    return SIGMAS[-1]


def distance_field(exact: ExactDistance, sigma: float) -> DistanceField:
    """Return the fields of a closed mesh.

    Args:
        exact: distances to the mesh.
        sigma: standard deviation of the Gaussian, m.
    """
    low, high = exact.vertices.min(axis=0), exact.vertices.max(axis=0)
    coarse = _coarse(exact, low, high)
    h = max(FINEST, 0.5 * sigma, _spacing_of(high - low, MOST_NODES, 2 * MARGIN + 4))
    counts = tuple((np.ceil((high - low) / h).astype(int) + 1 + 2 * (MARGIN + 1 + RIM)).tolist())
    origin = 0.5 * (low + high) - 0.5 * h * (np.array(counts) - 1)
    known = _at_every(exact, origin, h, counts)
    distances, near = _exact_next_to(exact, _no_less(known, h, counts), BLENDED * h, origin, h)
    true = _signs(exact, distances, origin, h) * distances
    values = coarse_values(coarse, origin, h, counts)
    values = np.where(values * true > 0.0, values, true)
    flat, exactly = values.ravel(), true.ravel()[near]
    share = np.clip((np.abs(exactly) / h - EXACT) / (BLENDED - EXACT), 0.0, 1.0)
    share = share * share * (3.0 - 2.0 * share)
    flat[near] = share * flat[near] + (1.0 - share) * exactly
    every = (slice(None, None, APART),) * 3
    first = tuple(slice(count) for count in values[every].shape)
    beyond = SAFELY * (values[every] - np.copysign(known[first], true[every]))
    above = np.maximum(maximum_filter(beyond, 3, mode="nearest"), ROUGH * h)
    return DistanceField(
        lattice_of(values, origin, h),
        lattice_of(gaussian_filter(values, sigma / h, truncate=_TRUNCATED), origin, h),
        coarse,
        above.astype(np.float32),
        _most_outside(beyond),
    )


def _at_every(exact: ExactDistance, origin: Array, h: float, counts: tuple[int, ...]) -> Array:
    """Return the distances of every `APART`-th node along each axis, and of the next one after the last, m."""
    steps = tuple(math.ceil((count - 1) / APART) + 1 for count in counts)
    return exact.unsigned(nodes(origin, APART * h, steps)).reshape(steps)


def _no_less(known: Array, h: float, counts: tuple[int, ...]) -> Array:
    """Return lower bounds of the distances of all nodes, m, given those of every `APART`-th one along each axis."""
    shifted = [np.arange(count) + APART // 2 for count in counts]
    squares = [(h * (along % APART - APART // 2)) ** 2 for along in shifted]
    way = np.sqrt(squares[0][:, None, None] + squares[1][:, None] + squares[2])
    return np.asarray(known[np.ix_(*(along // APART for along in shifted))] - way)


def _most_outside(values: Array) -> float:
    """Return the largest of the two outermost values along each axis, which lie in the rim, at least 0."""
    rim = np.ones(values.shape, dtype=bool)
    rim[(slice(2, -2),) * 3] = False
    return max(0.0, float(values[rim].max()))


def _coarse(exact: ExactDistance, low: Array, high: Array) -> Lattice:
    size = high - low + 2.0 * AROUND
    h = _spacing_of(size, COARSE_NODES, 3)
    beyond = RIM - ASKED
    counts = tuple((np.ceil(size / h).astype(int) + 3 + 2 * ASKED).tolist())
    origin = 0.5 * (low + high) - 0.5 * h * (np.array(counts) - 1)
    distances = exact.unsigned(nodes(origin, h, counts)).reshape(counts)
    values = np.pad(_signs(exact, distances, origin, h) * distances, beyond, mode="reflect", reflect_type="odd")
    return lattice_of(values, origin - beyond * h, h)


def _exact_next_to(exact: ExactDistance, least: Array, within: float, origin: Array, h: float) -> tuple[Array, Indices]:
    """Return unsigned distances of the nodes of a lattice, exact next to the surface, and the numbers of these nodes.

    Those of other nodes are what they are at least. Of what may be near, every second node along each axis comes first.

    Args:
        exact: distances to the surface.
        least: what distances of the nodes are at least, changed here, m, shape (nx, ny, nz).
        within: distance of what is next to the surface, m.
        origin: of the first node, m, shape (3,).
        h: spacing, m.
    """
    counts, flat, second = least.shape, least.ravel(), least[::2, ::2, ::2]
    asked = np.argwhere(second < within)
    first = np.asarray(np.ravel_multi_index(tuple(2 * asked.T), counts))
    flat[first] = exact.unsigned(some_nodes(origin, h, counts, first))
    others = nodes_between(least, within, h)
    flat[others] = exact.unsigned(some_nodes(origin, h, counts, others))
    return least, np.concatenate([first, others])


def _spacing_of(size: Array, most: int, further: int) -> float:
    """Return the spacing at which a box, with some further nodes along each axis, has a number of nodes."""
    low, high = 0.0, float(size.max())
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.prod(size / middle + further) > most else (low, middle)
    return high


def _signs(exact: ExactDistance, distances: Array, origin: Array, h: float) -> NDArray[np.float64]:
    """Return 1 outside and -1 inside at the nodes of a lattice, given their unsigned distances, shape (nx, ny, nz)."""
    regions, count = label(distances > 0.501 * h)
    signs = np.where(regions > 0, 1.0, 0.0)
    if count:
        inside = exact.inside(origin + h * farthest_nodes(distances, regions, count))
        signs[np.concatenate([[False], inside])[regions]] = -1.0
    close = np.argwhere(regions == 0)
    close = close[((close > 0) & (close < np.array(signs.shape) - 1)).all(axis=1)]
    for step in product((-1, 0, 1), repeat=3):
        beside = tuple((close + step).T)
        apart = 1.001 * h * math.sqrt(sum(map(abs, step)))
        joined = (regions[beside] > 0) & (distances[beside] + distances[tuple(close.T)] > apart)
        signs[tuple(close[joined].T)] = signs[beside][joined]
        close = close[~joined]
    unknown = np.argwhere(signs == 0.0)
    signs[tuple(unknown.T)] = np.where(exact.inside(origin + h * unknown), -1.0, 1.0)
    return signs
