"""Exact signed distances of the robot to its surroundings and to itself, with gradients.

For a pair with witness points p1, p2 and unit normal n from the first body to the second,

    d = n . (p2 - p1),    dd/dq = n . (velocity of p2 - velocity of p1) = ((n, p1 x n) . J) (support_2 - support_1)

with world Jacobian columns J and the joints that move each body.

Pairs whose bounding spheres are `REACH` or more beyond their margin are not measured: their distance is known to
be at least that, and users of the distances must treat all such values alike (`problem.terms.clearance` does, so
that culling never makes a constraint jump).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import coal
import numpy as np

from ..arrays import Array, Indices
from ..compiled import compiled
from ..descriptions import SceneDescription, TaskDescription
from ..geometry.patches import above
from ..kinematics.forward import Configuration
from ..kinematics.robot import RobotModel
from .allowed_pairs import excused_links
from .solids import Solid, body_solid, distance_request, robot_solids, self_pairs, wall_solids, wholes

Kind = Literal["enclosure", "object", "self"]
REACH = 0.03
"""Pairs farther apart than this, beyond their margin, are not measured, m."""

SLACK = 2e-5
"""Kept on top of the margins, m: the certificate sees round primitives as facets that stand a little outside them."""


@dataclass(frozen=True)
class Pair:
    """Two bodies that must keep apart."""

    kind: Kind
    link: str
    """The robot's link; in a self pair the outer one."""
    other: str
    """What it must keep clear of: a wall, an obstacle, the object or a link."""
    first: int
    second: int
    margin: float
    """Least distance wanted, m."""

    @property
    def name(self) -> str:
        """Both bodies in words."""
        return f"{self.link} - {self.other}"


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
    """The pairs of bodies of a task, and their distances at a configuration."""

    def __init__(self, robot: RobotModel, scene: SceneDescription, task: TaskDescription) -> None:
        links = robot_solids(robot)
        hulls = [whole.solid for whole in wholes(links)]
        walls = wall_solids(scene.enclosure)
        obstacles = [body_solid(name, body) for name, body in scene.bodies_besides(task).items()]
        target = body_solid(task.object, scene.objects[task.object])
        self._robot = robot
        self._solids = [*links, *hulls, *walls, *obstacles, target]
        self._margins: dict[Kind, float] = {
            "enclosure": task.margin.enclosure + SLACK,
            "object": 0.0,
            "self": task.margin.robot + SLACK,
        }
        self.pairs = tuple(self._pairs(len(links), len(hulls), len(walls), len(obstacles), task.margin.robot))
        self._reach = REACH + np.array([pair.margin for pair in self.pairs])
        first = np.array([pair.first for pair in self.pairs])
        second = np.array([pair.second for pair in self.pairs])
        joints = np.array([solid.joint for solid in self._solids])
        self._joints = joints
        self._placements = np.array([solid.placement for solid in self._solids])
        self._centers = np.array([s.placement[:3, :3].T @ (s.center - s.placement[:3, 3]) for s in self._solids])
        self._first, self._second = first, second
        self._moves = robot.supports[joints[second]] - robot.supports[joints[first]]
        self._radii = np.array([solid.radius for solid in self._solids])
        # Of the walls, rows of other solids are not used.
        self._normals, self._offsets = np.zeros((len(joints), 3)), np.zeros(len(joints))
        for wall, (inward, offset) in enumerate(scene.enclosure.walls.values(), len(links) + len(hulls)):
            self._normals[wall], self._offsets[wall] = inward, offset
        self._request = distance_request()
        # What Coal reads and writes at every measurement: made once, since making it costs more than measuring.
        self._poses = [coal.Transform3s() for _ in self._solids]
        self._result = coal.DistanceResult()
        self._queries = [self._query(pair) for pair in self.pairs]

    def joint(self, solid: int) -> int:
        """Return the joint that carries a solid."""
        return int(self._joints[solid])

    def _query(self, pair: Pair) -> Callable[[], float]:
        """Return what measures a pair at the poses of its solids into the result."""
        measure = coal.ComputeDistance(self._solids[pair.first].shape, self._solids[pair.second].shape)
        poses = self._poses[pair.first], self._poses[pair.second]
        return partial(measure, *poses, self._request, self._result)

    def distances(self, configuration: Configuration) -> Distances:
        """Measure every pair that may be closer than `REACH` beyond its margin."""
        turns, shifts = self._placed(configuration)
        indices = _near(
            turns,
            shifts,
            self._centers,
            self._radii,
            self._normals,
            self._offsets,
            self._first,
            self._second,
            self._reach,
        )
        values, points, normals = self._measure(indices, turns, shifts)
        gradients = _gradients(points, normals, configuration.jacobian, self._moves[indices], self._robot.B)
        return Distances(indices, values, gradients)

    def _placed(self, configuration: Configuration) -> tuple[Array, Array]:
        """Return the poses of all solids: rotations (solids, 3, 3), translations (solids, 3), world."""
        return _placed(configuration.rotations, configuration.translations, self._joints, self._placements)

    def measure(self, indices: Indices, configuration: Configuration) -> tuple[Array, Array, Array]:
        """Measure some pairs, whether near or not.

        Returns:
            Distances (k,), witness points on the first bodies (k, 3), and unit normals from the first bodies to the
            second (k, 3); m, world.
        """
        return self._measure(indices, *self._placed(configuration))

    def _measure(self, indices: Indices, turns: Array, shifts: Array) -> tuple[Array, Array, Array]:
        for solid in {*self._first[indices].tolist(), *self._second[indices].tolist()}:
            self._poses[solid].setTransform(turns[solid], shifts[solid])
        values = np.empty(len(indices))
        points, normals = np.empty((len(indices), 3)), np.empty((len(indices), 3))
        result = self._result
        for row, index in enumerate(indices.tolist()):
            result.clear()
            values[row] = self._queries[index]()
            points[row] = result.getNearestPoint1()
            normals[row] = result.normal
        return values, points, normals

    def _pairs(self, links: int, hulls: int, walls: int, obstacles: int, margin: float) -> list[Pair]:
        """List the pairs that can move against each other; wall pairs first, link by link.

        Walls against whole hulls: a half-space is as far from them as from the nearest piece.
        """
        solids, supports = self._solids, self._robot.supports
        moving = [i for i in range(links) if supports[solids[i].joint].any()]
        whole = [i for i in range(links, links + hulls) if supports[solids[i].joint].any()]
        wall = range(links + hulls, links + hulls + walls)
        around = range(wall.stop, wall.stop + obstacles)
        target = around.stop

        def pair(kind: Kind, a: int, b: int, link: int, other: int) -> Pair:
            return Pair(kind, solids[link].name, solids[other].name, a, b, self._margins[kind])

        excused = excused_links(self._robot, solids[:links], margin)
        pairs = [pair("enclosure", i, w, i, w) for i in whole for w in wall]
        pairs += [pair("enclosure", i, o, i, o) for i in moving for o in around]
        pairs += [pair("object", i, target, i, target) for i in moving if not self._behind_its_pad(solids[i])]
        pairs += [pair("self", a, b, b, a) for a, b in self_pairs(self._robot, solids[:links], excused)]
        return pairs

    def _behind_its_pad(self, solid: Solid) -> bool:
        """Return whether the surface of a pad bounds the link, or this piece of it.

        Then contact and tangency at the pad already keep the piece off a convex object. Its distance to the
        object is zero at every grasp with the gradient of the contact condition: as one more inequality it
        would only make the problem degenerate.
        """
        if isinstance(solid.shape, coal.Sphere):
            points, around = solid.placement[None, :3, 3], float(solid.shape.radius)
        elif isinstance(solid.shape, coal.ConvexBase):
            points, around = np.array(solid.shape.points()) @ solid.placement[:3, :3].T + solid.placement[:3, 3], 0.0
        else:
            return False
        return any(
            pad.joint == solid.joint
            and pad.description.link == solid.name
            and float(above(pad.patch, (points - pad.translation) @ pad.rotation).max()) + around < 2e-6
            for pad in self._robot.pads
        )


