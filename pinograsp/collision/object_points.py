"""Distances of links to an object that is no union of convex solids: of points all over the links, with gradients.

Every convex solid of a link has points all over it, of which one is at most a certain way, `apart`, from every point of
it, on the same facet, edge or corner (`geometry.hull_points`). Let m be the distance that is to be kept, and q the
point of the solid that is nearest to the object, with o the point there and p such a point. The way from q to o is
perpendicular to that from q to p. So |p - o|^2 = |p - q|^2 + |q - o|^2, and

    distance of all points >= sqrt(m^2 + apart^2)    gives    |q - o| >= m:

links are kept off the object, and whatever sticks out of the object is kept out of the links.

Where a link is deep in a thin wall, points of the link say nothing: they are out again on the other side. So of a
convex solid that touches the object, the depth of the object's surface in the solid counts, too: with the outward
normal n and the offset b of the facet that is nearest to the deepest point p of the surface, n . p - b.

With the signed distance d of the object and its gradient g at the nearest point p of a solid,

    dd/dq = g . (velocity of p),    d(n . p - b)/dq = -n . (velocity of the link at p)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..geometry.point_trees import PointTrees
from ..geometry.shapes import UnevenSurface
from ..kinematics.forward import Configuration
from ..kinematics.robot import Robot
from .distances import REACH, Distances, distance_gradients
from .point_sets import PointSet, planted_sets

BACKED = 0.0002
"""What the backing of rubber keeps from the object, m."""


@dataclass(frozen=True, eq=False)
class ObjectPoints:
    """Sets of points with the distances that they keep from an object: those of links, then those of pads."""

    robot: Robot
    sets: tuple[PointSet, ...]
    links: int
    """Number of the sets of links; the others are those of pads and of what is behind them."""
    least: Array
    """Least distance wanted of each set, m, shape (sets,)."""
    trees: PointTrees
    solid: Array
    """Distance below which the surface may be within the convex solid of a set, m, shape (sets,)."""

    def distances(self, configuration: Configuration, surface: UnevenSurface, T_world_object: Array) -> Distances:
        """Measure the sets that are nearer than `REACH` beyond their least distance.

        Args:
            configuration: of the robot.
            surface: of the object.
            T_world_object: pose of the object, shape (4, 4).
        """
        R, origin = T_world_object[:3, :3], T_world_object[:3, 3]
        rotations = R.T @ configuration.rotations
        translations = (configuration.translations - origin) @ R
        indices, values, points, local = surface.nearest_points(
            self.trees, rotations, translations, self.least, self.least + REACH
        )
        for row in np.flatnonzero(values < self.solid[indices]).tolist():
            found = self.sets[indices[row]]
            assert found.hull is not None
            facets = found.hull.normals @ rotations[found.joint].T
            depth, point, facet = surface.deepest_point(facets, found.hull.offsets + facets @ translations[found.joint])
            if depth < min(values[row], 0.0):
                values[row], points[row], local[row] = depth, point, -facets[facet]
        moves = self.robot.supports[self.trees.bodies[indices]]
        gradients = distance_gradients(points @ R.T + origin, local @ R.T, configuration.jacobian, moves, self.robot.B)
        return Distances(indices, values, gradients)


def object_points(robot: Robot, margin: float) -> ObjectPoints:
    """Return the points of all of a robot that keeps off an object, or touches it.

    What is not behind a pad keeps the margin. Rubber, which is `point_sets.RUBBER` times as thick as it yields, may
    press into an object by the depth by which it yields; what backs it is off the object by a little, and so is the
    border of both within the link: a thin wall can pass between all points of a face, and be out again on the other
    side of those that are in it. The face of a pad is in four quarters, so that it is known on which sides it is too
    deep.

    Args:
        robot: mounted, with the pads that are to touch the object.
        margin: distance that solids are to keep, m.
    """
    sets, links, trees = planted_sets(robot.unmounted, tuple(pad.description.name for pad in robot.pads))
    depths = [pad.description.rubber_depth for pad in robot.pads]

    def least(number: int, found: PointSet) -> float:
        if found.yields:
            return -min(depths[pad] for pad in found.pads)
        return math.hypot(margin if number < links else BACKED, found.apart) + found.within

    solid = [-math.inf if found.hull is None else found.apart for found in sets]
    return ObjectPoints(
        robot, sets, links, np.array([least(*numbered) for numbered in enumerate(sets)]), trees, np.array(solid)
    )
