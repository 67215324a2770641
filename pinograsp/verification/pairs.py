"""Which pairs of links are checked against each other: all, less those that the SRDF or the tree excuses."""

from __future__ import annotations

from itertools import combinations

from ..descriptions.urdf import RobotUrdf
from .allowed_pairs import Sampling, sorted_out
from .clearance import LinkPair
from .link_mesh import LinkMesh

_EXCUSED = {"adjacent", "default", "always", "user"}


def link_pairs(
    meshes: dict[str, LinkMesh], urdf: RobotUrdf, sampling: Sampling, margin: float
) -> tuple[list[LinkPair], list[LinkPair]]:
    """Return the pairs that must keep the margin and those that must not touch.

    Links of one body are never checked. The second list holds the pairs that the SRDF disables because no
    sample showed them in collision ("Never", or no reason): a claim, so it is checked. Adjacent links need no
    reason. If a file of the robot has no SRDF, adjacent links are left out too, and postures of the robot sort out
    the rest.
    """
    kinematics = sampling.kinematics
    enabled: list[LinkPair] = []
    never: list[LinkPair] = []
    for first, second in combinations(meshes.values(), 2):
        if kinematics.body[first.link] == kinematics.body[second.link]:
            continue
        given = urdf.disabled.get(frozenset((first.link, second.link)))
        adjacent = kinematics.adjacent(first.link, second.link)
        if given is not None:
            if not given & _EXCUSED and not (adjacent and given == {""}):
                never.append((first, second))
        elif urdf.complete or not adjacent:
            enabled.append((first, second))
    if not urdf.complete:
        enabled, further = sorted_out(enabled, sampling, margin)
        never += further
    return enabled, never
