"""Clearance of many arm configurations to walls, obstacles and the robot itself, the hand held still.

The cheapest exact tests come first:

1. a link whose centre is beyond a wall, or nearer to it than the margin, is out (the centre lies in the hull);
2. so is one with any of a few extreme vertices there;
3. the distance of a convex hull to a half-space is that of its nearest vertex: one matrix product for many;
4. Coal measures the pairs of links whose bounding spheres come closer than `CAP`: first the hulls of the links, then,
   where these are closer than what is known so far, the convex pieces, nearest first.

What is left keeps the margins, and its least distance is known up to `CAP`.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Indices
from ..descriptions import SceneDescription
from ..descriptions.scene import Margins
from ..kinematics.batch import WORLD, BatchKinematics, GroupFrames
from ..kinematics.robot import RobotModel
from .allowed_pairs import excused_links
from .solids import Solid, body_solid, distance_request, robot_solids, self_pairs, wholes

CAP = 0.05
"""Distances from here on are not told apart (unless a margin is larger), m."""
_BLOCK = 256


class BatchClearance:
    """Tests arm configurations of a mounted robot in the enclosure of a scene; objects do not count."""

    def __init__(self, robot: RobotModel, scene: SceneDescription, margins: Margins, synergies: Array) -> None:
        self.kinematics = BatchKinematics(robot, synergies)
        self._margins = margins
        self._cap = max(CAP, margins.enclosure, margins.robot)
        self._normals = np.array([normal for normal, _ in scene.enclosure.walls.values()])
        self._offsets = np.array([offset for _, offset in scene.enclosure.walls.values()])
        links = robot_solids(robot)
        obstacles = [body_solid(name, body) for name, body in scene.obstacles.items()]
        bodies = wholes([*links, *obstacles])
        self._solids = [*(body.solid for body in bodies), *links, *obstacles]
        self._pieces = [[len(bodies) + piece for piece in body.pieces] for body in bodies]
        self._groups = [self.kinematics.group_of[solid.joint] for solid in self._solids]
        self._placements = [self.kinematics.placement(s.joint, s.placement) for s in self._solids]
        self._centers = [self.kinematics.placement(s.joint, np.eye(4)) @ [*s.center, 1.0] for s in self._solids]
        # Pieces of one mesh have one pose.
        alike: dict[tuple[int, bytes], int] = {}
        poses = [(group, T.tobytes()) for group, T in zip(self._groups, self._placements, strict=True)]
        self._posed_like = [alike.setdefault(pose, i) for i, pose in enumerate(poses)]
        count = len(bodies) - len(obstacles)
        moving = [i for i in range(count) if self._groups[i] != WORLD]
        pairs = [(i, o, margins.enclosure) for i in moving for o in range(count, len(bodies))]
        excused = excused_links(robot, links, margins.robot)
        pairs += [
            (a, b, margins.robot)
            for a, b in self_pairs(robot, self._solids[:count], excused)
            if self._groups[a] != self._groups[b]
        ]
        self._pairs = pairs
        self._request = distance_request()
        self._vertices = {
            group: _hull_vertices(
                [_vertices(self._solids[i], self._placements[i]) for i in moving if self._groups[i] == group]
            )
            for group in sorted({self._groups[i] for i in moving})
        }
        self._centroids = {group: points.mean(axis=0)[None] for group, points in self._vertices.items()}
        self._extremes = {group: _extremes(points) for group, points in self._vertices.items()}

    def measure(self, q: Array) -> tuple[Indices, Array, GroupFrames]:
        """Return which configurations keep the margins, their clearance (m, at most CAP), and their frames.

        Args:
            q: arm configurations, rad (m), shape (N, l).
        """
        frames = self.kinematics.frames(q)
        kept = np.arange(len(q))
        for stage in (self._centroids, self._extremes):
            for group in reversed(stage):  # the outer links hit a wall more often
                inside = self._to_walls(frames, group, stage[group]) >= self._margins.enclosure
                kept, frames = kept[inside], _take(frames, inside)
        clearance = np.full(len(kept), self._cap)
        for group in reversed(self._vertices):
            np.minimum(clearance, self._to_walls(frames, group, self._vertices[group]), out=clearance)
        inside = clearance >= self._margins.enclosure
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
        centers = self._placed_centers(frames, range(len(self._pieces)))
        result = clearance.copy()
        for a, b, margin in self._pairs:
            # A pair matters below what is known, and below its margin in any case; once it is out, nowhere.
            most = np.where(np.isfinite(result), np.maximum(result, margin), -np.inf)
            apart = np.linalg.norm(centers[a] - centers[b], axis=1) - self._solids[a].radius - self._solids[b].radius
            near = np.flatnonzero(apart < most)
            distances = self._distances(frames, near, a, b)
            if len(self._pieces[a]) * len(self._pieces[b]) > 1:
                near = near[distances < most[near]]
                distances = self._piece_distances(_take(frames, near), most[near], a, b)
            result[near] = np.where(distances < margin, -np.inf, np.minimum(result[near], distances))
        return result

    def _distances(self, frames: GroupFrames, which: Indices, a: int, b: int) -> Array:
        """Return the distances of two solids in some configurations, shape (n,)."""
        poses = zip(self._poses(frames, which, a), self._poses(frames, which, b), strict=True)
        return np.array([self._distance(a, pose_a, b, pose_b) for pose_a, pose_b in poses])

    def _piece_distances(self, frames: GroupFrames, most: Array, a: int, b: int) -> Array:
        """Return the least distances between pieces of two bodies, or `most` where that is less, shape (N,)."""
        pairs = list(product(self._pieces[a], self._pieces[b]))
        centers, others = (self._placed_centers(frames, self._pieces[body]) for body in (a, b))
        radii = np.array([self._solids[i].radius + self._solids[j].radius for i, j in pairs])
        apart = np.linalg.norm(centers[:, None] - others, axis=3).reshape(len(pairs), -1).T - radii
        posed_like = {piece: self._posed_like[piece] for piece in self._pieces[a] + self._pieces[b]}
        poses = {solid: self._poses(frames, np.arange(len(most)), solid) for solid in set(posed_like.values())}
        least = most.copy()
        for n, order in enumerate(apart.argsort(axis=1).tolist()):
            for pair in order:
                if apart[n, pair] >= least[n]:
                    break
                i, j = pairs[pair]
                least[n] = min(least[n], self._distance(i, poses[posed_like[i]][n], j, poses[posed_like[j]][n]))
        return least

    def _distance(self, a: int, pose_a: Any, b: int, pose_b: Any) -> float:
        first, second = self._solids[a].shape, self._solids[b].shape
        return float(coal.distance(first, pose_a, second, pose_b, self._request, coal.DistanceResult()))

    def _placed_centers(self, frames: GroupFrames, solids: Iterable[int]) -> Array:
        """Return the centres of bounding spheres, world, m, shape (solids, N, 3)."""
        return np.array([frames.place(self._groups[i], self._centers[i][:3]) for i in solids])

    def _poses(self, frames: GroupFrames, which: Indices, solid: int) -> list[Any]:
        """Return a solid's poses for some configurations."""
        local, group = self._placements[solid], self._groups[solid]
        if group == WORLD:
            return [coal.Transform3s(local[:3, :3], local[:3, 3])] * len(which)
        R, p = frames.rotations[group, which], frames.translations[group, which]
        return list(map(coal.Transform3s, R @ local[:3, :3], R @ local[:3, 3] + p))


