"""The hand: what the last arm joint carries, as the URDF says, and how its joints are driven.

With one synergy sigma every joint of the hand follows one driver, q_j - q_j0 = c_j (q_d - q_d0), c_d = 1. Contact
forces f on the object are held by the driver torque S^T J^T f / S_d, which is what a current-controlled gripper is
told. With several synergies every joint is a servo of stiffness k, tau_j = k (q_r,j - q_j), which is told the reference
q_r (3).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..descriptions import RobotDescription
from ..descriptions.pose import Pose
from ..descriptions.urdf import RobotUrdf, mimics_of
from ..descriptions.urdf_checks import number
from ..errors import InputError

_SLIDING, _TURNING = ("prismatic",), ("revolute", "continuous")


@dataclass(frozen=True)
class HandJoint:
    """A movable joint."""

    name: str
    slides: bool
    axis: Array
    """Unit vector in the frame of the link that it moves, shape (3,)."""


@dataclass(frozen=True)
class Inertia:
    """Of a link, about its centre of mass and along the axes of its frame."""

    center: Array
    """m, shape (3,)."""
    mass: float
    """kg."""
    matrix: Array
    """kg m^2, shape (3, 3)."""


@dataclass(frozen=True)
class HandLink:
    """A link of the hand."""

    name: str
    parent: str | None
    """Link that carries it; None for the first one."""
    joint: HandJoint | None
    """Joint that moves it against its parent; None if it is fixed to it."""
    inertia: Inertia | None
    """None if the URDF gives none that a body could have."""


def hand_links(urdf: RobotUrdf, robot: RobotDescription) -> tuple[HandLink, ...]:
    """Return the links that the last arm joint carries, parents before children.

    Raises:
        InputError: what the URDF says of a joint's axis or of a link's inertia is no number.
    """
    joints = urdf.tree.findall("joint")
    first = next(_end(joint, "child") for joint in joints if joint.get("name") == robot.arm.joints[-1])
    inertias = {link.get("name", ""): _inertia(link, robot.urdf_file) for link in urdf.tree.findall("link")}
    found = [HandLink(first, None, None, inertias[first])]
    for parent in found:  # grows as it is gone through
        for joint in joints:
            if _end(joint, "parent") == parent.name:
                child = _end(joint, "child")
                found.append(HandLink(child, parent.name, _joint(joint, robot.urdf_file), inertias[child]))
    return tuple(found)


def factors(robot: RobotDescription, urdf: RobotUrdf) -> dict[str, float]:
    """Return c_j of every joint that moves with the only synergy of a hand; its driver comes first, with 1."""
    column = robot.hand.synergies[0].column
    driver = next(iter(column))
    moved = {joint: factor / column[driver] for joint, factor in column.items()}
    for joint, mimic in mimics_of(urdf.tree, robot.urdf_file).items():
        if mimic.leader in column:
            moved[joint] = mimic.multiplier * moved[mimic.leader]
    return moved


def _end(joint: ET.Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.get("link", "")


def _joint(element: ET.Element, file: Path) -> HandJoint | None:
    kind, name = element.get("type", ""), element.get("name", "")
    if kind not in _SLIDING + _TURNING:
        return None
    axis = _vector(element.find("axis"), "xyz", (1.0, 0.0, 0.0), file, name)
    return HandJoint(name, kind in _SLIDING, axis / np.linalg.norm(axis))


def _inertia(link: ET.Element, file: Path) -> Inertia | None:
    """Return the inertia of a link, or None if the URDF has none or numbers that no body has."""
    mass, tensor, origin = (link.find(f"inertial/{tag}") for tag in ("mass", "inertia", "origin"))
    if mass is None or tensor is None:
        return None
    key = f"link {link.get('name')}"
    kilograms = number(mass.get("value", "0"), file, key)
    entries = (number(tensor.get(name, "0"), file, key) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    xx, xy, xz, yy, yz, zz = entries
    own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not (kilograms > 0.0 and np.linalg.eigvalsh(own).min() > 0.0):
        return None
    x, y, z = _vector(origin, "xyz", (0.0, 0.0, 0.0), file, key).tolist()
    roll, pitch, yaw = _vector(origin, "rpy", (0.0, 0.0, 0.0), file, key).tolist()
    R = Pose(rpy=(roll, pitch, yaw)).matrix[:3, :3]
    return Inertia(np.array([x, y, z]), kilograms, R @ own @ R.T)


def _vector(element: ET.Element | None, name: str, default: tuple[float, float, float], file: Path, key: str) -> Array:
    text = None if element is None else element.get(name)
    if not text:
        return np.array(default)
    values = np.array([number(part, file, key) for part in text.split()])
    if values.shape != (3,):
        raise InputError(f"{name} has {len(values)} numbers, not 3", file=file, key=key)
    return values
