"""Distances of the robot to the walls, to bodies of the scene and to itself, mesh by mesh.

Except for the walls, a clearance is measured up to 50 mm (or twice its limit, if that is more): a value of 0.05 says
"at least 0.05 m". Pairs are measured in the order of a lower bound, from bounding spheres first and then from convex
hulls, each only as far as it could still be the least: of most pairs the meshes are not looked at. A distance is exact
while the bodies are apart; where they intersect and no exact depth is known it is -inf.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import coal
import numpy as np

from ..arrays import Array
from .certificate import Figure
from .kinematics import Poses
from .link_mesh import LinkMesh
from .shapes import PlacedPart, PlacedShape
from .shapes.core import PENETRATION

Walls = Mapping[str, tuple[Array, float]]
LinkPair = tuple[LinkMesh, LinkMesh]
PartPair = tuple[LinkMesh, PlacedPart]

CAP = 0.05
"""Clearances are measured up to this distance, m."""

_HULL_ERROR = 1e-5
"""More than the error of a distance of convex hulls, m."""
_ROUNDING = 1e-12
"""More than bounding spheres err by, m."""
_REQUEST = coal.DistanceRequest()
_REQUEST.enable_signed_distance = False  # depths of meshes mean nothing


class Placed:
    """The meshes at the link poses of one claim.

    Args:
        meshes: by link.
        poses: T_world_link, shape (4, 4), of these links at least.
    """

    def __init__(self, meshes: dict[str, LinkMesh], poses: Poses) -> None:
        self.poses = poses
        self.placements = {link: coal.Transform3s(poses[link][:3, :3], poses[link][:3, 3]) for link in meshes}
        self.centers = {link: self.to_world(link, mesh.center) for link, mesh in meshes.items()}

    def to_world(self, link: str, points: Array) -> Array:
        """Transform points, shape (..., 3), from the frame of a link into the world."""
        T = self.poses[link]
        return np.asarray(points @ T[:3, :3].T + T[:3, 3])

    def to_link(self, link: str, points: Array) -> Array:
        """Transform world points, shape (..., 3), into the frame of a link."""
        T = self.poses[link]
        return np.asarray((points - T[:3, 3]) @ T[:3, :3])


class Surroundings:
    """Links, and parts of bodies of the scene that each of them is to keep clear of.

    Args:
        meshes: of the links.
        shapes: the bodies.
    """

    def __init__(self, meshes: Sequence[LinkMesh], shapes: Sequence[PlacedShape]) -> None:
        self._meshes, self._parts = meshes, [part for shape in shapes for part in shape.parts]
        self._centers = np.array([part.center for part in self._parts]).reshape(-1, 3)
        self._radii = np.array([[m.radius + part.radius for part in self._parts] for m in meshes])

    def __bool__(self) -> bool:
        """Whether there are links and bodies."""
        return self._radii.size > 0

    def near(self, placed: Placed, most: float) -> tuple[list[PartPair], Array]:
        """Return the pairs whose bounding spheres are nearer than `most`, m, nearest first, and how far these are."""
        links = np.array([placed.centers[mesh.link] for mesh in self._meshes]).reshape(-1, 1, 3)
        apart = np.sqrt(((links - self._centers) ** 2).sum(axis=2)) - self._radii
        found = np.flatnonzero(apart.ravel() < most)
        found = found[np.argsort(apart.ravel()[found], kind="stable")]
        pairs = [(self._meshes[i], self._parts[j]) for i, j in zip(*np.divmod(found, len(self._parts)), strict=True)]
        return pairs, apart.ravel()[found]


def enclosure_figure(meshes: Sequence[LinkMesh], walls: Walls, placed: Placed, margin: float) -> Figure:
    """Return the least signed distance of a mesh to a wall, m: that of a corner of the mesh's hull."""
    names, bounds = list(walls), wall_bounds(meshes, walls, placed).ravel()
    least, where = math.inf, ""
    for number in np.argsort(bounds, kind="stable").tolist():
        if bounds[number] >= least:
            break
        mesh, wall = meshes[number // len(names)], names[number % len(names)]
        distance = wall_distance(mesh, *walls[wall], placed)
        if distance < least:
            least, where = distance, f"{mesh.link} / {wall}"
    return Figure("enclosure clearance", least, margin - 1e-6, "m", "at least", where)


def wall_bounds(meshes: Sequence[LinkMesh], walls: Walls, placed: Placed) -> Array:
    """Return lower bounds of the distances of meshes to walls, m, shape (meshes, walls): those of bounding spheres."""
    normals = np.array([normal for normal, _ in walls.values()])
    centers = np.array([placed.centers[mesh.link] for mesh in meshes])
    least = np.array([offset for _, offset in walls.values()]) + np.array([[mesh.radius] for mesh in meshes])
    return np.asarray(centers @ normals.T - least - _ROUNDING)


def wall_distance(mesh: LinkMesh, inward: Array, offset: float, placed: Placed) -> float:
    """Return the signed distance of a mesh to a wall, inside which inward . p >= offset, m."""
    T = placed.poses[mesh.link]
    return float((mesh.hull @ (inward @ T[:3, :3])).min() + inward @ T[:3, 3] - offset)


def shape_figure(name: str, around: Surroundings, placed: Placed, limit: float) -> Figure:
    """Return the least signed distance between a mesh and a body, m."""
    cap = max(CAP, 2 * limit)
    pairs, bounds = around.near(placed, cap)
    least, nearest = _least(
        bounds, cap, lambda i: _part_bound(*pairs[i], placed), lambda i, most: part_distance(*pairs[i], placed, most)
    )
    where = "" if nearest is None else f"{pairs[nearest][0].link} / {pairs[nearest][1].name}"
    return Figure(name, least, limit, "m", "at least", where)


def self_figure(name: str, pairs: Sequence[LinkPair], placed: Placed, limit: float) -> Figure:
    """Return the least distance between two meshes of the robot, m."""
    first = np.array([placed.centers[mesh.link] for mesh, _ in pairs]).reshape(-1, 3)
    second = np.array([placed.centers[mesh.link] for _, mesh in pairs]).reshape(-1, 3)
    bounds = np.linalg.norm(second - first, axis=1) - [a.radius + b.radius for a, b in pairs]
    cap = max(CAP, 2 * limit)
    least, nearest = _least(
        bounds, cap, lambda i: _mesh_bound(*pairs[i], placed), lambda i, most: mesh_distance(*pairs[i], placed, most)
    )
    where = "" if nearest is None else " / ".join(mesh.link for mesh in pairs[nearest])
    return Figure(name, least, limit, "m", "at least", where)


def _least(
    bounds: Array, cap: float, bound: Callable[[int], float], measure: Callable[[int, float], float]
) -> tuple[float, int | None]:
    """Return the least of `measure(i, most)` below `cap`, and its i.

    Args:
        bounds: lower bounds of the values, shape (pairs,).
        cap: returned if every value is above.
        bound: a better lower bound of the value of pair i, which takes longer.
        measure: value of pair i; anything not below `most` if it is above `most`.
    """
    least, nearest = cap, None
    queue = [(lower, False, i) for i, lower in enumerate(bounds.tolist()) if lower < cap]
    heapq.heapify(queue)
    while queue and queue[0][0] < least:
        lower, better, i = heapq.heappop(queue)
        if not better:
            heapq.heappush(queue, (max(lower, bound(i)), True, i))
            continue
        value = measure(i, least)
        if value < least:
            least, nearest = value, i
    return least, nearest


def part_distance(mesh: LinkMesh, part: PlacedPart, placed: Placed, most: float) -> float:
    """Return the lesser of `most`, above zero, and the signed distance of a mesh to a part, m.

    It is -inf where the mesh enters the innermost core of the part.
    """
    placement = placed.placements[mesh.link]
    if most > 0.0 and _part_bound(mesh, part, placed) >= most:
        return most
    if mesh.surrounds(placed.to_link(mesh.link, part.members)):
        return -math.inf
    if part.surrounds(placed.to_world(mesh.link, mesh.members)):
        return -math.inf
    for core in part.cores:
        # The bound stays above zero, which would read as an intersection.
        bound = max(most, 0.0) + core.inset + PENETRATION
        distance = _distance(mesh.solid, placement, core.solid, part.placement, bound)
        if distance > 0.0:
            value: float = distance - core.inset
            # The part itself was entered if it is not the first core.
            return value if core is part.cores[0] else min(value, 0.0)
    return -math.inf


def mesh_distance(first: LinkMesh, second: LinkMesh, placed: Placed, most: float) -> float:
    """Return the lesser of `most`, above zero, and the distance of two meshes, m.

    It is -inf where they intersect or one surrounds the other.
    """
    if most > 0.0 and _mesh_bound(first, second, placed) >= most:
        return most
    T_first, T_second = placed.placements[first.link], placed.placements[second.link]
    distance = _distance(first.solid, T_first, second.solid, T_second, most)
    if distance <= 0.0 or _one_in_other(first, second, placed) or _one_in_other(second, first, placed):
        return -math.inf
    return distance


def _one_in_other(inner: LinkMesh, outer: LinkMesh, placed: Placed) -> bool:
    points = placed.to_world(inner.link, inner.members)
    return outer.surrounds(placed.to_link(outer.link, points))


def _part_bound(mesh: LinkMesh, part: PlacedPart, placed: Placed) -> float:
    """Return a lower bound of the distance of a mesh to a part, m: that of the hulls, -inf where one has none."""
    return _hull_bound(mesh.hull_solid, placed.placements[mesh.link], part.hull.solid, part.placement) - part.hull.inset


def _mesh_bound(first: LinkMesh, second: LinkMesh, placed: Placed) -> float:
    """Return a lower bound of the distance of two meshes, m: that of their hulls, -inf where one has none."""
    T_first, T_second = placed.placements[first.link], placed.placements[second.link]
    return _hull_bound(first.hull_solid, T_first, second.hull_solid, T_second)


def _hull_bound(first: Any | None, T_first: Any, second: Any | None, T_second: Any) -> float:
    if first is None or second is None:
        return -math.inf
    apart = float(coal.distance(first, T_first, second, T_second, _REQUEST, coal.DistanceResult()))
    return apart - _HULL_ERROR if apart > 0.0 else -math.inf


def _distance(first: Any, T_first: Any, second: Any, T_second: Any, most: float) -> float:
    """Return the lesser of `most` and the distance of two geometries; not positive if they intersect."""
    result = coal.DistanceResult()
    # Coal prunes its search with the distance that the result already holds.
    result.min_distance = most
    return float(coal.distance(first, T_first, second, T_second, _REQUEST, result))
