"""Points all over the solids of links and over the faces of pads, in the frames of their joints, with trees of them.

`object_points` says how far apart they may be and why.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import coal
import numpy as np

from ..arrays import Array, Mask
from ..descriptions.patches import LinePatch, PlanePatch
from ..geometry.hull_points import solid_points
from ..geometry.hulls import Hull
from ..geometry.patches import above, face_normal, face_point, face_ranges, rectangle
from ..geometry.point_trees import PointTrees, point_trees
from ..geometry.primitives import primitive_triangles
from ..kinematics.pads import Pad
from ..kinematics.robot import Robot
from ..memo import remembered
from .pairs import PlacedSolid, pads_before
from .solids import link_bodies
from .world import Solid

APART, FAR_APART = 0.001, 0.004
"""How far points of a solid may be from the nearest of its points: of links that the hand moves or that carry it, and
of the other links, m."""
RUBBER = 2.0
"""Thickness of rubber, in parts of the depth by which it yields."""
ROUNDED = 0.1
"""How far vertices of a solid may stand out of the hull that has the points, in parts of how far these are apart."""
HIDDEN = 1e-5
"""How deep in another solid of its link a point must be to be left out, m."""
ON_FACE = 1e-5
"""How far from a flat face points still belong to it, m."""
PAD_SPACING = 0.002
"""Between points of the face of a pad, m."""
LID_SPACING = 0.0004
"""Between points where rubber ends, at least, m; otherwise the depth by which it yields."""


class Facets(NamedTuple):
    """Facets of a convex solid, joint's frame."""

    normals: Array
    """Outward unit normals, shape (k, 3)."""
    offsets: Array
    """normal . p on the facets, m, shape (k,)."""


class PointSet(NamedTuple):
    """Points of a solid of a link, or of a part of a pad's face."""

    link: str
    joint: int
    points: Array
    """In the joint's frame, m, shape (n, 3)."""
    pads: tuple[int, ...]
    """Numbers of the pads whose surface bounds their solid."""
    yields: bool
    """Whether they belong to the rubber of these pads."""
    apart: float
    """Largest distance of a point of their hull from the nearest of them, m."""
    within: float
    """How far the solid may stand out of their hull, m."""
    hull: Facets | None = None
    """Of a convex solid that keeps off the object."""


@remembered
def planted_sets(robot: Robot, pads: tuple[str, ...]) -> tuple[tuple[PointSet, ...], int, PointTrees]:
    """Return all sets of an unmounted robot, how many come first that are not behind pads, and their trees.

    The others are those of pads, and of solids behind them: quarters of faces, where rubber ends, and solids.

    Args:
        robot: unmounted.
        pads: names of its pads.
    """
    padded, solids = robot.with_pads(pads), _solid_sets(robot, pads)
    links = [found for found in solids if not found.pads]
    faces = [quarter for number, pad in enumerate(padded.pads) for quarter in _quarters(number, pad)]
    lids = [lid for number in range(len(pads)) if len((lid := _lid(padded, number)).points)]
    sets = [*links, *faces, *lids, *(found for found in solids if found.pads)]
    return tuple(sets), len(links), point_trees([found.points for found in sets], [found.joint for found in sets])


def _solid_sets(robot: Robot, pads: tuple[str, ...]) -> list[PointSet]:
    """Return the points of all solids of links that move, given an unmounted robot and the names of its pads."""
    padded, sets = robot.with_pads(pads), []
    for body in link_bodies(robot):
        if robot.supports[body.joint].any():
            near = _near_the_hand(robot, body.joint)
            for number, solid in enumerate(body.solids):
                behind = pads_before(padded, PlacedSolid(number, body, solid))
                apart = APART if near else FAR_APART
                points, within = _on_solid(robot, body.name, number, apart)
                rubber = _in_rubber(padded, behind, points)
                faces = _on_faces(padded, behind, points)
                for yields in (True, False):
                    some = points[(rubber == yields) & ~faces]
                    if len(some):
                        facets = None if behind else _facets(solid, _hulls(robot, body.name)[number])
                        sets.append(PointSet(body.name, body.joint, some, behind, yields, apart, within, facets))
    return sets


def _in_rubber(robot: Robot, pads: tuple[int, ...], points: Array) -> Mask:
    """Return which points behind pads, joint's frame, shape (n, 3), belong to the rubber of one of them."""
    inside = np.zeros(len(points), dtype=bool)
    for pad in (robot.pads[number] for number in pads):
        heights = above(pad.patch, (points - pad.translation) @ pad.rotation)
        inside |= heights > -RUBBER * pad.description.rubber_depth
    return inside


def _on_faces(robot: Robot, pads: tuple[int, ...], points: Array) -> Mask:
    """Return which points, joint's frame, shape (n, 3), are on flat faces of pads: their quarters stand for them."""
    found = np.zeros(len(points), dtype=bool)
    for pad in (robot.pads[number] for number in pads):
        if isinstance(pad.patch, PlanePatch | LinePatch):
            local = (points - pad.translation) @ pad.rotation
            low, high = rectangle(pad.patch).T
            within = (local[:, :2] >= low) & (local[:, :2] <= high)
            found |= within.all(axis=1) & (np.abs(local[:, 2]) < ON_FACE)
    return found


def _near_the_hand(robot: Robot, joint: int) -> bool:
    """Return whether a link moves with the wrist or with the hand."""
    wrist = robot.model.frames[robot.wrist_frame].parentJoint
    return bool((robot.supports[joint] >= robot.supports[wrist]).all())


