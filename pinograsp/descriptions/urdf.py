"""The URDF of a robot file: read, cut, and put together from several files.

    <urdf>       less what `leave_out` names, only what `root` carries, joints fixed that `hold` names
    attach[0]    another URDF, treated alike, its names with a prefix, fixed to a link of what is there so far
    ...

Everything happens on XML trees in memory. Addresses of meshes become absolute paths, found only in the folders that
the robot file allows, so that nothing after this has to know which file an element came from.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import FileError, InputError, UnknownNameError, close_names
from .composition import Attachment, Composition, UrdfPart
from .held_joints import hold
from .locate import not_found, package_folders, resolve
from .urdf_checks import LIMITED, check_joints, check_tree, has_numbers, is_color, number
from .urdf_repairs import repair, show_as_collision
from .urdf_xml import carried, keep_links, names_of, parse, put_prefix, root_of

Pairs = dict[frozenset[str], frozenset[str]]

_NOT_ASKED_FOR = ("dynamics", "calibration")
"""Elements of links and joints that nothing here asks for: what is wrong with them must not stop anything."""
_MIMIC_DEFAULTS = (("multiplier", "1"), ("offset", "0"))


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another, which mimics none: angle = multiplier * leader + offset."""

    leader: str
    multiplier: float
    offset: float

    def of(self, value: float) -> float:
        """Return the joint's angle, rad (m), for that of its leader."""
        return self.multiplier * value + self.offset


@dataclass(frozen=True)
class RobotUrdf:
    """The robot as one tree of links and joints."""

    tree: ET.Element
    disabled: Pairs
    """Pairs of links that an SRDF takes out of self-collision checks, with the reasons given, in lower case."""
    complete: bool
    """Whether every file of the composition has an SRDF."""
    remarks: tuple[str, ...] = ()
    """What of the URDFs does not matter and was passed over, in words."""

    @property
    def xml(self) -> str:
        """The tree as a URDF document."""
        return ET.tostring(self.tree, encoding="unicode")

    @property
    def links(self) -> tuple[str, ...]:
        """Names of the links."""
        return tuple(names_of(self.tree, "link"))

    @property
    def root(self) -> str:
        """Name of the link that has no parent."""
        return root_of(self.tree)


def read_urdf(robot: Composition) -> RobotUrdf:
    """Read and compose the URDF of a robot, given by its file or by what it is put together from.

    Raises:
        InputError: a file cannot be parsed, is no tree, a mesh for collisions is not found, a name is unknown
            or given twice.
    """
    tree, cut, remarks = _part(robot, robot.urdf_file, robot, "")
    disabled = _disabled_pairs(robot.srdf_file, _renamed(tree, cut, ""))
    urdf = RobotUrdf(tree, disabled, robot.srdf_file is not None, tuple(remarks))
    for index in range(len(robot.attach)):
        urdf = attached(urdf, robot, index)
    return urdf


def attached(urdf: RobotUrdf, robot: Composition, index: int) -> RobotUrdf:
    """Read what `robot.attach[index]` names, and return it attached to what is there so far, which is left as it is.

    Raises:
        InputError: as for `read_urdf`.
    """
    key, attachment, files = attachment_joint(index), robot.attach[index], robot.attached_files[index]
    part, cut, remarks = _part(attachment, files.urdf, robot, f"{key}.")
    renamed = _renamed(part, cut, attachment.prefix)
    put_prefix(part, attachment.prefix, key)
    tree, disabled = copy.deepcopy(urdf.tree), dict(urdf.disabled)
    _attach(tree, part, attachment, robot, key)
    for pair, reasons in _disabled_pairs(files.srdf, renamed).items():
        disabled[pair] = disabled.get(pair, frozenset()) | reasons
    return RobotUrdf(tree, disabled, urdf.complete and files.srdf is not None, (*urdf.remarks, *remarks))


def attachment_joint(index: int) -> str:
    """Return the name of the fixed joint that holds `attach[index]`, which is its key in the robot file."""
    return f"attach[{index}]"


