"""A composed URDF as Pinocchio gets it: every movable joint on its own and described by one number.

Continuous joints become revolute with +-2 pi: Pinocchio would describe them by (cos, sin), which an optimiser with
bounds cannot use, and forward kinematics are the same. Mimic joints become joints of their own. Limits are those within
which joints are kept. Visual geometry goes.
"""

from __future__ import annotations

import copy
import math
import xml.etree.ElementTree as ET

from .limits import limits_of


def pinocchio_xml(tree: ET.Element) -> str:
    """Return the URDF document for Pinocchio; the tree stays as it is."""
    changed = copy.deepcopy(tree)
    for joint in changed.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            joint.remove(mimic)
        low, high = limits_of(joint)
        if joint.get("type") == "continuous":
            _bound(joint, -2.0 * math.pi, 2.0 * math.pi)
        elif joint.find("limit") is not None:
            _bound(joint, low, high)
    for link in changed.findall("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    return ET.tostring(changed, encoding="unicode")


def _bound(joint: ET.Element, low: float, high: float) -> None:
    if joint.get("type") == "continuous":
        joint.set("type", "revolute")
    limit = joint.find("limit")
    if limit is None:
        limit = ET.SubElement(joint, "limit", effort="0", velocity="0")
    limit.set("lower", repr(low))
    limit.set("upper", repr(high))
