"""Checks of a URDF for mistakes that parsers pass over or crash on."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from pathlib import Path

from ..errors import InputError

XACRO = ("{http://www.ros.org/wiki/xacro}", "{http://ros.org/wiki/xacro}", "xacro:")
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed")
LOOSE = ("floating", "planar")
"""Types of joints that more than one number moves: a robot file cuts them off or holds them."""
ONE_TREE = "The links of a URDF form one tree"


def number(text: str, file: Path, key: str) -> float:
    """Read a number, or say where there is none."""
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{text!r} is not a number", file=file, key=key) from None


def check_tree(root: ET.Element, file: Path) -> tuple[str, ...]:
    """Refuse what parsers pass over or crash on; return the names of the links."""
    links = [link.get("name", "") for link in root.findall("link")]
    joints = [joint.get("name", "") for joint in root.findall("joint")]
    for what, names in (("link", links), ("joint", joints)):
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise InputError(f"two {what}s have the name {twice[0]!r}", file=file, key=twice[0])
    for element in root.iter():
        _check_element(element, file)
    _check_connections(root, links, file)
    return tuple(links)


def _check_element(element: ET.Element, file: Path) -> None:
    """Refuse macros, and numbers that are none."""
    if element.tag.startswith(XACRO):
        raise InputError("is xacro, not URDF", file=file, remedy="Run xacro on it first")
    for key in ("xyz", "rpy"):
        for text in element.get(key, "").split() if element.tag in {"origin", "axis"} else ():
            number(text, file, element.tag)
    if element.tag == "limit":
        for key in ("lower", "upper"):
            number(element.get(key, "0"), file, "limit")


def _check_connections(root: ET.Element, links: list[str], file: Path) -> None:
    """Refuse joints that lead nowhere, and links that do not form one tree."""
    parents: dict[str, str] = {}
    for joint in root.findall("joint"):
        key = joint.get("name", "")
        ends = [found.get("link", "") if (found := joint.find(end)) is not None else "" for end in ("parent", "child")]
        for end, name in zip(("parent", "child"), ends, strict=True):
            if name not in links:
                raise InputError(f"its {end} {name!r} is no link", file=file, key=key)
        if ends[1] in parents:
            raise InputError(f"link {ends[1]!r} is the child of another joint too", file=file, key=key)
        parents[ends[1]] = ends[0]
    roots = [name for name in links if name not in parents]
    if len(roots) > 1:
        raise InputError(f"{len(roots)} links have no parent: {', '.join(roots)}", file=file, remedy=ONE_TREE)
    for name in links:
        ancestor = name
        for _ in links:
            ancestor = parents.get(ancestor, ancestor)
        if ancestor not in roots:
            raise InputError("is its own ancestor", file=file, key=f"link {name}", remedy=ONE_TREE)


def check_joints(root: ET.Element, file: Path) -> None:
    """Refuse joints that cannot be moved to what one number says, among those that a robot file takes of a URDF."""
    for joint in root.findall("joint"):
        key, kind = joint.get("name", ""), joint.get("type", "")
        if kind in LOOSE:
            remedy = f"Hold it where its origin is, hold: {{{key}: 0.0}}, or name a link beyond it under `root`"
            raise InputError(f"a {kind} joint is moved by nothing", file=file, key=key, remedy=remedy)
        if kind not in JOINT_TYPES:
            remedy = f"Use {', '.join(JOINT_TYPES[:-1])} or {JOINT_TYPES[-1]}"
            raise InputError(f"joint type {kind!r} is not supported", file=file, key=key, remedy=remedy)
        if kind in {"revolute", "prismatic"} and joint.find("limit") is None:
            raise InputError("has no <limit>", file=file, key=key, remedy="Add <limit lower=... upper=...>")
