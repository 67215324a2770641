"""Exact signed distances of the bodies of a world that must keep apart, with gradients.

For a pair with witness points p1, p2 and unit normal n from the first body to the second,

    d = n . (p2 - p1),    dd/dq = n . (velocity of p2 - velocity of p1) = ((n, p1 x n) . J) (support_2 - support_1)

with world Jacobian columns J and the joints that move each body.

Pairs whose bounding spheres are `REACH` or more beyond their margin are not measured: their distance is known to
be at least that, and users of the distances must treat all such values alike (`problem.constraints.clearance` does, so
that culling never makes a constraint jump).
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled
from ..kinematics.forward import Configuration
from ..kinematics.robot import Robot
from .pairs import pairs_of
from .solids import distance_request
from .world import BodyKey, World

REACH = 0.03
"""Pairs farther apart than this, beyond their margin, are not measured, m."""


@dataclass(frozen=True)
class Distances:
    """Signed distances of the measured pairs."""

    indices: Indices
    """Which pairs of `CollisionModel.pairs` were measured, shape (k,)."""
    values: Array
    """Signed distances, m, shape (k,)."""
    gradients: Array
    """In the posture, shape (k, l + s)."""


class CollisionModel:
    """The distances of a world at configurations of the robot."""

    def __init__(self, robot: Robot, world: World) -> None:
        self._robot = robot
        solids, self.pairs = pairs_of(robot, world)
        self.shapes = tuple(placed.solid.shape for placed in solids)
        """Coal geometries; the pairs refer to them by number."""
        self._owners = tuple(placed.body.key for placed in solids)
        self.joints = np.array([placed.body.joint for placed in solids])
        """Parent of every solid, shape (solids,)."""
        self._local = np.array([placed.solid.placement for placed in solids])
        self.placements = np.array([placed.body.pose @ placed.solid.placement for placed in solids])
        """Poses of the solids in their parents' frames, shape (solids, 4, 4)."""
        centers = [s.placement[:3, :3].T @ (s.center - s.placement[:3, 3]) for s in (placed.solid for placed in solids)]
        self._centers = np.array(centers)
        self._radii = np.array([placed.solid.radius for placed in solids])
        self._first = np.array([pair.first for pair in self.pairs])
        self._second = np.array([pair.second for pair in self.pairs])
        self._reach = REACH + np.array([pair.margin for pair in self.pairs])
        self._moves = robot.supports[self.joints[self._second]] - robot.supports[self.joints[self._first]]
        # Of the walls, in their own frames; rows of other solids are not used.
        self._normals, self._offsets = np.zeros((len(solids), 3)), np.zeros(len(solids))
        for number, shape in enumerate(self.shapes):
            if isinstance(shape, coal.Halfspace):
                self._normals[number], self._offsets[number] = shape.n, shape.d
        self._request = distance_request()
        # What Coal reads and writes at every measurement: made once, since making it costs more than measuring.
        self._poses = [coal.Transform3s() for _ in solids]
        self._result = coal.DistanceResult()
        self._queries: list[Any] = [None] * len(self.pairs)

    def moved(self, key: BodyKey, pose: Array) -> CollisionModel:
        """Return the model with one body at another pose in its parent's frame, shape (4, 4); nothing is rebuilt.

        Both share what Coal reads and writes at a measurement: they are for one thread.

        Raises:
            KeyError: there is no such body.
        """
        if key not in self._owners:
            raise KeyError(key)
        model = copy.copy(self)
        model.placements = self.placements.copy()
        for number, owner in enumerate(self._owners):
            if owner == key:
                model.placements[number] = pose @ self._local[number]
        return model

    def _query(self, index: int) -> Any:
        """Return Coal's query of a pair, made when it is first measured."""
        query = self._queries[index]
        if query is None:
            pair = self.pairs[index]
            query = self._queries[index] = coal.ComputeDistance(self.shapes[pair.first], self.shapes[pair.second])
        return query

    def distances(self, configuration: Configuration) -> Distances:
        """Measure every pair that may be closer than `REACH` beyond its margin."""
        rotations, translations = self._placed(configuration)
        indices = _near(
            rotations,
            translations,
            self._centers,
            self._radii,
            self._normals,
            self._offsets,
            self._first,
            self._second,
            self._reach,
        )
        values, points, normals = self._measure(indices, rotations, translations)
        gradients = distance_gradients(points, normals, configuration.jacobian, self._moves[indices], self._robot.B)
        return Distances(indices, values, gradients)

    def _placed(self, configuration: Configuration) -> tuple[Array, Array]:
        """Return the poses of all solids: rotations (solids, 3, 3), translations (solids, 3), world."""
        return _placed(configuration.rotations, configuration.translations, self.joints, self.placements)

    def measure(self, indices: Indices, configuration: Configuration) -> tuple[Array, Array, Array]:
        """Measure some pairs, whether near or not.

        Returns:
            Distances (k,), witness points on the first bodies (k, 3), and unit normals from the first bodies to the
            second (k, 3); m, world.
        """
        return self._measure(indices, *self._placed(configuration))

    def _measure(self, indices: Indices, rotations: Array, translations: Array) -> tuple[Array, Array, Array]:
        for solid in {*self._first[indices].tolist(), *self._second[indices].tolist()}:
            self._poses[solid].setTransform(rotations[solid], translations[solid])
        values = np.empty(len(indices))
        points, normals = np.empty((len(indices), 3)), np.empty((len(indices), 3))
        result = self._result
        poses, request = self._poses, self._request
        for row, index in enumerate(indices.tolist()):
            result.clear()
            pair = self.pairs[index]
            values[row] = self._query(index)(poses[pair.first], poses[pair.second], request, result)
            points[row] = result.getNearestPoint1()
            normals[row] = result.normal
        return values, points, normals


