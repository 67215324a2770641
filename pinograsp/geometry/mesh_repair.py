"""Triangles as they come from files made into the border of a body, as far as that can be done without guessing.

A surface is closed in the sense of the winding number if its triangles go along every edge as often one way as the
other: then every point is enclosed a whole number of times, and the body is where that number is positive. That is
asked here, rather than that every edge has two triangles: bodies may consist of parts that overlap, touch or share
edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import igl
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..arrays import Array, Indices, Integers, Mask

NEAR = 1e-6
"""Corners that are nearer than this part of the body's extent are one."""
ADDED = -1
"""Origin of a triangle that closes a hole."""
SLIT_EDGES = 20_000
"""Where more edges than this are open, none is looked at whether it is but a slit."""
SLIT_PLACES = 3_000
"""Places along open edges at which that is asked at most."""
UNPAIRED = 0.5
"""Part of the radius of a ball around a place on a border that the open edges in it may add up to in a slit."""
BURIED = 20
"""Holes, the largest ones, that are looked for inside other parts."""
GHOST = 0.01
"""Part of the area that may enclose nothing, at creases and seams."""
SAMPLES = 20_000
"""Triangles, evenly picked, at which that is asked."""
STEPS = 6
"""Places along each edge of a triangle at which it is looked for inside other parts."""
MIDDLE = np.full((1, 3), 1.0 / 3.0)
"""Share of each corner in the middle of a triangle."""


class NoBodyError(Exception):
    """The triangles enclose no body.

    Args:
        problem: what is wrong.
        remedy: what to do.
    """

    def __init__(self, problem: str, remedy: str) -> None:
        super().__init__(problem)
        self.problem, self.remedy = problem, remedy


@dataclass(frozen=True)
class Repaired:
    """Triangles that enclose a body."""

    vertices: Array
    """Shape (v, 3), m."""
    faces: Integers
    """Shape (f, 3), counter-clockwise seen from outside."""
    origin: Indices
    """Index of the triangle that each is, -1: one that closes a hole; shape (f,)."""
    outer: Mask
    """Which triangles bound the body, and do not lie wholly inside it where parts overlap; shape (f,)."""
    findings: tuple[str, ...]
    """What was mended, in words."""


def repaired(vertices: Array, faces: Integers, largest_hole: float) -> Repaired:
    """Return the border of a body.

    Args:
        vertices: shape (v, 3), finite, m.
        faces: shape (f, 3).
        largest_hole: diameter up to which holes are closed, m.

    Raises:
        NoBodyError: it is flat, has a larger hole, or its triangles enclose nothing.
    """
    vertices, faces = _merged(vertices, faces)
    _require_extent(vertices)
    faces, origin = _once(faces)
    faces, turned = _consistent(vertices, faces)
    findings = [f"{counted(turned, 'triangle')} against the direction of their neighbours turned"] if turned else []
    faces, inside_out = _outward(vertices, faces)
    findings += inside_out
    vertices, caps, holes = _caps(vertices, faces, largest_hole)
    findings += holes
    faces = np.concatenate([faces, caps])
    origin = np.concatenate([origin, np.full(len(caps), ADDED)])
    overlapping = _require_body(vertices, faces)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    extent = float(np.ptp(vertices, axis=0).max())
    real = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-13 * extent**2  # slivers enclose and measure nothing
    outer = _outer(vertices, faces)[real] if overlapping else np.ones(int(real.sum()), dtype=bool)
    return Repaired(vertices, np.ascontiguousarray(faces[real]), origin[real], outer, tuple(findings))


def _merged(vertices: Array, faces: Integers) -> tuple[Array, Integers]:
    """Return corners at one place made one: seams of textures and normals, and rounding, part no triangles."""
    used = corners_of(faces, len(vertices))
    vertices, faces = vertices[used], (np.cumsum(used) - 1)[faces]
    key = np.zeros(len(vertices), dtype=np.int64)
    for column in vertices.T:
        rank = np.unique(column, return_inverse=True)[1]
        key = np.unique(key * (int(rank.max()) + 1) + rank, return_inverse=True)[1]
    first = np.unique(key, return_index=True)[1]
    vertices, faces = vertices[first], key[faces]
    pairs = cKDTree(vertices).query_pairs(NEAR * float(np.ptp(vertices, axis=0).max()), output_type="ndarray")
    if len(pairs):
        label = _components(pairs, len(vertices))
        vertices, faces = vertices[np.unique(label, return_index=True)[1]], label[faces]
    return vertices, faces


def corners_of(faces: Integers, count: int) -> Mask:
    """Return which of a number of vertices triangles have."""
    used = np.zeros(count, dtype=bool)
    used[faces] = True
    return used


