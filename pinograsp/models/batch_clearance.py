"""Clearance of many arm configurations to walls, obstacles and the robot itself, the hand held still.

The cheapest exact tests come first:

1. a link whose centre is beyond a wall, or nearer to it than the margin, is out (the centre lies in the hull);
2. so is one with any of a few extreme vertices there;
3. the distance of a convex hull to a half-space is that of its nearest vertex: one matrix product for many;
4. Coal measures the pairs of hulls whose bounding spheres come closer than `CAP`.

What is left keeps the margins, and its least distance is known up to `CAP`.
"""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Indices
from ..descriptions import SceneDescription
from ..descriptions.scene import Margins
from .batch import WORLD, BatchKinematics, GroupFrames
from .bodies import Solid, body_solid, distance_request, robot_solids, self_pairs
from .robot import RobotModel

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
        self._solids = [*links, *obstacles]
        self._groups = [self.kinematics.group_of[solid.joint] for solid in self._solids]
        self._placements = [self.kinematics.placement(s.joint, s.placement) for s in self._solids]
        self._centers = [self.kinematics.placement(s.joint, np.eye(4)) @ [*s.center, 1.0] for s in self._solids]
        moving = [i for i in range(len(links)) if self._groups[i] != WORLD]
        around = range(len(links), len(self._solids))
        pairs = [(i, o, margins.enclosure) for i in moving for o in around]
        pairs += [(a, b, margins.robot) for a, b in self_pairs(robot, links) if self._groups[a] != self._groups[b]]
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
        """Lower the clearances by pairs of hulls; -inf where a margin is not kept."""
        centers = [frames.place(g, c[:3]) for g, c in zip(self._groups, self._centers, strict=True)]
        result = clearance.copy()
        for a, b, margin in self._pairs:
            apart = np.linalg.norm(centers[a] - centers[b], axis=1) - self._solids[a].radius - self._solids[b].radius
            near = np.flatnonzero(apart < result)
            poses = zip(self._poses(frames, near, a), self._poses(frames, near, b), strict=True)
            for n, (pose_a, pose_b) in zip(near.tolist(), poses, strict=True):
                distance = float(
                    coal.distance(
                        self._solids[a].shape,
                        pose_a,
                        self._solids[b].shape,
                        pose_b,
                        self._request,
                        coal.DistanceResult(),
                    )
                )
                result[n] = min(result[n], distance) if distance >= margin else -np.inf
        return result

    def _poses(self, frames: GroupFrames, which: Indices, solid: int) -> list[Any]:
        """Return a solid's poses for some configurations."""
        local, group = self._placements[solid], self._groups[solid]
        if group == WORLD:
            return [coal.Transform3s(local[:3, :3], local[:3, 3])] * len(which)
        R, p = frames.rotations[group, which], frames.translations[group, which]
        return list(map(coal.Transform3s, R @ local[:3, :3], R @ local[:3, 3] + p))


def _take(frames: GroupFrames, which: NDArray[np.bool_]) -> GroupFrames:
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
    return np.array(coal.Convex.convexHull(points, True, "Qt").points())


def _extremes(points: Array) -> Array:
    """Return the vertices that are outermost along the axes and diagonals of the group's frame."""
    directions = np.array(np.meshgrid(*([[-1.0, 0.0, 1.0]] * 3))).reshape(3, -1).T
    outermost: Array = points[np.unique((points @ directions.T).argmax(axis=0))]
    return outermost