@compiled
def _placed(
    joint_rotations: Array, joint_translations: Array, joints: Indices, placements: Array
) -> tuple[Array, Array]:
    """Return rotations and translations of solids that are placed in the frames of joints."""
    rotations, translations = np.zeros((len(joints), 3, 3)), np.empty((len(joints), 3))
    for solid in range(len(joints)):
        joint = joints[solid]
        for row in range(3):
            translations[solid, row] = joint_translations[joint, row]
            for k in range(3):
                translations[solid, row] += joint_rotations[joint, row, k] * placements[solid, k, 3]
                for column in range(3):
                    rotations[solid, row, column] += joint_rotations[joint, row, k] * placements[solid, k, column]
    return rotations, translations


@compiled
def _near(
    rotations: Array,
    translations: Array,
    centers: Array,
    radii: Array,
    normals: Array,
    offsets: Array,
    first: Indices,
    second: Indices,
    reach: Array,
) -> Indices:
    """Return the pairs that can be nearer than their reach, from bounding spheres; walls have an infinite radius.

    Args:
        rotations: rotations of the solids, shape (solids, 3, 3).
        translations: translations of the solids, world, m, shape (solids, 3).
        centers: of the bounding spheres, in the solids' frames, m, shape (solids, 3).
        radii: of the solids, m, shape (solids,).
        normals: of the walls, inward, in their own frames, shape (solids, 3).
        offsets: of the walls: normal . p on them, m, shape (solids,).
        first: solid of every pair, shape (pairs,).
        second: solid or wall of every pair, shape (pairs,).
        reach: of every pair, m, shape (pairs,).
    """
    at = translations.copy()
    for solid in range(len(at)):
        for row in range(3):
            for k in range(3):
                at[solid, row] += rotations[solid, row, k] * centers[solid, k]
    near = np.empty(len(first), dtype=np.intp)
    count = 0
    for pair in range(len(first)):
        a, b = first[pair], second[pair]
        if math.isinf(radii[b]):
            height = -offsets[b]
            for axis in range(3):
                inward = 0.0
                for k in range(3):
                    inward += rotations[b, axis, k] * normals[b, k]
                height += (at[a, axis] - translations[b, axis]) * inward
            close = height - radii[a] < reach[pair]
        else:
            square, limit = 0.0, reach[pair] + radii[a] + radii[b]
            for axis in range(3):
                square += (at[a, axis] - at[b, axis]) ** 2
            close = square < limit * limit
        if close:
            near[count] = pair
            count += 1
    return near[:count].copy()


@compiled
def distance_gradients(points: Array, normals: Array, jacobian: Array, moves: Array, B: Array) -> Array:
    """Return the gradients of distances, shape (k, l + s); `moves` holds support_2 - support_1, shape (k, nv)."""
    gradients = np.zeros((len(points), B.shape[1]))
    for pair in range(len(points)):
        for joint in range(len(B)):
            if moves[pair, joint] == 0.0:
                continue
            along = 0.0
            for x in range(3):
                y, z = (x + 1) % 3, (x + 2) % 3
                arm = points[pair, y] * normals[pair, z] - points[pair, z] * normals[pair, y]
                along += normals[pair, x] * jacobian[x, joint] + arm * jacobian[3 + x, joint]
            for variable in range(B.shape[1]):
                gradients[pair, variable] += moves[pair, joint] * along * B[joint, variable]
    return gradients
