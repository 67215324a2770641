"""Findings about self-collision: what no posture keeps apart, and postures that one expects to be free."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

import coal
import numpy as np

from ..arrays import Array
from ..collision.allowed_pairs import allowed_pairs, always_near, pairs_apart
from ..collision.solids import distance_request
from ..collision.world import Body, BodyKey
from ..descriptions.task import Margins
from ..geometry.triangle_mesh import TriangleMesh
from ..kinematics.forward import forward
from ..kinematics.robot import Robot
from ..kinematics.tree import UrdfTree
from ..words import in_words
from .findings import Finding

CENTRAL = 0.9
"""Part of a joint's range where zero counts as its neutral position; else the middle of the range does."""
MOST_PAIRS = 12
"""Pairs of links that one finding names."""

Links = frozenset[str]


def collision_findings(robot: Robot, meshes: Mapping[str, TriangleMesh]) -> Iterator[Finding]:
    """Look for links that collide, with the margin that a task has if it gives none."""
    margin = Margins().robot
    allowed = allowed_pairs(robot, margin)
    pairs = pairs_apart(robot, allowed)
    if robot.urdf.complete:
        remedy = (
            'Excuse the pair in the SRDF (reason="Always"), or leave the srdf out: then pairs are found by sampling'
        )
        for words in sorted(_words(_names(pair)) for pair in always_near(robot, pairs, margin)):
            what = f"{words} are nearer than {1e3 * margin:g} mm in every posture: no grasp can be found"
            yield Finding("wrong", what, remedy)
    else:
        yield _found_without_srdf(frozenset(map(_names, allowed)) - robot.urdf.disabled_pairs, robot.urdf.tree)
    middle = 0.5 * (robot.lower + robot.upper)
    neutral = np.where(np.abs(middle) < CENTRAL * 0.5 * (robot.upper - robot.lower), 0.0, middle)
    found, known = list[Finding](), set[Links]()
    zero = "joints at zero" if not neutral.any() else "joints at zero or, where that is far off, in mid-range"
    for name, posture in ((zero, neutral), ("joints in mid-range", middle)):
        poses = robot.urdf.tree.poses(robot.joints_by_name(posture))
        overlaps = _overlaps(robot, pairs, posture)
        new = {links: depth for links, depth in overlaps.items() if links not in known}  # the same is told once
        found += list(_overlapping(name, new, poses, meshes))
        known |= overlaps.keys()
    yield from found
    if not found:
        yield Finding("ok", "no self-collision with joints at zero or in mid-range")


def _overlapping(
    posture: str, overlaps: dict[Links, float], poses: Mapping[str, Array], meshes: Mapping[str, TriangleMesh]
) -> Iterator[Finding]:
    """Tell overlaps of the pieces, which contain the meshes, from overlaps of the meshes."""
    colliding = []
    for links in sorted(overlaps, key=_words):
        first, second = links
        if meshes[first].overlaps(meshes[second], np.linalg.inv(poses[first]) @ poses[second]):
            colliding.append(_words(links))
        else:
            depth = f"overlap by {1e3 * overlaps[links]:.1f} mm, the meshes do not"
            remedy = "Raise the number of their pieces under collision.links"
            yield Finding("doubtful", f"with {posture}, convex pieces of {_words(links)} {depth}", remedy)
    if colliding:
        remedy = "Look at the picture; if they are meant to touch there, excuse the pairs in an SRDF"
        yield Finding("doubtful", f"with {posture}, {in_words(colliding, MOST_PAIRS)} collide", remedy)


def _found_without_srdf(excused: frozenset[Links], tree: UrdfTree) -> Finding:
    others = sorted(_words(links) for links in excused if not tree.adjacent(*links))
    what = f"not every URDF has an SRDF: {len(excused) - len(others)} pairs of neighbours are not checked"
    if others:
        what += f", nor {len(others)} that never get apart or, in the hand, never touch: {in_words(others, 3)}"
    return Finding("ok", what)


def _overlaps(robot: Robot, pairs: list[tuple[Body, Body]], posture: Array) -> dict[Links, float]:
    """Return the links whose solids overlap in a posture, and how deep, m."""
    configuration, request = forward(robot, robot.model.createData(), posture), distance_request()

    def placed(body: Body) -> list[tuple[Any, Any]]:
        """Return the shapes of a link with their poses."""
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = configuration.rotations[body.joint], configuration.translations[body.joint]
        poses = [T @ body.pose @ solid.placement for solid in body.solids]
        shapes = (solid.shape for solid in body.solids)
        return [(shape, coal.Transform3s(P[:3, :3], P[:3, 3])) for shape, P in zip(shapes, poses, strict=True)]

    found: dict[Links, float] = {}
    for first, second in pairs:
        depths = [
            -float(coal.distance(*a, *b, request, coal.DistanceResult()))
            for a, b in product(placed(first), placed(second))
        ]
        if (depth := max(depths)) > 0.0:
            found[frozenset((first.name, second.name))] = depth
    return found


def _names(pair: frozenset[BodyKey]) -> Links:
    return frozenset(key.name for key in pair)


def _words(links: Links) -> str:
    return " and ".join(sorted(links))