def _take(frames: GroupFrames, which: Indices | NDArray[np.bool_]) -> GroupFrames:
    return GroupFrames(frames.rotations[:, which], frames.translations[:, which])


def _vertices(solid: Solid, placement: Array) -> Array:
    """Return the vertices of a solid in its group's frame; of a primitive, those of its bounding box."""
    shape = solid.shape
    if isinstance(shape, coal.ConvexBase):
        points = np.array(shape.points())
    else:
        box = shape.aabb_local
        points = np.array(np.meshgrid(*zip(box.min_, box.max_, strict=True))).reshape(3, -1).T
    return np.asarray(points @ placement[:3, :3].T + placement[:3, 3])


def _hull_vertices(parts: list[Array]) -> Array:
    points = coal.StdVec_Vec3s()
    points.extend(list(np.concatenate(parts)))
    hull = coal.Convex.convexHull(points, True, "Qt")
    return np.array(hull.points())  # a view until it is copied, of no use once the hull is gone


def _extremes(points: Array) -> Array:
    """Return the vertices that are outermost along the axes and diagonals of the group's frame."""
    directions = np.array(np.meshgrid(*([[-1.0, 0.0, 1.0]] * 3))).reshape(3, -1).T
    outermost: Array = points[np.unique((points @ directions.T).argmax(axis=0))]
    return outermost
