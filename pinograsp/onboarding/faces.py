"""Flat faces of a hand, to be looked at where its pads are still to be written."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..geometry.triangle_mesh import TriangleMesh
from ..kinematics.robot import Robot
from .facets import Facet, facets_of
from .findings import Face
from .pad_text import HARD, pad_lines

OF_A_HAND, OF_A_LINK = 40, 6
"""Faces that are shown, about; and of each link at least if it has so many. The largest ones come first."""


def hand_faces(robot: Robot, meshes: Mapping[str, TriangleMesh]) -> tuple[Face, ...]:
    """Return flat faces of the links that the hand moves, and of those that carry them, link by link, large ones first.

    Args:
        robot: the robot.
        meshes: of its links.
    """
    tree = robot.urdf.tree
    hand = [joint for joint in tree.movable if (joint.leader or joint.name) in robot.description.hand.joints]
    bodies = {tree.body(joint.parent) for joint in hand} | {joint.child for joint in hand}
    links = [link for link in tree.links if tree.body(link) in bodies and link in meshes]
    most, found = max(OF_A_LINK, OF_A_HAND // max(len(links), 1)), []
    for link in links:
        facets = sorted(facets_of(link, meshes[link]), key=lambda facet: -float(np.prod(facet.sides)))
        found += [_face(facet, f"{link}_{number}") for number, facet in enumerate(facets[:most], 1)]
    return tuple(found)


def _face(facet: Facet, name: str) -> Face:
    return Face(facet.link, facet.origin, facet.axes, facet.sides, "\n".join(pad_lines(facet, name, HARD)))
