"""The bodies that distances are measured between: link hulls of the robot, walls, obstacles, the object.

Every collision mesh of a link is replaced by its convex hull, which contains it, so that distances are exact
and conservative, also in penetration, where distances of triangle meshes mean nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..descriptions.scene import Body, Enclosure
from ..errors import InputError
from .robot import RobotModel
from .shapes import surface_of


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
    """Return a Coal request for signed distances that do not depend on the query before (no cached guess)."""
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_initial_guess = coal.GJKInitialGuess.BoundingVolumeGuess
    return request


def robot_solids(robot: RobotModel) -> list[Solid]:
    """Return the convex hull of every collision geometry of the robot.

    Raises:
        InputError: a mesh cannot be read or has no volume.
    """
    try:
        geometry = pin.buildGeomFromUrdfString(robot.model, robot.urdf.xml, pin.GeometryType.COLLISION)
    except (ValueError, RuntimeError) as error:
        raise InputError(f"a collision mesh cannot be read: {error}", file=robot.description.urdf_file) from None
    solids = []
    for item in geometry.geometryObjects:
        link = robot.model.frames[item.parentFrame].name
        shape = item.geometry
        if isinstance(shape, coal.BVHModelBase):
            shape = _hull(shape, link, robot)
        solids.append(_bounded(link, item.parentJoint, item.placement.homogeneous, shape))
    return solids


def _hull(mesh: Any, link: str, robot: RobotModel) -> Any:
    mesh.buildConvexHull(True, "Qt")
    if mesh.convex is None:
        raise InputError("mesh has no convex hull", file=robot.description.urdf_file, key=f"link {link}")
    return mesh.convex


def self_pairs(robot: RobotModel, solids: list[Solid]) -> list[tuple[int, int]]:
    """Return the pairs of link hulls that move against each other and that the SRDF leaves enabled."""
    pairs = []
    for a, first in enumerate(solids):
        for b, second in enumerate(solids[a + 1 :], a + 1):
            relative = (robot.supports[first.joint] != robot.supports[second.joint]).any()
            if relative and frozenset((first.name, second.name)) not in robot.urdf.disabled_pairs:
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
    shape.computeLocalAABB()
    center = placement[:3, :3] @ np.array(shape.aabb_center) + placement[:3, 3]
    return Solid(name, joint, placement, shape, center, float(shape.aabb_radius))