def mimics_of(tree: ET.Element, file: Path) -> dict[str, Mimic]:
    """Return how joints follow others, chains resolved.

    Raises:
        InputError: a joint mimics itself, or what is no movable joint.
    """
    steps: dict[str, Mimic] = {}
    movable = [joint.get("name", "") for joint in tree.findall("joint") if joint.get("type") != "fixed"]
    for joint in tree.findall("joint"):
        mimic, name = joint.find("mimic"), joint.get("name", "")
        if mimic is not None:
            factors = [number(mimic.get(key, default), file, name) for key, default in _MIMIC_DEFAULTS]
            steps[name] = Mimic(mimic.get("joint", ""), *factors)
    return {name: _resolved(name, steps, movable, file) for name in steps}


def _resolved(name: str, steps: dict[str, Mimic], movable: list[str], file: Path) -> Mimic:
    leader, multiplier, offset = name, 1.0, 0.0
    for _ in range(len(steps) + 1):
        if leader not in movable:
            remedy = close_names(leader, movable)
            raise UnknownNameError(f"mimics {leader!r}, which is no joint", file=file, key=name, remedy=remedy)
        if leader not in steps:
            return Mimic(leader, multiplier, offset)
        step = steps[leader]
        leader, multiplier, offset = step.leader, multiplier * step.multiplier, multiplier * step.offset + offset
    raise InputError("mimics itself", file=file, key=name)


def _part(part: UrdfPart, file: Path, robot: Composition, key: str) -> tuple[ET.Element, set[str], list[str]]:
    """Return what a robot file takes of one URDF, the names of the links that it leaves, and what was passed over."""
    tree = parse(file, "robot")
    links = check_tree(tree, file)
    if not links:
        raise InputError("has no links", file=file, key=key, remedy="Check that it is the URDF of a robot")
    remarks = repair(tree, file)
    for element in list(tree):
        if element.tag not in {"link", "joint", "material"}:
            tree.remove(element)
    _strip(tree)
    wanted = [(name, f"{key}leave_out[{index}]") for index, name in enumerate(part.leave_out)]
    for name, its_key in wanted if part.root is None else [*wanted, (part.root, f"{key}root")]:
        _require(name, tree, file, robot, its_key)
    for name in part.leave_out:
        keep_links(tree, carried(tree, name), keep=False)
    if part.root is not None:
        keep_links(tree, carried(tree, part.root), keep=True)
    if not names_of(tree, "link"):
        raise InputError("nothing is left of the URDF", file=robot.source, key=f"{key}leave_out")
    followers = mimics_of(tree, file)  # a joint that is left may mimic one that is not
    hold(tree, _held(part.hold, followers, tree, file, robot, f"{key}hold"), file)
    check_joints(tree, file)
    if part.use_visual:
        show_as_collision(tree)
    _find_meshes(tree, file, robot)
    return tree, set(links) - set(names_of(tree, "link")), remarks


def _held(
    values: Mapping[str, float],
    followers: Mapping[str, Mimic],
    tree: ET.Element,
    file: Path,
    robot: Composition,
    key: str,
) -> dict[str, float]:
    """Return the joints that are held and those that follow them, rad (m)."""
    known = [joint.get("name", "") for joint in tree.findall("joint") if joint.get("type") != "fixed"]
    for name in values:
        if name not in known:
            problem, remedy = f"joint {name!r} is not in {file.name}", close_names(name, known)
            raise UnknownNameError(problem, file=robot.source, key=f"{key}.{name}", remedy=remedy)
        if name in followers:
            leader = followers[name].leader
            problem, remedy = f"joint {name!r} mimics {leader!r}", f"Hold {leader!r} instead"
            raise InputError(problem, file=robot.source, key=f"{key}.{name}", remedy=remedy)
    follow = {name: mimic for name, mimic in followers.items() if mimic.leader in values}
    return {**values, **{name: mimic.of(values[mimic.leader]) for name, mimic in follow.items()}}


