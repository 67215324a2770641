"""Distances of links to an object that is no union of convex solids: of points all over the links, with gradients.

The surface of every convex solid of a link is divided into triangles with no edge longer than `spacing`; their corners
are the points. Let m be the distance that is to be kept, and q the point of the solid that is nearest to the object,
with o the point there. The way from q to o is perpendicular to what q lies on, a facet, an edge or a corner, and one of
the points, p, lies on that at most spacing / sqrt(3) from q. So |p - o|^2 = |p - q|^2 + |q - o|^2, and

    distance of all points >= sqrt(m^2 + spacing^2 / 3)    gives    |q - o| >= m:

links are kept off the object, and whatever sticks out of the object is kept out of the links.

With the signed distance d of the object and its gradient g at the nearest point p of a solid, dd/dq = g . velocity of p.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import coal
import numpy as np

from ..arrays import Array
from ..descriptions.patches import CylinderPatch, LinePatch, Patch, PlanePatch
from ..geometry.hulls import Hull
from ..geometry.patches import patch_point
from ..geometry.point_trees import PointTrees, point_trees
from ..geometry.primitives import primitive_triangles
from ..geometry.shapes import Surface
from ..geometry.tessellation import Tessellation, refined
from ..kinematics.forward import Configuration
from ..kinematics.robot import Pad, Robot
from ..memo import remembered
from .distances import REACH, Distances, distance_gradients
from .pairs import PlacedSolid, pads_before
from .solids import link_bodies
from .world import Solid

SPACING, COARSE = 0.0012, 0.004
"""Longest edge between points of links that the hand moves or that carry it, and of the other links, m."""
PAD_SPACING = 0.002
"""Between points of the face of a pad, m."""


class PointSet(NamedTuple):
    """Points of a solid of a link, or of a part of a pad's face."""

    link: str
    joint: int
    points: Array
    """In the joint's frame, m, shape (n, 3)."""
    pads: tuple[int, ...]
    """Numbers of the pads whose surface bounds them."""
    beyond: float
    """Largest distance of a point of the surface from the nearest of them, m."""


@dataclass(frozen=True, eq=False)
class ObjectPoints:
    """Sets of points with the distances that they keep from an object."""

    robot: Robot
    sets: tuple[PointSet, ...]
    least: Array
    """Least distance wanted of each set, m, shape (sets,)."""
    trees: PointTrees

    def distances(self, configuration: Configuration, surface: Surface, T_world_object: Array) -> Distances:
        """Measure the sets that are nearer than `REACH` beyond their least distance.

        Args:
            configuration: of the robot.
            surface: of the object, uneven.
            T_world_object: pose of the object, shape (4, 4).
        """
        R, origin = T_world_object[:3, :3], T_world_object[:3, 3]
        rotations = R.T @ configuration.rotations
        translations = (configuration.translations - origin) @ R
        caps = self.least + REACH
        values, points = surface.nearest_points(self.trees, rotations, translations, caps)
        indices = np.flatnonzero(values < caps)
        normals = surface.signed_distance(points[indices])[1] @ R.T
        moves = self.robot.supports[self.trees.bodies[indices]]
        gradients = distance_gradients(
            points[indices] @ R.T + origin, normals, configuration.jacobian, moves, self.robot.B
        )
        return Distances(indices, values[indices], gradients)


def link_points(robot: Robot, margin: float) -> ObjectPoints:
    """Return the points of what is to keep off an object: all of the links but what is behind pads.

    Args:
        robot: mounted, with the pads that are to touch the object.
        margin: distance that solids are to keep, m.
    """
    sets = tuple(found for found in _all_sets(robot) if not found.pads)
    return _kept(robot, sets, [math.hypot(margin, found.beyond) for found in sets])


def pad_points(robot: Robot) -> ObjectPoints:
    """Return the points of what may press into an object by the depth of the rubber: pads, and what is behind them.

    The face of a pad is in four quarters, so that it is known on which sides it is too deep.
    """
    depths = [pad.description.rubber_depth for pad in robot.pads]
    behind = [found for found in _all_sets(robot) if found.pads]
    faces = [quarter for number, pad in enumerate(robot.pads) for quarter in _quarters(number, pad)]
    sets = (*faces, *behind)
    return _kept(robot, sets, [-min(depths[pad] for pad in found.pads) for found in sets])


