"""Convex solids for Coal, and the bodies made of them.

Every collision mesh of a link is replaced by convex pieces that together contain it (see `geometry.covers`), so that
distances are exact and conservative, also in penetration, where distances of triangle meshes mean nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby, product
from typing import Any

import coal
import numpy as np

from ..arrays import Array
from ..descriptions.bodies import Body as BodyDescription
from ..descriptions.enclosure import Enclosure
from ..geometry.convex_solid import IDENTITY, convex_solid
from ..geometry.cover_cache import mesh_cover
from ..geometry.mesh_file import meshes_of
from ..geometry.shapes import surface_of
from ..kinematics.collision_elements import CollisionElement, collision_elements
from ..kinematics.robot import Robot
from ..memo import remembered
from ..progress import Progress, Report, no_report
from .world import Body, Hull, Role, Solid


def distance_request() -> Any:
    """Return a Coal request for signed distances that do not depend on the query before (no cached guess).

    With Coal's own tolerance, 1e-6 m, normals on cylinders may be 0.01 rad off; this one costs no time.
    """
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_tolerance = 1e-10
    request.gjk_initial_guess = coal.GJKInitialGuess.BoundingVolumeGuess
    return request


def link_bodies(robot: Robot, report: Report = no_report) -> tuple[Body, ...]:
    """Return the collision geometry of a mounted robot by link: primitives, and of every mesh the convex pieces.

    Solids are those of the robot alone, made once for all its scenes and tasks.

    Args:
        robot: the robot.
        report: called while they are made, before every mesh: pieces of one that is new on the machine take a second.

    Raises:
        InputError: a collision element is not understood, or a mesh cannot be read or has no area.
    """
    bodies = _bodies(robot.unmounted)
    if not bodies:
        bodies.extend(tuple(_of_links(robot.unmounted, report)))  # all of them, or none
    return tuple(replace(b, pose=robot.T_world_root) if b.joint == 0 else b for b in bodies)


@remembered
def _bodies(robot: Robot) -> list[Body]:
    """Return the place where the bodies of a robot are kept."""
    del robot
    return []


def _of_links(robot: Robot, report: Report) -> Iterator[Body]:
    all_elements, done = collision_elements(robot), 0
    for (link, joint), elements in groupby(all_elements, key=lambda element: (element.link, element.joint)):
        solids: list[Solid] = []
        for element in elements:
            report(Progress("convex pieces", done, len(all_elements)))
            solids += [bounded(shape, element.placement) for shape in _shapes(element, robot)]
            done += 1
        yield Body("link", link, joint, IDENTITY, tuple(solids), _hulls(tuple(solids)))


def _shapes(element: CollisionElement, robot: Robot) -> list[Any]:
    if element.mesh is None:
        return [_PRIMITIVES[element.kind](*element.size)]
    pieces, tolerance = robot.description.collision.of(element.link)
    with meshes_of(element.link):
        return [convex_solid(vertices) for vertices in mesh_cover(element.mesh, element.size, pieces, tolerance)]


_PRIMITIVES = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder}


def scene_body(role: Role, name: str, body: BodyDescription) -> Body:
    """Return an obstacle or object of the scene."""
    pieces = surface_of(body.shape).solids()
    solids = tuple(bounded(piece.geometry, piece.placement)._replace(part=piece.part) for piece in pieces)
    return Body(role, name, 0, body.pose.matrix, solids, _hulls(solids))


def wall_bodies(enclosure: Enclosure) -> tuple[Body, ...]:
    """Return the walls as half-spaces that lie outside the enclosure."""
    bodies = []
    for name, (inward, offset) in enclosure.walls.items():
        half_space = coal.Halfspace(inward, offset)  # the solid side: inward . p < offset
        half_space.computeLocalAABB()
        solid = Solid(half_space, IDENTITY, np.zeros(3), np.inf)
        bodies.append(Body("wall", name, 0, IDENTITY, (solid,), (Hull(solid, (0,)),)))
    return tuple(bodies)


def bounded(shape: Any, placement: Array) -> Solid:
    """Return a solid with its bounding sphere.

    Args:
        shape: Coal geometry; a box becomes the hull of its corners.
        placement: pose in the body's frame, shape (4, 4).
    """
    if isinstance(shape, coal.Box):
        # Coal 3.0.3 finds no distance for one in some hundred pairs of a Box and a hull that just touch.
        shape = convex_solid(np.array(list(product((-1.0, 1.0), repeat=3))) * np.array(shape.halfSide))
    shape.computeLocalAABB()
    center = placement[:3, :3] @ np.array(shape.aabb_center) + placement[:3, 3]
    return Solid(shape, placement, center, float(shape.aabb_radius))


def _hulls(solids: tuple[Solid, ...]) -> tuple[Hull, ...]:
    """Return solids of one body with all convex pieces made one hull; primitives stay as they are.

    The distance of a hull is that of the nearest piece if the other body is a half-space, else a lower bound of it.
    """
    groups: dict[int, list[int]] = {}
    for i, solid in enumerate(solids):
        groups.setdefault(-1 if isinstance(solid.shape, coal.ConvexBase) else i, []).append(i)
    return tuple(Hull(_joined([solids[i] for i in group]), tuple(group)) for group in groups.values())


def _joined(pieces: list[Solid]) -> Solid:
    if len(pieces) == 1:
        return pieces[0]
    points = [np.array(s.shape.points()) @ s.placement[:3, :3].T + s.placement[:3, 3] for s in pieces]
    return bounded(convex_solid(np.concatenate(points)), IDENTITY)
