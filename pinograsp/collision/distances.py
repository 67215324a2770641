"""Exact signed distances of the bodies of a world that must keep apart, with gradients.

For a pair with witness points p1, p2 and unit normal n from the first body to the second,

    d = n . (p2 - p1),    dd/dq = n . (velocity of p2 - velocity of p1) = ((n, p1 x n) . J) (support_2 - support_1)

with world Jacobian columns J and the joints that move each body.

Pairs whose bounding spheres or boxes are `REACH` or more beyond their margin are not measured: their distance is known
to be at least that, and users of the distances must treat all such values alike (`problem.constraints.clearance` does,
so that culling never makes a constraint jump). Obstacles are found by a tree.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled
from ..kinematics.forward import Configuration
from ..kinematics.robot import Robot
from .ball_tree import BallTree
from .boxes import half_edges, near_pairs
from .pairs import LinkPairs, PadPairs, pairs_of
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
        self.link_pairs, self.pad_pairs = LinkPairs.among(self.pairs), PadPairs.among(self.pairs)
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
        self._halves = np.array(
            [np.zeros(3) if isinstance(shape, coal.Halfspace) else half_edges(shape) for shape in self.shapes]
        )
        """Half edges of the bounding boxes, in the solids' frames, m, shape (solids, 3)."""
        self._moving = np.flatnonzero(self.joints)
        self._obstacles = np.array([p.number for p in solids if p.body.role == "obstacle"], dtype=np.intp)
        columns = np.zeros(len(solids), dtype=np.intp)
        columns[self._obstacles] = np.arange(len(self._obstacles))
        # Which pair a solid and an obstacle make; -1: none.
        self._table = np.full((len(solids), len(self._obstacles)), -1, dtype=np.intp)
        around = np.isin(self._second, self._obstacles)
        self._table[self._first[around], columns[self._second[around]]] = np.flatnonzero(around)
        self._others = np.flatnonzero(~around)
        met = set(self._first[around].tolist())
        hulls = [p for p in solids if met.intersection(p.parts)]
        self._hulls = np.array([hull.number for hull in hulls], dtype=np.intp)
        self._parts = np.array([part for hull in hulls for part in hull.parts], dtype=np.intp)
        self._ends = np.cumsum([0, *(len(hull.parts) for hull in hulls)])
        self._around = np.full(len(hulls), REACH + world.margins.get("obstacle", 0.0))
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
        self._stand()

    def _stand(self) -> None:
        """Place what no joint moves, and make the tree of the obstacles."""
        self._rotations, self._translations = self.placements[:, :3, :3].copy(), self.placements[:, :3, 3].copy()
        at = self._obstacles
        centers = np.einsum("nij,nj->ni", self._rotations[at], self._centers[at]) + self._translations[at]
        self._tree = BallTree.of(centers, self._radii[at])

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
        model._stand()
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
        indices = self._near(rotations, translations)
        values, points, normals = self._measure(indices, rotations, translations)
        gradients = distance_gradients(points, normals, configuration.jacobian, self._moves[indices], self._robot.B)
        return Distances(indices, values, gradients)

    def _near(self, rotations: Array, translations: Array) -> Indices:
        """Return the pairs that can be nearer than their reach, ascending."""
        at = _centers(rotations, translations, self._centers)
        hulls = self._hulls
        rows, columns = self._tree.near(rotations[hulls], at[hulls], self._halves[hulls], self._around)
        candidates = _candidates(self._others, rows, columns, self._table, self._parts, self._ends)
        return near_pairs(
            candidates,
            rotations,
            translations,
            at,
            self._radii,
            self._halves,
            self._normals,
            self._offsets,
            self._first,
            self._second,
            self._reach,
        )

    def _placed(self, configuration: Configuration) -> tuple[Array, Array]:
        """Return the poses of all solids: rotations (solids, 3, 3), translations (solids, 3), world."""
        rotations, translations = self._rotations.copy(), self._translations.copy()
        moving, joints = self._moving, self.joints
        _place(
            rotations,
            translations,
            configuration.rotations,
            configuration.translations,
            moving,
            joints,
            self.placements,
        )
        return rotations, translations

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
def _place(
    rotations: Array,
    translations: Array,
    joint_rotations: Array,
    joint_translations: Array,
    moving: Indices,
    joints: Indices,
    placements: Array,
) -> None:
    """Set rotations and translations of the solids that are placed in the frames of moving joints."""
    for solid in moving:
        joint = joints[solid]
        for row in range(3):
            translations[solid, row] = joint_translations[joint, row]
            for column in range(3):
                rotations[solid, row, column] = 0.0
            for k in range(3):
                translations[solid, row] += joint_rotations[joint, row, k] * placements[solid, k, 3]
                for column in range(3):
                    rotations[solid, row, column] += joint_rotations[joint, row, k] * placements[solid, k, column]


@compiled
def _centers(rotations: Array, translations: Array, centers: Array) -> Array:
    """Return the centres of the bounding spheres in the world, m, shape (solids, 3)."""
    at = translations.copy()
    for solid in range(len(at)):
        for row in range(3):
            for k in range(3):
                at[solid, row] += rotations[solid, row, k] * centers[solid, k]
    return at


@compiled
def _candidates(
    others: Indices, hulls: Indices, columns: Indices, table: Indices, parts: Indices, ends: Indices
) -> Indices:
    """Return the other pairs, and those of the parts of hulls with obstacles that these are near to, ascending."""
    most = 0
    for hull in hulls:
        most += ends[hull + 1] - ends[hull]
    met, count = np.empty(most, dtype=np.intp), 0
    for k in range(len(hulls)):
        for part in parts[ends[hulls[k]] : ends[hulls[k] + 1]]:
            pair = table[part, columns[k]]
            if pair >= 0:
                met[count] = pair
                count += 1
    met = np.sort(met[:count])
    found = np.empty(len(others) + count, dtype=np.intp)
    i, j = 0, 0
    for k in range(len(found)):
        if j == count or (i < len(others) and others[i] < met[j]):
            found[k] = others[i]
            i += 1
        else:
            found[k] = met[j]
            j += 1
    return found


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
