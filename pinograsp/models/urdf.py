"""The URDF as Pinocchio gets it: checked, mounted, with meshes found and continuous joints made revolute.

Everything happens on the XML in memory:

- a new root link carries the robot's root link at the mounting pose, so that joints, frames and geometry
  are mounted together;
- continuous joints become revolute with +-2 pi: Pinocchio would describe them by (cos, sin), which an
  optimiser with bounds cannot use, and forward kinematics are the same;
- mesh addresses become absolute paths, found only in the folders that the robot file allows.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..descriptions import RobotDescription
from ..descriptions.locate import resolve
from ..errors import InputError, close_names
from .urdf_checks import check_tree, number

MOUNT = "pinograsp_mounting"


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: angle = multiplier * leader + offset."""

    leader: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class RobotUrdf:
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


def prepare(description: RobotDescription, T_world_root: NDArray[np.float64]) -> RobotUrdf:
    """Read, check and mount the URDF of a robot.

    Args:
        description: the robot file.
        T_world_root: pose of the URDF's root link in the world, shape (4, 4).

    Raises:
        InputError: the URDF or SRDF cannot be parsed, or a mesh is not found.
    """
    file = description.urdf_file
    root = _parse(file, "robot")
    links = check_tree(root, file)
    movable: dict[str, str] = {}
    mimics: dict[str, Mimic] = {}
    for joint in root.findall("joint"):
        name, kind = joint.get("name", ""), joint.get("type", "")
        if kind in {"revolute", "continuous", "prismatic"}:
            movable[name] = kind
        elif kind != "fixed":
            remedy = "Use revolute, continuous, prismatic or fixed"
            raise InputError(f"joint type {kind!r} is not supported", file=file, key=name, remedy=remedy)
        mimic = joint.find("mimic")
        if mimic is not None:
            factors = [number(mimic.get(key, default), file, name) for key, default in _MIMIC_DEFAULTS]
            mimics[name] = Mimic(mimic.get("joint", ""), *factors)
            joint.remove(mimic)
        if kind == "continuous":
            _bound(joint)
    mimics = {name: _resolved(name, mimics, movable, file) for name in mimics}
    meshes = _find_meshes(root, description)
    _mount(root, T_world_root)
    xml = ET.tostring(root, encoding="unicode")
    return RobotUrdf(xml, links, movable, mimics, meshes, _disabled_pairs(description))


def _resolved(name: str, mimics: dict[str, Mimic], movable: dict[str, str], file: Path) -> Mimic:
    """Return how a joint follows the joint at the end of its chain of mimics."""
    leader, multiplier, offset = name, 1.0, 0.0
    for _ in range(len(mimics) + 1):
        if leader not in movable:
            remedy = close_names(leader, list(movable))
            raise InputError(f"mimics {leader!r}, which is no joint", file=file, key=name, remedy=remedy)
        if leader not in mimics:
            return Mimic(leader, multiplier, offset)
        step = mimics[leader]
        leader, multiplier, offset = step.leader, multiplier * step.multiplier, multiplier * step.offset + offset
    raise InputError("mimics itself", file=file, key=name)


_MIMIC_DEFAULTS = (("multiplier", "1"), ("offset", "0"))


def _parse(file: Path, tag: str) -> ET.Element:
    try:
        root = ET.parse(file).getroot()
    except ET.ParseError as error:
        raise InputError(f"is not valid XML: {error}", file=file) from None
    if root.tag != tag:
        raise InputError(f"holds <{root.tag}>, not <{tag}>", file=file, remedy="If it is xacro, run xacro first")
    return root


def _bound(joint: ET.Element) -> None:
    joint.set("type", "revolute")
    limit = joint.find("limit")
    if limit is None:
        limit = ET.SubElement(joint, "limit", effort="0", velocity="0")
    limit.set("lower", repr(-2 * math.pi))
    limit.set("upper", repr(2 * math.pi))


def _find_meshes(root: ET.Element, description: RobotDescription) -> tuple[str, ...]:
    """Make the addresses of collision meshes absolute paths and return these; drop what is only for show."""
    meshes = []
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
        for mesh in link.iterfind("collision/geometry/mesh"):
            address = mesh.get("filename", "")
            found = resolve(address, beside=description.urdf_file, folders=description.folders)
            if found is None:
                raise InputError(
                    f"mesh {address} was not found",
                    file=description.urdf_file,
                    key=f"link {link.get('name')}",
                    remedy="Looked in "
                    + ", ".join(str(folder) for folder in description.folders)
                    + "; name further folders under `packages` in the robot file",
                )
            mesh.set("filename", str(found))
            meshes.append(str(found))
    return tuple(meshes)


def _mount(root: ET.Element, T: NDArray[np.float64]) -> None:
    children = {child.get("link") for child in root.iterfind("joint/child")}
    base = next(link.get("name", "") for link in root.findall("link") if link.get("name") not in children)
    R = T[:3, :3]
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    if math.hypot(R[0, 0], R[1, 0]) > 1e-9:
        roll, yaw = math.atan2(R[2, 1], R[2, 2]), math.atan2(R[1, 0], R[0, 0])
    else:
        roll, yaw = 0.0, math.atan2(-R[0, 1], R[1, 1])
    ET.SubElement(root, "link", name=MOUNT)
    joint = ET.SubElement(root, "joint", name=f"{MOUNT}_joint", type="fixed")
    ET.SubElement(
        joint,
        "origin",
        xyz=" ".join(repr(float(v)) for v in T[:3, 3]),
        rpy=" ".join(repr(v) for v in (roll, pitch, yaw)),
    )
    ET.SubElement(joint, "parent", link=MOUNT)
    ET.SubElement(joint, "child", link=base)


def _disabled_pairs(description: RobotDescription) -> frozenset[frozenset[str]]:
    if description.srdf_file is None:
        return frozenset()
    root = _parse(description.srdf_file, "robot")
    return frozenset(
        frozenset((pair.get("link1", ""), pair.get("link2", ""))) for pair in root.findall("disable_collisions")
    )


def require(name: str, known: list[str], what: str, key: str, description: RobotDescription) -> None:
    """Raise an InputError unless the URDF has a joint or link of this name."""
    if name not in known:
        raise InputError(
            f"{what} {name!r} is not in {description.urdf_file.name}",
            file=description.source,
            key=key,
            remedy=close_names(name, known),
        )
