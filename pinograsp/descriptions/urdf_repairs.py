"""What does not matter in a URDF and would stop those that read it: taken out or put right in the tree, and said.

A capsule becomes the three bodies that it is made of, since no reader of URDFs knows it yet.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from ..errors import InputError
from .pose import Pose
from .urdf_checks import JOINT_TYPES, SIZES, number

SINGLE = {
    "joint": ("parent", "child", "origin", "axis", "limit", "mimic", "dynamics", "safety_controller", "calibration"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "collision": ("origin", "geometry"),
    "visual": ("origin", "geometry", "material"),
    "geometry": ("*",),
}
"""Elements of which their owner has one."""


def repair(tree: ET.Element, file: Path) -> list[str]:
    """Put right in a URDF what does not matter; return a remark on each thing that was passed over.

    Args:
        tree: the URDF, whose numbers are numbers.
        file: that it was read from: of its name, if the robot has none.

    Raises:
        InputError: a capsule has no sizes of one.
    """
    if not tree.get("name"):
        tree.set("name", file.stem)
    remarks = [*_without_foreign_names(tree), *_once(tree)]
    for joint in tree.findall("joint"):
        remarks += _joint(joint)
    for link in tree.findall("link"):
        remarks += [remark for tag in ("collision", "visual") for remark in _geometry(link, tag, file)]
    return remarks


def show_as_collision(tree: ET.Element) -> None:
    """Give every link without collision geometry, in place, that which it is shown with."""
    for link in tree.findall("link"):
        if link.find("collision") is None:
            shown = [copy.deepcopy(visual) for visual in link.findall("visual")]
            for element in shown:
                element.tag = "collision"
            link.extend(shown)


def pose_of(element: ET.Element | None, file: Path, key: str) -> Pose:
    """Return the pose that an `<origin>` gives, or none.

    Raises:
        InputError: it is not of three numbers each.
    """
    given = {}
    for name, field in (("xyz", "position"), ("rpy", "rpy")):
        text = "" if element is None else element.get(name, "")
        if text.strip():
            given[field] = tuple(number(part, file, key) for part in text.split())
    return Pose(**given)


def set_pose(element: ET.Element, pose: Pose) -> None:
    """Have an element begin with an `<origin>` of a pose, in place of its own."""
    origin = element.find("origin")
    if origin is None:
        origin = ET.Element("origin")
        element.insert(0, origin)
    for name, values in (("xyz", pose.position), ("rpy", pose.rpy)):
        origin.set(name, " ".join(repr(float(value)) for value in values))


def _without_foreign_names(tree: ET.Element) -> list[str]:
    """Take out elements and attributes whose prefix stands for nothing, as xacro leaves them."""
    count = 0
    for element in tree.iter():
        for name in [name for name in element.attrib if _unbound(name)]:
            del element.attrib[name]
            count += 1
        for child in [child for child in element if _unbound(child.tag)]:
            element.remove(child)
            count += 1
    return [f"{count} names with a prefix that stands for nothing"] if count else []


def _once(tree: ET.Element) -> list[str]:
    """Take out second elements where there is one for all readers, who take the first."""
    remarks = []
    for owner in (element for element in tree.iter() if element.tag in SINGLE):
        for tag in SINGLE[owner.tag]:
            for second in owner.findall(tag)[1:]:
                owner.remove(second)
                remarks.append(f"a second <{second.tag}> of <{owner.tag}> {owner.get('name', '')}".rstrip())
    return list(dict.fromkeys(remarks))


def _unbound(name: str) -> bool:
    return ":" in name and not name.startswith("{")


def _joint(joint: ET.Element) -> list[str]:
    name, kind, remarks = joint.get("name", ""), joint.get("type", ""), list[str]()
    if kind not in JOINT_TYPES and (plain := kind.strip().lower()) in JOINT_TYPES:
        joint.set("type", plain)
        remarks.append(f"joint type {kind!r} of {name}, taken as {plain}")
    mimic = joint.find("mimic")
    if mimic is not None and joint.get("type") == "fixed":
        joint.remove(mimic)
        remarks.append(f"<mimic> of the fixed joint {name}")
    return remarks


def _geometry(link: ET.Element, tag: str, file: Path) -> list[str]:
    """Take out geometry that is none, and put together capsules."""
    name, remarks = link.get("name", ""), []
    for element in link.findall(tag):
        shape = element.find("geometry/*")
        if shape is None:
            link.remove(element)
            remarks.append(f"<{tag}> of link {name} without geometry")
        elif shape.tag in SIZES and _is_nothing(shape, file, f"link {name}"):
            link.remove(element)
            remarks.append(f"<{shape.tag}> of link {name} without size")
        elif shape.tag == "capsule" and (tag == "collision" or min(_capsule_sizes(shape)) > 0.0):
            where = list(link).index(element)
            link.remove(element)
            for part in reversed(_capsule(element, shape, file, f"link {name}")):
                link.insert(where, part)
    return remarks


def _is_nothing(shape: ET.Element, file: Path, key: str) -> bool:
    """Whether a shape is a point or a line: there is nothing that could touch."""
    sizes = [number(text, file, key) for name in SIZES[shape.tag] for text in shape.get(name, "").split()]
    if len(sizes) < len(SIZES[shape.tag]):
        return False
    return sum(size != 0.0 for size in sizes) < 2 if shape.tag == "box" else sizes[0] == 0.0


def _capsule_sizes(shape: ET.Element) -> list[float]:
    """Return radius and length of a capsule, 0 for what is not given, m."""
    return [float(shape.get(name, 0.0)) for name in SIZES["capsule"]]


def _capsule(element: ET.Element, shape: ET.Element, file: Path, key: str) -> list[ET.Element]:
    """Return a capsule as a cylinder, which its length is that of, and two balls at its ends."""
    sizes = _capsule_sizes(shape)
    if min(sizes) <= 0.0:
        problem = f"a <capsule> has radius {sizes[0]:g} and length {sizes[1]:g}"
        raise InputError(problem, file=file, key=key, remedy="Both are wanted, in metres; the length without the caps")
    T = pose_of(element.find("origin"), file, key).matrix
    radius, length = (repr(size) for size in sizes)
    parts = []
    for place in (0.0, -0.5 * sizes[1], 0.5 * sizes[1]):
        part, end = copy.deepcopy(element), np.eye(4)
        end[2, 3] = place
        set_pose(part, Pose.of(T @ end))
        for geometry in part.findall("geometry"):
            geometry.clear()
            if place == 0.0:
                ET.SubElement(geometry, "cylinder", radius=radius, length=length)
            else:
                ET.SubElement(geometry, "sphere", radius=radius)
        parts.append(part)
    return parts