@compiled
def _placed(rotations: Array, translations: Array, joints: Indices, placements: Array) -> tuple[Array, Array]:
    """Return rotations and translations of solids that are placed in the frames of joints."""
    turns, shifts = np.zeros((len(joints), 3, 3)), np.empty((len(joints), 3))
    for solid in range(len(joints)):
        joint = joints[solid]
        for row in range(3):
            shifts[solid, row] = translations[joint, row]
            for k in range(3):
                shifts[solid, row] += rotations[joint, row, k] * placements[solid, k, 3]
                for column in range(3):
                    turns[solid, row, column] += rotations[joint, row, k] * placements[solid, k, column]
    return turns, shifts


@compiled
def _near(
    turns: Array,
    shifts: Array,
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
        turns: rotations of the solids, shape (solids, 3, 3).
        shifts: translations of the solids, world, m, shape (solids, 3).
        centers: of the bounding spheres, in the solids' frames, m, shape (solids, 3).
        radii: of the solids, m, shape (solids,).
        normals: of the walls, inward, shape (solids, 3).
        offsets: of the walls: normal . p on them, m, shape (solids,).
        first: solid of every pair, shape (pairs,).
        second: solid or wall of every pair, shape (pairs,).
        reach: of every pair, m, shape (pairs,).
    """
    at = shifts.copy()
    for solid in range(len(at)):
        for row in range(3):
            for k in range(3):
                at[solid, row] += turns[solid, row, k] * centers[solid, k]
    near = np.empty(len(first), dtype=np.intp)
    count = 0
    for pair in range(len(first)):
        a, b = first[pair], second[pair]
        if math.isinf(radii[b]):
            height = -offsets[b]
            for axis in range(3):
                height += at[a, axis] * normals[b, axis]
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
def _gradients(points: Array, normals: Array, jacobian: Array, moves: Array, B: Array) -> Array:
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