def _components(pairs: Integers, count: int) -> Integers:
    """Return the number of the connected part of each node of a graph."""
    graph = coo_matrix((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _require_extent(vertices: Array) -> None:
    spread = np.linalg.eigvalsh(np.cov(vertices.T)) if len(vertices) > 3 else np.zeros(3)
    if spread[0] <= (1e-6) ** 2 * spread[2]:
        raise NoBodyError("lies in one plane and encloses no volume", "A body has a thickness; model it as a solid")


def _once(faces: Integers) -> tuple[Integers, Indices]:
    """Return triangles once that are there several times, and not those of both directions, which enclose nothing.

    If that is all of them, as where both sides of every triangle are to be seen, one of each direction is kept.
    """
    real = np.flatnonzero((faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0]))
    ordered = np.sort(faces[real], axis=1)
    shifts = np.argmin(faces[real], axis=1)
    second = np.take_along_axis(faces[real], ((shifts + 1) % 3)[:, None], axis=1)[:, 0]
    sign = np.where(second == ordered[:, 1], 1, -1)
    size = int(faces.max()) + 1
    key = np.unique(ordered[:, 0] * size + ordered[:, 1], return_inverse=True)[1] * size + ordered[:, 2]
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    net = np.bincount(group, weights=sign)
    kept = sign == np.sign(net)[group]
    chosen = np.full(len(first), len(real))
    np.minimum.at(chosen, group[kept], np.flatnonzero(kept))
    chosen = np.sort(chosen[chosen < len(real)])
    if not len(chosen):
        chosen = np.sort(first)
    return faces[real[chosen]], real[chosen]


def _edges(faces: Integers) -> tuple[Integers, Integers, Integers, Integers]:
    """Return the edges, of each side of a triangle the edge and the direction, and how many sides each edge has.

    Ends of edges are in order, shape (e, 2); sides go triangle by triangle, shape (3 f,); a direction is 1 or -1.
    """
    sides = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    ordered = np.sort(sides, axis=1)
    size = int(faces.max()) + 1
    keys, edge, counts = np.unique(ordered[:, 0] * size + ordered[:, 1], return_inverse=True, return_counts=True)
    return np.stack([keys // size, keys % size], axis=1), edge, np.where(sides[:, 0] < sides[:, 1], 1, -1), counts


def _consistent(vertices: Array, faces: Integers) -> tuple[Integers, int]:
    """Return the triangles with neighbours that face the same way, where an edge has two; and how many were turned."""
    _, edge, direction, counts = _edges(faces)
    net = np.bincount(edge, weights=direction)
    if not ((counts == 2) & (net != 0)).any():
        return faces, 0
    alike, patch = igl.bfs_orient(np.ascontiguousarray(faces))
    alike = np.asarray(alike, dtype=np.int64)
    volumes = np.bincount(patch, weights=_volumes(vertices, alike, patch))
    alike = np.where((volumes < 0.0)[patch][:, None], alike[:, ::-1], alike)
    same = (alike == faces).all(axis=1) | (np.roll(alike, 1, axis=1) == faces).all(axis=1)
    same |= (np.roll(alike, 2, axis=1) == faces).all(axis=1)
    turned = int((~same).sum())
    return alike, min(turned, len(faces) - turned)


def _volumes(vertices: Array, faces: Integers, part: Integers) -> Array:
    """Return the signed volumes between triangles and the mean corner of their parts, shape (f,), m^3."""
    corners = vertices[faces]
    counts = np.maximum(np.bincount(part), 1)
    means = np.stack([np.bincount(part, weights=column) / counts for column in corners.mean(axis=1).T], axis=1)
    a, b, c = (corners - means[part][:, None]).transpose(1, 0, 2)
    return np.asarray(np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0)


def _parts(faces: Integers, count: int) -> Integers:
    """Return the number of the part of each triangle: triangles that share corners are of one."""
    label = _components(np.concatenate([faces[:, :2], faces[:, 1:]]), count)
    return np.unique(label[faces[:, 0]], return_inverse=True)[1]


def _outward(vertices: Array, faces: Integers) -> tuple[Integers, list[str]]:
    """Return the triangles of every part facing outwards, but of cavities inwards."""
    part = _parts(faces, len(vertices))
    volumes = np.bincount(part, weights=_volumes(vertices, faces, part))
    negative = volumes < 0.0
    if not negative.any():
        return faces, []
    if not negative.all():
        first = np.unique(part, return_index=True)[1][negative]
        around = np.ascontiguousarray(faces[~negative[part]])
        hollow = igl.fast_winding_number(vertices, around, vertices[faces[first, 0]]) > 0.5
        negative[np.flatnonzero(negative)[hollow]] = False
    turned = negative[part]
    if not turned.any():
        return faces, []
    count = int(negative.sum())
    some = f"{counted(count, 'part')} of it {'is' if count == 1 else 'are'} inside out: turned"
    return np.where(turned[:, None], faces[:, ::-1], faces), ["inside out: turned" if turned.all() else some]


def _caps(vertices: Array, faces: Integers, largest: float) -> tuple[Array, Integers, list[str]]:
    """Return triangles that close the holes, with the corners that they need besides, and what they close in words.

    A hole is closed by a fan around the middle of its border.
    """
    ends, edge, direction, _ = _edges(faces)
    net = np.bincount(edge, weights=direction, minlength=len(ends)).astype(np.int64)
    border = np.flatnonzero(net)
    if not len(border):
        return vertices, np.zeros((0, 3), dtype=np.int64), []
    # Against the direction of the triangle at the edge, and as often as it is missing.
    forward = np.where((net[border] > 0)[:, None], ends[border][:, ::-1], ends[border])
    times = np.abs(net[border])
    hole_of = np.unique(_components(forward, len(vertices))[forward[:, 0]], return_inverse=True)[1]
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
        findings.append(f"{counted(len(sizes), 'hole')} of up to {1e3 * max(sizes):.2g} mm closed")
    if slits:
        findings.append(f"{counted(slits, 'open seam')} narrower than {1e3 * largest:.2g} mm tolerated")
    if buried:
        findings.append(f"{counted(buried, 'open end')} inside other parts closed")
    whole = np.concatenate([vertices, np.array(added).reshape(-1, 3)])
    return whole, np.concatenate([np.zeros((0, 3), dtype=np.int64), *caps]), findings


def counted(count: int, what: str) -> str:
    """Return a number of things in words."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


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
    part = _parts(faces, len(vertices))
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


def in_brackets(place: Array) -> str:
    """Return coordinates as text, to a tenth of a millimetre."""
    return "(" + ", ".join(f"{value:.4f}" for value in place + 0.0) + ")"


def _outer(vertices: Array, faces: Integers) -> Mask:
    """Return which triangles bound the body: those that do not lie wholly inside it, where parts overlap."""
    outer = _outside_windings(vertices, faces, np.arange(len(faces)), MIDDLE)[:, 0] < 0.5
    within = np.flatnonzero(~outer)
    steps = np.arange(STEPS)
    grid = np.array([(i, j, STEPS - 1 - i - j) for i in steps for j in steps if i + j < STEPS]) + 0.1
    shares = grid / grid.sum(axis=1, keepdims=True)
    outer[within] = (_outside_windings(vertices, faces, within, shares) < 0.5).any(axis=1)
    return outer


def _outside_windings(vertices: Array, faces: Integers, picked: Indices, shares: Array) -> Array:
    """Return the winding numbers just outside of triangles: 0 where they bound the body.

    Args:
        vertices: shape (v, 3), m.
        faces: shape (f, 3).
        picked: indices of triangles, shape (n,).
        shares: of their corners in the places that are looked at, shape (k, 3).

    Returns:
        Shape (n, k).
    """
    corners = vertices[faces[picked]]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(across, axis=1)
    across /= np.where(lengths > 0.0, lengths, 1.0)[:, None]
    off = 1e-5 * float(np.ptp(vertices, axis=0).max())
    places = np.einsum("kc,nci->nki", shares, corners) + off * across[:, None]
    windings = igl.fast_winding_number(vertices, np.ascontiguousarray(faces), places.reshape(-1, 3))
    return np.asarray(windings).reshape(len(picked), len(shares))


def _require_body(vertices: Array, faces: Integers) -> bool:
    """Refuse triangles that enclose no volume, or many of which bound nothing; return whether parts overlap.

    Triangles bound nothing where a surface crosses itself, and its inner side is outside from there on.
    """
    low = vertices.min(axis=0)
    a, b, c = (vertices - low)[faces].transpose(1, 0, 2)
    volume = float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6.0
    if volume <= 1e-9 * float(np.prod(np.ptp(vertices, axis=0))):
        raise NoBodyError("encloses no volume", "A body has a thickness; model it as a solid")
    picked = np.arange(0, len(faces), -(-len(faces) // SAMPLES))
    windings = _outside_windings(vertices, faces, picked, MIDDLE)[:, 0]
    areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)[picked]
    ghosts: Mask = (windings < -0.5) & (areas > 0.0)
    share = float(areas[ghosts].sum() / areas.sum())
    if share > GHOST:
        worst = int(np.argmax(np.where(ghosts, areas, 0.0)))
        place = vertices[faces[picked[worst]]].mean(axis=0)
        problem = f"crosses itself: {100.0 * share:.0f} % of its surface enclose nothing, such as at"
        raise NoBodyError(f"{problem} {in_brackets(place)} m", "Make it one solid in a modeller")
    return bool((windings > 0.5).any())