@remembered
def _on_solid(robot: Robot, link: str, number: int, apart: float) -> tuple[Array, float]:
    """Return points on a solid of a link, joint's frame, shape (n, 3), and how far it may stand out of their hull, m.

    Those within another solid of the link are left out: that one has points farther out.
    """
    [body] = [body for body in link_bodies(robot) if body.name == link]
    points, within = _on(body.solids[number], apart)
    for i, (solid, hull) in enumerate(zip(body.solids, _hulls(robot, link), strict=True)):
        if i != number and hull is not None:
            R, origin = solid.placement[:3, :3], solid.placement[:3, 3]
            points = points[~hull.holds((points - origin) @ R, HIDDEN)]
    return points, within


def _in_link(robot: Robot, link: str, points: Array) -> Mask:
    """Return which points, joint's frame, shape (n, 3), are in a solid of a link; all if one of these is round."""
    [body] = [body for body in link_bodies(robot) if body.name == link]
    inside = np.zeros(len(points), dtype=bool)
    for solid, hull in zip(body.solids, _hulls(robot, link), strict=True):
        R, origin = solid.placement[:3, :3], solid.placement[:3, 3]
        inside |= True if hull is None else hull.holds((points - origin) @ R)
    return inside


def _facets(solid: Solid, hull: Hull | None) -> Facets | None:
    if hull is None:
        return None
    normals = hull.normals @ solid.placement[:3, :3].T
    return Facets(normals, hull.offsets + normals @ solid.placement[:3, 3])


@remembered
def _hulls(robot: Robot, link: str) -> list[Hull | None]:
    """Return the hulls of the solids of a link, in their frames; None of those that are round."""
    [body] = [body for body in link_bodies(robot) if body.name == link]
    shapes = [solid.shape for solid in body.solids]
    return [Hull(np.array(shape.points())) if isinstance(shape, coal.ConvexBase) else None for shape in shapes]


def _on(solid: Solid, apart: float) -> tuple[Array, float]:
    points, within = solid_points(_vertices(solid), apart, ROUNDED * apart)
    return points @ solid.placement[:3, :3].T + solid.placement[:3, 3], within


def _corners(solid: Solid) -> Array:
    """Return the vertices of a solid, joint's frame, m, shape (n, 3)."""
    return _vertices(solid) @ solid.placement[:3, :3].T + solid.placement[:3, 3]


def _vertices(solid: Solid) -> Array:
    """Return the vertices of a solid in its own frame, of a round one those of triangles on it, m, shape (n, 3)."""
    shape = solid.shape
    if isinstance(shape, coal.Sphere):
        return primitive_triangles("sphere", (shape.radius,)).reshape(-1, 3)
    if isinstance(shape, coal.Cylinder):
        return primitive_triangles("cylinder", (shape.radius, 2.0 * shape.halfLength)).reshape(-1, 3)
    return np.array(shape.points())


def _quarters(number: int, pad: Pad) -> list[PointSet]:
    """Return points of the four quarters of a pad's face."""
    first, second = face_ranges(pad.patch)
    found = []
    for u in _halves(*first):
        for v in _halves(*second):
            grid = np.array([face_point(pad.patch, a, b) for a in u for b in v])
            points = grid @ pad.rotation.T + pad.translation
            found.append(PointSet(pad.description.link, pad.joint, points, (number,), True, 0.0, 0.0))
    return found


def _lid(robot: Robot, number: int) -> PointSet:
    """Return points where the rubber below the face of a pad ends and its backing begins, within the link.

    Rubber reaches as far as the link, beyond the rim of a flat face, too.
    """
    pad = robot.pads[number]
    depth, spacing = pad.description.rubber_depth, max(pad.description.rubber_depth, LID_SPACING)
    ranges = np.array(face_ranges(pad.patch))
    if isinstance(pad.patch, PlanePatch | LinePatch):
        [body] = [body for body in link_bodies(robot) if body.name == pad.description.link]
        corners = (np.concatenate([_corners(solid) for solid in body.solids]) - pad.translation) @ pad.rotation
        ranges[:, 0] = np.minimum(ranges[:, 0], corners.min(axis=0)[:2])
        ranges[:, 1] = np.maximum(ranges[:, 1], corners.max(axis=0)[:2])
    u, v = (np.linspace(low, high, 1 + math.ceil((high - low) * length / spacing)) for low, high, length in ranges)
    face = np.array([face_point(pad.patch, a, b) for a in u for b in v])
    outward = np.array([face_normal(pad.patch, a, b) for a in u for b in v])
    points = (face - RUBBER * depth * outward) @ pad.rotation.T + pad.translation
    beside = [i for i, other in enumerate(robot.pads) if other.description.link == pad.description.link and i != number]
    points = points[~_in_rubber(robot, tuple(beside), points) & _in_link(robot.unmounted, pad.description.link, points)]
    return PointSet(pad.description.link, pad.joint, points, (number,), False, spacing / math.sqrt(2.0), 0.0)


def _halves(low: float, high: float, length: float) -> list[Array]:
    """Return values from the lower end to the middle and from there to the upper end, at most `PAD_SPACING` apart."""
    middle, count = 0.5 * (low + high), 1 + math.ceil(0.5 * (high - low) * length / PAD_SPACING)
    return [np.linspace(low, middle, count), np.linspace(middle, high, count)]