def _strip(tree: ET.Element) -> None:
    """Take out what nothing here asks for; Pinocchio wants to have limits, and numbers with them."""
    for part in (*tree.findall("link"), *tree.findall("joint")):
        for element in [element for element in part if element.tag in _NOT_ASKED_FOR]:
            part.remove(element)
        for inertial in part.findall("inertial"):
            if not has_numbers(inertial):  # the link counts as one that has none
                part.remove(inertial)
    for parent in list(tree.iter()):
        for material in parent.findall("material"):
            if any(not is_color(color.get("rgba", "")) for color in material.findall("color")):
                parent.remove(material)
    for joint in tree.findall("joint"):
        if joint.find("limit") is None and joint.get("type") in LIMITED:
            ET.SubElement(joint, "limit")
        for limit in joint.findall("limit"):
            limit.set("effort", "0")
            limit.set("velocity", "0")
        for soft in joint.findall("safety_controller"):
            soft.set("k_position", "0")
            soft.set("k_velocity", "0")


def _attach(tree: ET.Element, part: ET.Element, how: Attachment, robot: Composition, key: str) -> None:
    _require(how.to, tree, robot.urdf_file, robot, f"{key}.to")
    for tag in ("link", "joint"):
        twice = sorted(set(names_of(tree, tag)) & set(names_of(part, tag)))
        if twice:
            problem = f"{len(twice)} {tag} names are in the robot already, the first is {twice[0]!r}"
            raise InputError(problem, file=robot.source, key=f"{key}.prefix", remedy="Give a prefix, or another one")
    child = root_of(part)
    tree.extend(part)
    joint = ET.SubElement(tree, "joint", name=key, type="fixed")
    xyz, rpy = (" ".join(repr(float(v)) for v in values) for values in (how.position, how.rpy))
    ET.SubElement(joint, "origin", xyz=xyz, rpy=rpy)
    ET.SubElement(joint, "parent", link=how.to)
    ET.SubElement(joint, "child", link=child)


def _require(name: str, tree: ET.Element, file: Path, robot: Composition, key: str) -> None:
    known = names_of(tree, "link")
    if name not in known:
        problem = f"link {name!r} is not in {file.name}"
        raise UnknownNameError(problem, file=robot.source, key=key, remedy=close_names(name, known))


def _find_meshes(tree: ET.Element, file: Path, robot: Composition) -> None:
    """Make the addresses of meshes absolute paths; one that is only for show may be missing."""
    folders = package_folders(robot.source, robot.packages)
    for link in tree.findall("link"):
        for kind in ("visual", "collision"):
            for mesh in link.iterfind(f"{kind}/geometry/mesh"):
                address = mesh.get("filename", "")
                if not address and kind == "collision":
                    raise InputError("a <mesh> names no file", file=file, key=f"link {link.get('name')}")
                found = resolve(address, beside=file, folders=folders)
                if found is not None:
                    mesh.set("filename", str(found))
                elif kind == "collision":
                    raise FileError(
                        f"mesh {address} was not found",
                        file=file,
                        key=f"link {link.get('name')}",
                        remedy=not_found(address, beside=file, folders=folders),
                    )


def _renamed(tree: ET.Element, cut: set[str], prefix: str) -> dict[str, str | None]:
    """Return what the links of one URDF are called in the robot; None: cut off."""
    return {name: prefix + name for name in names_of(tree, "link")} | dict.fromkeys(cut)


def _disabled_pairs(srdf: Path | None, renamed: dict[str, str | None]) -> Pairs:
    """Return the pairs of an SRDF, by the names in the robot.

    A name that its own URDF has means that link, also if it was cut off and another part of the robot has a link of
    this name; any other name means a link of the robot.
    """
    reasons: dict[frozenset[str], set[str]] = {}
    for entry in [] if srdf is None else parse(srdf, "robot").findall("disable_collisions"):
        named = (entry.get("link1", ""), entry.get("link2", ""))
        links = [found for name in named if (found := renamed.get(name, name)) is not None]
        if len(links) == len(named):
            reasons.setdefault(frozenset(links), set()).add(entry.get("reason", "").lower())
    return {pair: frozenset(given) for pair, given in reasons.items()}
