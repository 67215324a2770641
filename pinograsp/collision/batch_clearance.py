"""Clearance of many arm configurations to walls, obstacles and the robot itself, the hand held still.

The cheapest exact tests come first:

1. a link whose centre is beyond a wall, or nearer to it than the margin, is out (the centre lies in the hull);
2. so is one with any of a few extreme vertices there;
3. the distance of a convex hull to a half-space is that of its nearest vertex: one matrix product for many;
4. Coal measures the pairs of bodies whose bounding spheres and boxes come closer than `CAP`: first the hulls of the
   links, then, where these are closer than what is known so far, the convex pieces, nearest first. Obstacles that are
   near to a link are found by a tree.

What is left keeps the margins, and its least distance is known up to `CAP`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product
from typing import Any

import coal
import numpy as np

from ..arrays import Array, Indices, Mask
from ..geometry.convex_solid import convex_solid
from ..kinematics.batch import WORLD, BatchKinematics, GroupFrames
from ..kinematics.robot import Robot
from .ball_tree import BallTree
from .boxes import half_edges, near_pieces
from .solids import distance_request
from .world import Body, Hull, Solid, World

CAP = 0.05
"""Distances from here on are not told apart (unless a margin is larger), m."""
_BLOCK = 256


@dataclass(frozen=True, eq=False)
class _Placed:
    """A solid in the frame of its group."""

    shape: Any
    group: int
    placement: Array
    center: Array
    radius: float

    @cached_property
    def key(self) -> bytes:
        """Equal for solids with one pose."""
        return self.group.to_bytes(4, "little", signed=True) + self.placement.tobytes()

    def pose(self, frames: GroupFrames, which: int) -> Any:
        """Return the pose in the world for one configuration; of what an arm joint moves."""
        local, R = self.placement, frames.rotations[self.group, which]
        return coal.Transform3s(R @ local[:3, :3], R @ local[:3, 3] + frames.translations[self.group, which])

    def poses(self, frames: GroupFrames, which: Indices) -> list[Any]:
        """Return the poses in the world for some configurations."""
        local = self.placement
        if self.group == WORLD:
            return [coal.Transform3s(local[:3, :3], local[:3, 3])] * len(which)
        R, p = frames.rotations[self.group, which], frames.translations[self.group, which]
        return list(map(coal.Transform3s, R @ local[:3, :3], R @ local[:3, 3] + p))


@dataclass(frozen=True, eq=False)
class _Hull(_Placed):
    """A hull of a body, with the solids that it is the hull of."""

    body: Body
    parts: tuple[_Placed, ...]


class BatchClearance:
    """Tests arm configurations in a world of walls and obstacles, the hand still; what is held does not count."""

    def __init__(self, robot: Robot, world: World, synergies: Array) -> None:
        self.kinematics = BatchKinematics(robot, synergies)
        self._margins = world.margins
        self._cap = max(CAP, *world.margins.values())
        walls = [wall.solids[0].shape for wall in world.of("wall")]
        self._normals, self._offsets = np.array([wall.n for wall in walls]), np.array([wall.d for wall in walls])
        links = [self._with_parts(body, hull) for body in world.of("link") for hull in body.hulls]
        moving = [hull for hull in links if hull.group != WORLD]
        self._moving = moving
        self._pieces = [part for hull in moving for part in hull.parts]
        self._boxes = _boxes(self._pieces)
        self._obstacles = [self._placed(body, solid) for body in world.of("obstacle") for solid in body.solids]
        self._their_boxes = _boxes(self._obstacles)
        self._stands = [coal.Transform3s(o.placement[:3, :3], o.placement[:3, 3]) for o in self._obstacles]
        self._tree = BallTree.of(self._their_boxes[1], np.array([obstacle.radius for obstacle in self._obstacles]))
        self._pairs = [
            (a, b, world.margins["link"])
            for a, b in combinations(links, 2)
            if a.group != b.group and world.keep_apart(a.body, b.body, robot.supports)
        ]
        self._request = distance_request()
        self._vertices = {
            group: _hull_vertices([_vertices(hull) for hull in moving if hull.group == group])
            for group in sorted({hull.group for hull in moving})
        }
        self._centroids = {group: points.mean(axis=0)[None] for group, points in self._vertices.items()}
        self._extremes = {group: _extremes(points) for group, points in self._vertices.items()}

    def _with_parts(self, body: Body, hull: Hull) -> _Hull:
        parts = tuple(self._placed(body, body.solids[part]) for part in hull.parts)
        placed = self._placed(body, hull.solid)
        return _Hull(placed.shape, placed.group, placed.placement, placed.center, placed.radius, body, parts)

    def _placed(self, body: Body, solid: Solid) -> _Placed:
        center = self.kinematics.placement(body.joint, body.pose) @ [*solid.center, 1.0]
        placement = self.kinematics.placement(body.joint, body.pose @ solid.placement)
        return _Placed(solid.shape, self.kinematics.group_of[body.joint], placement, center[:3], solid.radius)

    def measure(self, q: Array) -> tuple[Indices, Array, GroupFrames]:
        """Return which configurations keep the margins, their clearance (m, at most CAP), and their frames.

        Args:
            q: arm configurations, rad (m), shape (N, l).
        """
        frames = self.kinematics.frames(q)
        kept = np.arange(len(q))
        for stage in (self._centroids, self._extremes):
            for group in reversed(stage):  # the outer links hit a wall more often
                inside = self._to_walls(frames, group, stage[group]) >= self._margins["wall"]
                kept, frames = kept[inside], _take(frames, inside)
        clearance = np.full(len(kept), self._cap)
        for group in reversed(self._vertices):
            np.minimum(clearance, self._to_walls(frames, group, self._vertices[group]), out=clearance)
        inside = clearance >= self._margins["wall"]
        kept, frames, clearance = kept[inside], _take(frames, inside), clearance[inside]
        clearance = self._pair_clearance(frames, clearance)
        inside = clearance > -np.inf
        return kept[inside], clearance[inside], _take(frames, inside)

    def _to_walls(self, frames: GroupFrames, group: int, points: Array) -> Array:
        """Return the least distance of a group's points (k, 3) to the walls, shape (N,)."""
        count, walls = frames.translations.shape[1], len(self._offsets)
        least = np.empty(count)
        for start in range(0, count, _BLOCK):
            block = slice(start, start + _BLOCK)
            # n . (R v + p) - d for all walls at once: directions R^T n in the group's frame.
            directions = np.matmul(self._normals, frames.rotations[group, block])
            nearest = (points @ directions.reshape(-1, 3).T).min(axis=0).reshape(-1, walls)
            nearest += frames.translations[group, block] @ self._normals.T - self._offsets
            least[block] = nearest.min(axis=1)
        return least

    def _pair_clearance(self, frames: GroupFrames, clearance: Array) -> Array:
        """Lower the clearances by pairs of bodies; -inf where a margin is not kept."""
        result = clearance.copy()
        if self._obstacles:
            self._lower_by_obstacles(frames, result)
        centers = {id(hull): frames.place(hull.group, hull.center) for pair in self._pairs for hull in pair[:2]}
        for a, b, margin in self._pairs:
            # A pair matters below what is known, and below its margin in any case; once it is out, nowhere.
            most = np.where(np.isfinite(result), np.maximum(result, margin), -np.inf)
            apart = np.linalg.norm(centers[id(a)] - centers[id(b)], axis=1) - a.radius - b.radius
            near = np.flatnonzero(apart < most)
            distances = self._distances(frames, near, a, b)
            if len(a.parts) * len(b.parts) > 1:
                near = near[distances < most[near]]
                distances = self._piece_distances(_take(frames, near), most[near], a, b)
            result[near] = np.where(distances < margin, -np.inf, np.minimum(result[near], distances))
        return result

    def _lower_by_obstacles(self, frames: GroupFrames, result: Array) -> None:
        """Lower the clearances by obstacles: in each configuration by the pair of pieces that may be nearest first."""
        margin, poses = self._margins["obstacle"], dict[tuple[int, bytes], Any]()
        which, pieces, members, bounds = self._near_obstacles(frames, np.maximum(result, margin))
        order, known = np.lexsort((bounds, which)), result.tolist()
        pairs = (numbers[order].tolist() for numbers in (which, pieces, members, bounds))
        for n, number, member, bound in zip(*pairs, strict=True):
            if bound >= max(known[n], margin) or known[n] == -np.inf:
                continue
            piece = self._pieces[number]
            at = poses.get((n, piece.key))  # pieces of one mesh have one pose
            if at is None:
                at = poses[n, piece.key] = piece.pose(frames, n)
            distance = self._distance(piece.shape, at, self._obstacles[member].shape, self._stands[member])
            known[n] = -np.inf if distance < margin else min(known[n], distance)
        result[:] = known

    def _near_obstacles(self, frames: GroupFrames, most: Array) -> tuple[Indices, Indices, Indices, Array]:
        """Return the pairs of a piece of a link and an obstacle's that may be nearer than `most`, m, shape (N,).

        Returns:
            Configurations, numbers of the pieces and of the obstacles' pieces, and lower bounds of the distances, m,
            each of shape (pairs,).
        """
        found, first = [], 0
        for hull in self._moving:
            R, p = frames.rotations[hull.group], frames.translations[hull.group]
            count = len(hull.parts)
            halves = np.tile(half_edges(hull.shape), (len(p), 1))
            rows, members = self._tree.near(R @ hull.placement[:3, :3], R @ hull.center + p, halves, most)
            placements, centers, own = (part[first : first + count] for part in self._boxes)
            rotations, theirs, their_halves = self._their_boxes
            which, parts, members, bounds = near_pieces(
                rows, members, R, p, placements, centers, own, rotations, theirs, their_halves, most
            )
            found.append((which, first + parts, members, bounds))
            first += count
        which, pieces, members, bounds = (np.concatenate(part) for part in zip(*found, strict=True))
        return which, pieces, members, bounds

    def _distances(self, frames: GroupFrames, which: Indices, a: _Hull, b: _Hull) -> Array:
        """Return the distances of two hulls in some configurations, shape (n,)."""
        poses = zip(a.poses(frames, which), b.poses(frames, which), strict=True)
        return np.array([self._distance(a.shape, at, b.shape, there) for at, there in poses])

    def _piece_distances(self, frames: GroupFrames, most: Array, a: _Hull, b: _Hull) -> Array:
        """Return the least distances between pieces of two bodies, or `most` where that is less, shape (N,)."""
        pairs = list(product(a.parts, b.parts))
        centers, others = (np.array([frames.place(p.group, p.center) for p in hull.parts]) for hull in (a, b))
        radii = np.array([first.radius + second.radius for first, second in pairs])
        apart = np.linalg.norm(centers[:, None] - others, axis=3).reshape(len(pairs), -1).T - radii
        # Pieces of one mesh have one pose.
        poses: dict[bytes, list[Any]] = {}
        for part in (*a.parts, *b.parts):
            if part.key not in poses:
                poses[part.key] = part.poses(frames, np.arange(len(most)))
        least = most.copy()
        for n, order in enumerate(apart.argsort(axis=1).tolist()):
            for pair in order:
                if apart[n, pair] >= least[n]:
                    break
                i, j = pairs[pair]
                found = self._distance(i.shape, poses[i.key][n], j.shape, poses[j.key][n])
                least[n] = min(least[n], found)
        return least

    def _distance(self, first: Any, at: Any, second: Any, there: Any) -> float:
        return float(coal.distance(first, at, second, there, self._request, coal.DistanceResult()))


