"""The URDF as Pinocchio gets it: composed, with continuous joints made revolute.

Everything happens on the XML in memory. Continuous joints become revolute with +-2 pi: Pinocchio would describe them by
(cos, sin), which an optimiser with bounds cannot use, and forward kinematics are the same.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass

from ..descriptions import RobotDescription
from ..descriptions.urdf import Mimic, mimics_of, read_urdf
from ..errors import InputError, close_names


@dataclass(frozen=True)
class PreparedUrdf:
    """A prepared URDF."""

    xml: str
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
    urdf = read_urdf(description)
    mimics = mimics_of(urdf.tree, description.urdf_file)
    links, tree = urdf.links, urdf.tree
    movable: dict[str, str] = {}
    for joint in tree.findall("joint"):
        name, kind = joint.get("name", ""), joint.get("type", "")
        if kind != "fixed":
            movable[name] = kind
        mimic = joint.find("mimic")
        if mimic is not None:
            joint.remove(mimic)
        if kind == "continuous":
            _bound(joint)
    for link in tree.findall("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    meshes = tuple(mesh.get("filename", "") for mesh in tree.iterfind("link/collision/geometry/mesh"))
    return PreparedUrdf(urdf.xml, links, movable, mimics, meshes, frozenset(urdf.disabled), urdf.complete)


def _bound(joint: ET.Element) -> None:
    joint.set("type", "revolute")
    limit = joint.find("limit")
    if limit is None:
        limit = ET.SubElement(joint, "limit", effort="0", velocity="0")
    limit.set("lower", repr(-2 * math.pi))
    limit.set("upper", repr(2 * math.pi))


def require(name: str, known: list[str], what: str, key: str, description: RobotDescription) -> None:
    """Raise an InputError unless the URDF has a joint or link of this name."""
    if name not in known:
        raise InputError(
            f"{what} {name!r} is not in {_names(description)}",
            file=description.source,
            key=key,
            remedy=close_names(name, known),
        )


def _names(description: RobotDescription) -> str:
    files = [description.urdf_file, *(files.urdf for files in description.attached_files)]
    return " or ".join(file.name for file in files)
