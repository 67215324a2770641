"""The bodies that distances are measured between: links of the robot, walls, obstacles, the object.

Every collision mesh of a link is replaced by convex pieces that together contain it (see `covers`), so that
distances are exact and conservative, also in penetration, where distances of triangle meshes mean nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import coal
import numpy as np

from ..arrays import Array
from ..descriptions.scene import Body, Enclosure
from ..geometry.cover_cache import mesh_cover
from ..geometry.shapes import surface_of
from ..kinematics.collision_elements import CollisionElement, collision_elements
from ..kinematics.robot import RobotModel


@dataclass(frozen=True)
class Solid:
    """A convex body fixed to a joint of the robot, or to the world (joint 0)."""

    name: str
    """Link, wall, obstacle or object."""
    joint: int
    placement: Array
    """Pose of the shape in its joint's frame, shape (4, 4)."""
    shape: Any
    """Coal geometry."""
    center: Array
    """Centre of the bounding sphere in the joint's frame, shape (3,); unused for a wall."""
    radius: float
    """Of the bounding sphere, m; infinite for a wall."""


def distance_request() -> Any:
    """Return a Coal request for signed distances that do not depend on the query before (no cached guess).

    With Coal's own tolerance, 1e-6 m, normals on cylinders may be 0.01 rad off; this one costs no time.
    """
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_tolerance = 1e-10
    request.gjk_initial_guess = coal.GJKInitialGuess.BoundingVolumeGuess
    return request


def robot_solids(robot: RobotModel) -> list[Solid]:
    """Return the collision geometry of the robot: primitives, and of every mesh the convex pieces.

    Raises:
        InputError: a collision element is not understood, or a mesh cannot be read or has no volume.
    """
    return [
        _bounded(element.link, element.joint, element.placement, shape)
        for element in collision_elements(robot)
        for shape in _shapes(element, robot)
    ]


def _shapes(element: CollisionElement, robot: RobotModel) -> list[Any]:
    if element.mesh is None:
        return [_PRIMITIVES[element.kind](*element.size)]
    pieces, tolerance = robot.description.collision.of(element.link)
    return [_convex(vertices) for vertices in mesh_cover(element.mesh, element.size, pieces, tolerance)]


_PRIMITIVES = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder}


def _convex(points: Array) -> Any:
    """Return the convex hull of points, shape (n, 3), for Coal."""
    cloud = coal.StdVec_Vec3s()
    cloud.extend(list(points))
    return coal.Convex.convexHull(cloud, True, "Qt")


@dataclass(frozen=True)
class Whole:
    """The convex hull of pieces of one link, or a single solid as it is."""

    solid: Solid
    pieces: tuple[int, ...]
    """Which solids it is the hull of."""


def wholes(solids: list[Solid]) -> list[Whole]:
    """Return the solids with all convex pieces of a link made one hull; primitives stay as they are.

    The distance of a hull is that of the nearest piece if the other body is a half-space, else a lower bound of it.
    """
    groups: dict[tuple[str, int, int], list[int]] = {}
    for i, solid in enumerate(solids):
        own = -1 if isinstance(solid.shape, coal.ConvexBase) else i
        groups.setdefault((solid.name, solid.joint, own), []).append(i)
    return [Whole(_joined([solids[i] for i in group]), tuple(group)) for group in groups.values()]


def _joined(pieces: list[Solid]) -> Solid:
    if len(pieces) == 1:
        return pieces[0]
    points = [np.array(s.shape.points()) @ s.placement[:3, :3].T + s.placement[:3, 3] for s in pieces]
    return _bounded(pieces[0].name, pieces[0].joint, np.eye(4), _convex(np.concatenate(points)))


def self_pairs(robot: RobotModel, solids: list[Solid], excused: frozenset[frozenset[str]]) -> list[tuple[int, int]]:
    """Return the pairs of solids that move against each other, except those of links that are excused."""
    pairs = []
    for a, first in enumerate(solids):
        for b, second in enumerate(solids[a + 1 :], a + 1):
            relative = (robot.supports[first.joint] != robot.supports[second.joint]).any()
            if relative and frozenset((first.name, second.name)) not in excused:
                pairs.append((a, b))
    return pairs


def body_solid(name: str, body: Body) -> Solid:
    """Return an obstacle or object of the scene."""
    return _bounded(name, 0, body.pose.matrix, surface_of(body.shape).coal_shape())


def wall_solids(enclosure: Enclosure) -> list[Solid]:
    """Return the walls as half-spaces that lie outside the enclosure."""
    solids = []
    for name, (inward, offset) in enclosure.walls.items():
        half_space = coal.Halfspace(inward, offset)  # the solid side: inward . p < offset
        half_space.computeLocalAABB()
        solids.append(Solid(name, 0, np.eye(4), half_space, np.zeros(3), np.inf))
    return solids


def _bounded(name: str, joint: int, placement: Array, shape: Any) -> Solid:
    if isinstance(shape, coal.Box):
        # Coal 3.0.3 finds no distance for one in some hundred pairs of a Box and a hull that just touch.
        shape = _convex(np.array(list(product((-1.0, 1.0), repeat=3))) * np.array(shape.halfSide))
    shape.computeLocalAABB()
    center = placement[:3, :3] @ np.array(shape.aabb_center) + placement[:3, 3]
    return Solid(name, joint, placement, shape, center, float(shape.aabb_radius))
