"""Joints that a robot file holds for good: fixed ones in the tree, where they are held."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..errors import InputError
from .pose import Pose
from .urdf_checks import LOOSE, number
from .urdf_repairs import pose_of, set_pose

_OF_MOTION = ("axis", "limit", "mimic", "dynamics", "safety_controller", "calibration")


def hold(tree: ET.Element, values: Mapping[str, float], file: Path) -> None:
    """Fix joints, in place, at their values, rad (m).

    Raises:
        InputError: one that floats or moves in a plane is to be held elsewhere than at its origin, or one has no axis.
    """
    for joint in tree.findall("joint"):
        name = joint.get("name", "")
        if name in values:
            T = pose_of(joint.find("origin"), file, name).matrix @ _motion(joint, values[name], file)
            for element in [element for element in joint if element.tag in _OF_MOTION]:
                joint.remove(element)
            joint.set("type", "fixed")
            set_pose(joint, Pose.of(T))


def _motion(joint: ET.Element, value: float, file: Path) -> Array:
    """Return the motion of a joint from its origin, shape (4, 4)."""
    name, kind, T = joint.get("name", ""), joint.get("type", ""), np.eye(4)
    if kind in LOOSE and value != 0.0:
        problem = f"a {kind} joint can only be held where its origin is, at 0, not at {value:g}"
        raise InputError(problem, file=file, key=name, remedy="Give its pose in the origin of the joint")
    if value == 0.0 or kind == "fixed":
        return T
    axis = _axis(joint, file)
    if kind == "prismatic":
        T[:3, 3] = value * axis
        return T
    x, y, z = axis
    turned = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])  # Rodrigues
    T[:3, :3] += math.sin(value) * turned + (1.0 - math.cos(value)) * turned @ turned
    return T


def _axis(joint: ET.Element, file: Path) -> Array:
    """Return the unit vector along or about which a joint moves, shape (3,)."""
    element, name = joint.find("axis"), joint.get("name", "")
    text = "1 0 0" if element is None else element.get("xyz", "1 0 0")
    axis = np.array([number(part, file, name) for part in text.split()])
    if axis.shape != (3,) or not np.linalg.norm(axis) > 0.0:
        raise InputError(f"its axis is {text!r}, three numbers are wanted, not all 0", file=file, key=name)
    return np.asarray(axis / np.linalg.norm(axis))
