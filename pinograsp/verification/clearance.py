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
from .shapes import PlacedShape
from .shapes.core import PENETRATION

Walls = Mapping[str, tuple[Array, float]]
LinkPair = tuple[LinkMesh, LinkMesh]
ShapePair = tuple[LinkMesh, PlacedShape]

CAP = 0.05
"""Clearances are measured up to this distance, m."""

_HULL_ERROR = 1e-5
"""More than the error of a distance of convex hulls, m."""
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


def enclosure_figure(meshes: Sequence[LinkMesh], walls: Walls, poses: Poses, margin: float) -> Figure:
    """Return the least signed distance of a mesh to a wall, m: that of a corner of the mesh's hull."""
    normals = np.array([normal for normal, _ in walls.values()])
    offsets = np.array([offset for _, offset in walls.values()])
    least, where = math.inf, ""
    for mesh in meshes:
        T = poses[mesh.link]
        heights = (mesh.hull @ (normals @ T[:3, :3]).T).min(axis=0) + normals @ T[:3, 3] - offsets
        nearest = int(heights.argmin())
        if heights[nearest] < least:
            least, where = float(heights[nearest]), f"{mesh.link} / {list(walls)[nearest]}"
    return Figure("enclosure clearance", least, margin - 1e-6, "m", "at least", where)


def shape_figure(name: str, pairs: Sequence[ShapePair], placed: Placed, limit: float) -> Figure:
    """Return the least signed distance between a mesh and a shape, m."""
    centers = np.array([placed.centers[mesh.link] for mesh, _ in pairs])
    apart = np.linalg.norm(centers - [shape.center for _, shape in pairs], axis=1)
    bounds = apart - [mesh.radius + shape.radius for mesh, shape in pairs]
    cap = max(CAP, 2 * limit)
    least, nearest = _least(
        bounds,
        cap,
        lambda i: _shape_bound(*pairs[i], placed),
        lambda i, most: shape_distance(*pairs[i], placed, most),
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


def shape_distance(mesh: LinkMesh, shape: PlacedShape, placed: Placed, most: float) -> float:
    """Return the lesser of `most`, above zero, and the signed distance of a mesh to a shape, m.

    It is -inf where the mesh enters the innermost core of the shape.
    """
    placement = placed.placements[mesh.link]
    if most > 0.0 and _shape_bound(mesh, shape, placed) >= most:
        return most
    if mesh.surrounds(placed.to_link(mesh.link, shape.center[None])):
        return -math.inf
    for core in shape.cores:
        # The bound stays above zero, which would read as an intersection.
        bound = max(most, 0.0) + core.inset + PENETRATION
        distance = _distance(mesh.solid, placement, core.solid, shape.placement, bound)
        if distance > 0.0:
            value: float = distance - core.inset
            # The shape itself was entered if it is not the first core.
            return value if core is shape.cores[0] else min(value, 0.0)
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


def _shape_bound(mesh: LinkMesh, shape: PlacedShape, placed: Placed) -> float:
    """Return a lower bound of the distance of a mesh to a shape, m: that of its hull, -inf where it has none."""
    core = shape.cores[0]
    return _hull_bound(mesh.hull_solid, placed.placements[mesh.link], core.solid, shape.placement) - core.inset


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
