"""Holes of a surface closed, if they are small, hidden, or but open seams."""

from __future__ import annotations

import igl
import numpy as np

from ..arrays import Array, Indices, Integers
from ..words import number_of
from .mesh_parts import components, edges_of, parts_of
from .no_body import NoBodyError, in_brackets

SLIT_EDGES = 20_000
"""Where more edges than this are open, none is looked at whether it is but a slit."""
SLIT_PLACES = 3_000
"""Places along open edges at which that is asked at most."""
UNPAIRED = 0.5
"""Part of the radius of a ball around a place on a border that the open edges in it may add up to in a slit."""
BURIED = 20
"""Holes, the largest ones, that are looked for inside other parts."""


def hole_caps(vertices: Array, faces: Integers, largest: float) -> tuple[Array, Integers, list[str]]:
    """Return triangles that close the holes, with the corners that they need besides, and what they close in words.

    A hole is closed by a fan around the middle of its border.
    """
    ends, edge, direction, _ = edges_of(faces)
    net = np.bincount(edge, weights=direction, minlength=len(ends)).astype(np.int64)
    border = np.flatnonzero(net)
    if not len(border):
        return vertices, np.zeros((0, 3), dtype=np.int64), []
    # Against the direction of the triangle at the edge, and as often as it is missing.
    forward = np.where((net[border] > 0)[:, None], ends[border][:, ::-1], ends[border])
    times = np.abs(net[border])
    hole_of = np.unique(components(forward, len(vertices))[forward[:, 0]], return_inverse=True)[1]
    borders = _Borders(vertices[forward], times, largest)
    added, caps, buried = list[Array](), list[Integers](), 0
    sizes, slits = list[float](), 0
    refused: list[tuple[float, Array]] = []
    order = np.argsort(hole_of, kind="stable")
    for rows in np.split(order, np.flatnonzero(np.diff(hole_of[order])) + 1):
        edges = vertices[forward[rows]]
        middle = edges.mean(axis=(0, 1))  # weighs more where the border is finer
        around = 0.5 * (edges.min(axis=(0, 1)) + edges.max(axis=(0, 1)))
        size = 2.0 * float(np.linalg.norm(edges - around, axis=2).max())
        if size <= largest:
            sizes.append(size)
        elif borders.is_slit(rows):
            slits += 1
            if not _is_spanned(edges, middle, largest):
                continue
        elif len(refused) < BURIED and _is_buried(vertices, faces, forward[rows], middle):
            buried += 1
        else:
            refused.append((size, middle))
            continue
        fan = np.column_stack([forward[rows], np.full(len(rows), len(vertices) + len(added))])
        caps.append(np.repeat(fan, times[rows], axis=0))
        added.append(middle)
    if refused:
        _refuse(refused, largest)
    findings = []
    if sizes:
        findings.append(f"{number_of(len(sizes), 'hole')} of up to {1e3 * max(sizes):.2g} mm closed")
    if slits:
        findings.append(f"{number_of(slits, 'open seam')} narrower than {1e3 * largest:.2g} mm tolerated")
    if buried:
        findings.append(f"{number_of(buried, 'open end')} inside other parts closed")
    whole = np.concatenate([vertices, np.array(added).reshape(-1, 3)])
    return whole, np.concatenate([np.zeros((0, 3), dtype=np.int64), *caps]), findings


class _Borders:
    """All open edges, told apart where the surface gapes and where it is but slit.

    Around a place on the border of a hole the open edges lead from one side of a ball to the other. In a slit its two
    sides lead there and back, and cancel.

    Args:
        edges: shape (e, 2 ends, 3), m.
        times: how often a triangle is missing at each, shape (e,).
        radius: of the balls, m.
    """

    def __init__(self, edges: Array, times: Integers, radius: float) -> None:
        self._edges, self._times, self._radius = edges, times, radius
        self._along = edges[:, 1] - edges[:, 0]

    def is_slit(self, rows: Indices) -> bool:
        """Return whether the border of these edges is that of a slit."""
        if len(self._edges) > SLIT_EDGES:
            return False
        edges = self._edges[rows]
        counts = np.ceil(np.linalg.norm(self._along[rows], axis=1) / self._radius).clip(1, 100).astype(np.int64)
        shares = [(np.arange(count) + 0.5) / count for count in counts]
        places = np.concatenate([a + share[:, None] * (b - a) for (a, b), share in zip(edges, shares, strict=True)])
        places = places[:: -(-len(places) // SLIT_PLACES)]
        return all(self._unpaired(place) <= UNPAIRED * self._radius for place in places)

    def _unpaired(self, place: Array) -> float:
        """Return the length of the sum of the parts of edges that are in a ball, m."""
        away, squared = self._edges[:, 0] - place, (self._along * self._along).sum(axis=1)
        half = (away * self._along).sum(axis=1) / squared
        root = half * half - ((away * away).sum(axis=1) - self._radius**2) / squared
        spread = np.sqrt(np.maximum(root, 0.0))
        shares = np.clip(spread - half, 0.0, 1.0) - np.clip(-spread - half, 0.0, 1.0)
        return float(np.linalg.norm((shares * self._times) @ self._along))


def _apart(edges: Array, point: Array) -> Array:
    """Return the distances of a point to edges, m, shape (e,)."""
    starts, along = edges[:, 0], edges[:, 1] - edges[:, 0]
    share = np.clip(((point - starts) * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
    return np.asarray(np.linalg.norm(starts + share[:, None] * along - point, axis=1))


def _is_spanned(edges: Array, middle: Array, width: float) -> bool:
    """Return whether a fan around the middle of a slit's border stays in the slit."""
    points = np.concatenate([edges[:, 0] + share * (middle - edges[:, 0]) for share in (0.25, 0.5, 0.75, 1.0)])
    return all(_apart(edges, point).min() <= width for point in points)


def _is_buried(vertices: Array, faces: Integers, border: Integers, middle: Array) -> bool:
    """Return whether a cap of a hole lies inside the parts that the border is none of."""
    part = parts_of(faces, len(vertices))
    own = np.zeros(len(vertices), dtype=bool)
    own[border] = True
    others = np.ascontiguousarray(faces[~np.isin(part, part[own[faces].any(axis=1)])])
    if not len(others):
        return False
    corners = vertices[np.unique(border)]
    points = np.concatenate([corners, 0.5 * (corners + middle), middle[None]])
    return bool((igl.fast_winding_number(vertices, others, points) > 0.5).all())


def _refuse(holes: list[tuple[float, Array]], largest: float) -> None:
    size, place = max(holes, key=lambda hole: hole[0])
    others = f", and {len(holes) - 1} more" if len(holes) > 1 else ""
    raise NoBodyError(
        f"is not closed: it has a hole of {1e3 * size:.3g} mm around {in_brackets(place)} m{others}; "
        f"up to {1e3 * largest:.3g} mm are closed",
        "Close it in a modeller, or raise `largest_hole`",
    )
