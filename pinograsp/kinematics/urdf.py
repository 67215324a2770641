"""The URDF of a robot, read once: as it is composed, as a tree of links and joints, and as Pinocchio gets it."""

from __future__ import annotations

from dataclasses import dataclass

from ..descriptions import RobotDescription
from ..descriptions.urdf import Mimic, RobotUrdf, read_urdf
from .pinocchio_xml import pinocchio_xml
from .tree import UrdfTree


@dataclass(frozen=True)
class PreparedUrdf:
    """A prepared URDF."""

    composed: RobotUrdf
    tree: UrdfTree
    xml: str
    """For Pinocchio."""
    links: tuple[str, ...]
    movable: dict[str, str]
    """Movable joints of the URDF, name to type as written there (revolute, continuous, prismatic)."""
    mimics: dict[str, Mimic]
    meshes: tuple[str, ...]
    """Collision mesh files, absolute paths."""
    disabled_pairs: frozenset[frozenset[str]]
    """Pairs of links that the SRDF takes out of self-collision checks."""
    complete: bool
    """Whether every file has an SRDF; else it is not known of all pairs whether they may touch."""


def prepare(description: RobotDescription) -> PreparedUrdf:
    """Read, compose and check the URDF of a robot.

    Raises:
        InputError: a URDF or SRDF cannot be parsed or used, or a mesh is not found.
    """
    composed = read_urdf(description)
    tree = UrdfTree(composed, description.urdf_file)
    return PreparedUrdf(
        composed=composed,
        tree=tree,
        xml=pinocchio_xml(composed.tree),
        links=composed.links,
        movable={joint.name: joint.kind for joint in tree.movable},
        mimics=tree.mimics,
        meshes=tuple(mesh.get("filename", "") for mesh in composed.tree.iterfind("link/collision/geometry/mesh")),
        disabled_pairs=frozenset(composed.disabled),
        complete=composed.complete,
    )