def _take(frames: GroupFrames, which: Indices | Mask) -> GroupFrames:
    return GroupFrames(frames.rotations[:, which], frames.translations[:, which])


def _boxes(solids: list[_Placed]) -> tuple[Array, Array, Array]:
    """Return rotations (n, 3, 3), centres (n, 3) and half edges (n, 3) of bounding boxes in the groups' frames, m."""
    rotations = np.array([solid.placement[:3, :3] for solid in solids]).reshape(-1, 3, 3)
    centers, halves = ([s.center for s in solids], [half_edges(s.shape) for s in solids])
    return rotations, np.array(centers).reshape(-1, 3), np.array(halves).reshape(-1, 3)


def _vertices(hull: _Hull) -> Array:
    """Return the vertices of a hull in its group's frame; of a primitive, those of its bounding box."""
    shape, placement = hull.shape, hull.placement
    if isinstance(shape, coal.ConvexBase):
        points = np.array(shape.points())
    else:
        box = shape.aabb_local
        points = np.array(np.meshgrid(*zip(box.min_, box.max_, strict=True))).reshape(3, -1).T
    return np.asarray(points @ placement[:3, :3].T + placement[:3, 3])


def _hull_vertices(parts: list[Array]) -> Array:
    hull = convex_solid(np.concatenate(parts))
    return np.array(hull.points())  # a view until it is copied, of no use once the hull is gone


def _extremes(points: Array) -> Array:
    """Return the vertices that are outermost along the axes and diagonals of the group's frame."""
    directions = np.array(np.meshgrid(*([[-1.0, 0.0, 1.0]] * 3))).reshape(3, -1).T
    outermost: Array = points[np.unique((points @ directions.T).argmax(axis=0))]
    return outermost
