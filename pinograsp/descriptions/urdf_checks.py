"""Checks of a URDF for mistakes that parsers pass over or crash on."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections import Counter
from pathlib import Path

from ..errors import InputError

XACRO = ("{http://www.ros.org/wiki/xacro}", "{http://ros.org/wiki/xacro}", "xacro:")
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed")
LIMITED = ("revolute", "prismatic")
"""Types of joints that have limits; those of one that has none are 0 and 0."""
LOOSE = ("floating", "planar")
"""Types of joints that more than one number moves: a robot file cuts them off or holds them."""
ONE_TREE = "The links of a URDF form one tree"


FARTHEST = 1e4
"""Nothing of a robot is as far away, m, or turned as far, rad: larger numbers are those of a mistake."""
WIDEST = 1e3
"""Limits beyond it, rad (m), are those of a joint that has none."""
_ENDS = 1e9
"""What is written for limits that are infinite."""
_NOTHING = 1e-100
"""Numbers nearer to 0 are 0."""
SIZES = {
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
}
"""Numbers that give the size of a geometry, with the count of each."""
_NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3},
    "axis": {"xyz": 3},
    "mimic": {"multiplier": 1, "offset": 1},
    "mesh": {"scale": 3},
    **SIZES,
}
"""All other numbers that are read, with the count of each. Those of limits may be infinite."""
_INERTIAL = (
    ("origin", ("xyz", "rpy"), 3),
    ("mass", ("value",), 1),
    ("inertia", ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), 1),
)
"""Numbers of an inertial, with the count of each; an origin may be left out."""
_LIMITS = {"limit": ("lower", "upper"), "safety_controller": ("soft_lower_limit", "soft_upper_limit")}
_PLAIN = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_ENDLESS = re.compile(r"([+-]?)inf(inity)?", re.ASCII | re.IGNORECASE)


def number(text: str, file: Path, key: str, what: str = "") -> float:
    """Read a finite number as all readers of URDFs do, or say where there is none."""
    if not _PLAIN.fullmatch(text.strip()):
        where = f"{what}: " if what else ""
        raise InputError(f"{where}{text!r} is not a number", file=file, key=key)
    return float(text)


def has_numbers(inertial: ET.Element) -> bool:
    """Whether an `<inertial>` has all the numbers of a mass and an inertia."""
    for tag, names, count in _INERTIAL:
        element = inertial.find(tag)
        texts = [None if element is None else element.get(name) for name in names]
        for parts in (text.split() for text in texts if text is not None):
            if len(parts) != count or not all(map(_PLAIN.fullmatch, parts)):
                return False
        if tag != "origin" and None in texts:
            return False
    return True


def is_color(rgba: str) -> bool:
    """Whether a text has the four numbers from 0 to 1 of a colour."""
    parts = rgba.split()
    return len(parts) == 4 and all(_PLAIN.fullmatch(part) and 0.0 <= float(part) <= 1.0 for part in parts)


def usable(low: float, high: float) -> bool:
    """Whether limits, rad (m), leave a joint something to move in, and bound it."""
    return -WIDEST <= low < high <= WIDEST


def check_tree(root: ET.Element, file: Path) -> tuple[str, ...]:
    """Refuse what parsers pass over or crash on; return the names of the links."""
    links = [link.get("name", "") for link in root.findall("link")]
    joints = [joint.get("name", "") for joint in root.findall("joint")]
    for what, names in (("link", links), ("joint", joints)):
        if "" in names:
            remedy = f'Every <{what}> of a URDF has one: <{what} name="...">'
            raise InputError(f"{what} number {names.index('') + 1} has no name", file=file, remedy=remedy)
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise InputError(f"two {what}s have the name {twice[0]!r}", file=file, key=twice[0])
    for element in root.iter():
        _check_element(element, file)
    for part in (*root.findall("link"), *root.findall("joint")):
        _check_numbers(part, file)
    _check_connections(root, links, file)
    return tuple(links)


def _check_element(element: ET.Element, file: Path) -> None:
    """Refuse macros."""
    if element.tag.startswith(XACRO):
        raise InputError("is xacro, not URDF", file=file, remedy="Run xacro on it first")


def _check_numbers(part: ET.Element, file: Path) -> None:
    """Refuse numbers of a link or a joint that no robot has: too few or too many, not finite, an axis of no length.

    All others are written anew, since what one reader takes for a number, such as 1e-400, is none for the other.
    """
    key = f"{part.tag} {part.get('name', '')}"
    for element in part.iter():
        for name, count in _NUMBERS.get(element.tag, {}).items():
            if (text := element.get(name)) is not None:
                _write(element, name, _vector(text, count, file, key, f"{name} of <{element.tag}>"))
        for name in _LIMITS.get(element.tag, ()):
            if (text := element.get(name)) is not None:
                found = _ENDLESS.fullmatch(text.strip())
                value = float(text) if found else number(text, file, key, f"{name} of <{element.tag}>")
                _write(element, name, [min(max(value, -_ENDS), _ENDS)])
    axis = part.find("axis") if part.get("type") != "fixed" else None
    if axis is not None and not any(map(float, axis.get("xyz", "1 0 0").split())):
        remedy = 'Give a direction, as <axis xyz="0 0 1"/>'
        raise InputError("the axis has no length", file=file, key=key, remedy=remedy)
    for mesh in part.iterfind("collision/geometry/mesh"):
        if not all(map(float, mesh.get("scale", "1 1 1").split())):
            raise InputError("scale of <mesh> is 0 along an axis", file=file, key=key, remedy="Leave it out: it is 1")


def _write(element: ET.Element, name: str, values: list[float]) -> None:
    element.set(name, " ".join(repr(value if abs(value) > _NOTHING else 0.0) for value in values))


def _vector(text: str, count: int, file: Path, key: str, what: str) -> list[float]:
    values = [number(word, file, key, what) for word in text.split()]
    if len(values) != count:
        remedy = "Write them with spaces between" if values else "Leave it out where it is 0"
        raise InputError(f"{what} has {len(values)} numbers, not {count}", file=file, key=key, remedy=remedy)
    if any(abs(value) > FARTHEST for value in values):
        problem = f"{what}: {max(values, key=abs):g} is too large for a robot"
        raise InputError(problem, file=file, key=key, remedy="Lengths are in metres, angles in radians")
    return values


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