def _kept(robot: Robot, sets: tuple[PointSet, ...], least: Sequence[float]) -> ObjectPoints:
    trees = point_trees([found.points for found in sets], [found.joint for found in sets])
    return ObjectPoints(robot, sets, np.array(least), trees)


def _all_sets(robot: Robot) -> list[PointSet]:
    """Return the points of all solids of links that move."""
    sets = []
    numbers = iter(range(1_000_000))
    for body in link_bodies(robot):
        if not robot.supports[body.joint].any():
            continue
        fine = _near_the_hand(robot, body.joint)
        for solid, points in zip(body.solids, _solid_points(robot.unmounted, body.name, fine), strict=True):
            placed = PlacedSolid(next(numbers), body, solid)
            beyond = (SPACING if fine else COARSE) / math.sqrt(3.0)
            sets.append(PointSet(body.name, body.joint, points, pads_before(robot, placed), beyond))
    return sets


def _near_the_hand(robot: Robot, joint: int) -> bool:
    """Return whether a link moves with the wrist or with the hand."""
    wrist = robot.model.frames[robot.wrist_frame].parentJoint
    return bool((robot.supports[joint] >= robot.supports[wrist]).all())


@remembered
def _solid_points(robot: Robot, link: str, fine: bool) -> list[Array]:
    """Return points on every solid of a link, joint's frame, shape (n, 3) each; made once for a robot."""
    [body] = [body for body in link_bodies(robot) if body.name == link]
    return [_on(solid, SPACING if fine else COARSE) for solid in body.solids]


def _on(solid: Solid, spacing: float) -> Array:
    corners = _triangles(solid.shape)
    triangles = np.arange(3 * len(corners)).reshape(-1, 3)
    points = refined(Tessellation(corners.reshape(-1, 3), triangles), spacing).vertices
    return points @ solid.placement[:3, :3].T + solid.placement[:3, 3]


def _triangles(shape: Any) -> Array:
    """Return triangles around a Coal geometry, shape (n, 3, 3), m."""
    if isinstance(shape, coal.Sphere):
        return primitive_triangles("sphere", (shape.radius,))
    if isinstance(shape, coal.Cylinder):
        return primitive_triangles("cylinder", (shape.radius, 2.0 * shape.halfLength))
    return Hull(np.array(shape.points())).triangles


def _quarters(number: int, pad: Pad) -> list[PointSet]:
    """Return points of the four quarters of a pad's face."""
    first, second = _ranges(pad.patch)
    found = []
    for u in _halves(*first):
        for v in _halves(*second):
            grid = np.array([_face_point(pad.patch, a, b) for a in u for b in v])
            points = grid @ pad.rotation.T + pad.translation
            found.append(PointSet(pad.description.link, pad.joint, points, (number,), 0.0))
    return found


def _ranges(patch: Patch) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the ranges of two parameters that span the face of a patch, each with metres a unit."""
    if isinstance(patch, LinePatch):
        return (*patch.u, 1.0), (-0.5 * patch.width, 0.5 * patch.width, 1.0)
    if isinstance(patch, PlanePatch):
        return (*patch.u, 1.0), (*patch.v, 1.0)
    if isinstance(patch, CylinderPatch):
        return (*patch.u, 1.0), (*patch.v, patch.radius)
    return (*patch.u, patch.radius), (*patch.v, patch.radius)


def _halves(low: float, high: float, length: float) -> list[Array]:
    """Return values from the lower end to the middle and from there to the upper end, at most `PAD_SPACING` apart."""
    middle, count = 0.5 * (low + high), 1 + math.ceil(0.5 * (high - low) * length / PAD_SPACING)
    return [np.linspace(low, middle, count), np.linspace(middle, high, count)]


def _face_point(patch: Patch, u: float, v: float) -> Array:
    """Return a point of the face, patch frame, m, shape (3,)."""
    if isinstance(patch, LinePatch):
        return np.array([u, v, 0.0])
    return patch_point(patch, np.array([u, v])).point
