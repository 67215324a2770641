"""A composed URDF as Pinocchio gets it: every movable joint on its own and described by one number.

Continuous joints become revolute with +-2 pi: Pinocchio would describe them by (cos, sin), which an optimiser with
bounds cannot use, and forward kinematics are the same. Mimic joints become joints of their own. What is for show goes,
and masses: nothing here asks for them, and what is wrong with them must not stop anything.
"""

from __future__ import annotations

import copy
import math
import xml.etree.ElementTree as ET


def pinocchio_xml(tree: ET.Element) -> str:
    """Return the URDF document for Pinocchio; the tree stays as it is."""
    changed = copy.deepcopy(tree)
    for joint in changed.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            joint.remove(mimic)
        if joint.get("type") == "continuous":
            _bound(joint)
    for link in changed.findall("link"):
        for element in (*link.findall("visual"), *link.findall("inertial")):
            link.remove(element)
    return ET.tostring(changed, encoding="unicode")


def _bound(joint: ET.Element) -> None:
    joint.set("type", "revolute")
    limit = joint.find("limit")
    if limit is None:
        limit = ET.SubElement(joint, "limit", effort="0", velocity="0")
    limit.set("lower", repr(-2 * math.pi))
    limit.set("upper", repr(2 * math.pi))
