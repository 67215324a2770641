"""What a URDF says of the parts of a robot: arm, hand, pads and wrist."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions.composition import Composition
from ..descriptions.urdf import RobotUrdf, attachment_joint
from ..descriptions.urdf_checks import usable
from ..errors import InputError
from ..kinematics.collision_elements import LinkElement, link_elements
from ..kinematics.tree import UrdfTree
from ..progress import Progress, Report, no_report
from .chain import Chain, find_chain
from .coupled import Coupled, Facing, coupled_joints
from .facets import Facet, facets_of
from .facing import facing, finger_of, usual_limits
from .link_meshes import link_meshes

ALONG = math.cos(math.radians(30.0))
"""A wrist's z axis is at most this far off the direction to the pads."""
HALF_TURNS = (-math.pi, math.pi)
"""Limits of an arm joint that turns, where the URDF has none, rad."""
TOOL_FRAMES = ("end_effector", "tool0", "ee_link", "eef", "flange")
"""Parts of names that tool frames have; the first one in this order is taken."""


@dataclass(frozen=True)
class Parts:
    """Parts of a robot file that could be found."""

    composition: Composition
    """The URDFs, and how they are put together."""
    tree: UrdfTree
    """Links and joints of the whole."""
    chain: Chain
    """Joints of the arm and of the hand, by name, as `arm` and `hand`."""
    pads: tuple[Facet, ...]
    """Flat faces of the fingers, each of a `link`, that close on each other; none if there are no two."""
    wrist: str
    """Name of the wrist link."""
    towards: bool
    """Whether the wrist's z axis points to the pads."""
    turning: bool
    """Whether there are two pads that the hand turns against each other."""
    coupled: Coupled | None
    """How two joints of the hand look coupled."""


def parts_of(composition: Composition, urdf: RobotUrdf, tip: str | None, report: Report = no_report) -> Parts:
    """Find out what can be known without asking.

    Args:
        composition: what is attached last is the hand, if anything is.
        urdf: as composed.
        tip: a link of the body that carries the hand, where there are several.
        report: called before the flat faces of every link of the hand are searched.

    Raises:
        InputError: a mesh cannot be read, or arm and hand cannot be told apart.
    """
    file = composition.urdf_file
    tree = UrdfTree(urdf, file)
    hand = None
    if composition.attach:
        hand, tip = _last_attached(tree, composition), composition.attach[-1].to
    elements = link_elements(urdf, file)
    search = _FaceSearch(tree, elements, report)

    def pads_of(palm: str, joints: tuple[str, ...]) -> tuple[Facet, ...]:
        _require_geometry(urdf, composition, elements, search.links(palm, joints))
        return search.pads(palm, joints)

    chain = find_chain(tree, file, tip, hand, lambda palm, joints: bool(pads_of(palm, joints)))
    pads = pads_of(chain.palm, chain.hand)
    to = composition.attach[-1].to if composition.attach else None
    wrist, towards = _wrist(tree, chain, pads, to)
    sides = [Facing(pad.link, pad.origin, pad.axes[:, 2]) for pad in pads]
    alike = coupled_joints(tree, chain.hand, sides)
    return Parts(composition, tree, chain, pads, wrist, towards, _turning(tree, chain, pads, alike), alike)


def _turning(tree: UrdfTree, chain: Chain, pads: Sequence[Facet], alike: Coupled | None) -> bool:
    """Whether two pads do not stay parallel as the hand moves from one end of its range to the other."""
    if len(pads) != 2:
        return False
    between = []
    for end in (0, 1):
        angles = {name: (usual_limits(tree.joints[name]) or tree.joints[name].limits)[end] for name in chain.hand}
        if alike is not None:
            angles[alike.second] = alike.factor * angles[alike.first] + alike.offset
        poses = tree.poses(angles)
        first, second = (poses[pad.link][:3, :3] @ pad.axes[:, 2] for pad in pads)
        between.append(float(first @ second))
    return abs(between[1] - between[0]) > 1e-6


class _FaceSearch:
    """The search for faces that close on each other; what is known of a link is not searched again."""

    def __init__(self, tree: UrdfTree, elements: Sequence[LinkElement], report: Report) -> None:
        self._tree, self._elements, self._report = tree, elements, report
        self._faces: dict[str, list[Facet]] = {}

    def links(self, palm: str, hand: Sequence[str]) -> list[str]:
        """Return the links that the hand closes on each other: of one finger alone, with the palm."""
        tree = self._tree
        moved = {tree.body(joint.child) for joint in tree.carried(palm) if (joint.leader or joint.name) in hand}
        fingers = {finger_of(tree, palm, body) for body in moved}
        return [link for link in tree.links if tree.body(link) in moved | ({palm} if len(fingers) == 1 else set())]

    def pads(self, palm: str, hand: Sequence[str]) -> tuple[Facet, ...]:
        """Return the faces of the hand that close on each other."""
        links = self.links(palm, hand)
        wanted = [element for element in self._elements if element.link in links and element.link not in self._faces]
        meshes = link_meshes(wanted)
        for done, (link, mesh) in enumerate(meshes.items()):
            self._report(Progress("flat faces of links", done, len(meshes)))
            self._faces[link] = facets_of(link, mesh)
        facets = [facet for link in links for facet in self._faces.get(link, ())]
        return facing(facets, self._tree, palm, hand)


def _require_geometry(
    urdf: RobotUrdf, composition: Composition, elements: Sequence[LinkElement], links: Sequence[str]
) -> None:
    """Refuse a robot of which no link of the hand collides, if the URDF shows some.

    Raises:
        InputError: that is so.
    """
    shown = {link.get("name") for link in urdf.tree.findall("link") if link.find("visual") is not None}
    if shown.intersection(links) and not {element.link for element in elements}.intersection(links):
        which = "no link" if not elements else "no link of the hand"
        problem, remedy = f"{which} has collision geometry", "Set it, and links without collide as they are shown"
        raise InputError(problem, file=composition.urdf_file, key="use_visual", remedy=remedy)


def _last_attached(tree: UrdfTree, composition: Composition) -> frozenset[str]:
    """Return the movable joints of what is attached last."""
    root = tree.joints[attachment_joint(len(composition.attach) - 1)].child
    links = {root, *tree.outwards(root)}
    return frozenset(joint.name for joint in tree.movable if joint.parent in links)


def _wrist(tree: UrdfTree, chain: Chain, pads: Sequence[Facet], to: str | None) -> tuple[str, bool]:
    """Return a link of the palm whose z axis points to the pads (without pads, to the fingers), and whether it does.

    Best is what a hand of its own is mounted on, then what is called like a tool frame, then what carries the fingers.
    """
    links = tree.body_links(chain.palm)
    poses = tree.poses({})
    if not pads:
        places = [poses[joint.child][:3, 3] for joint in tree.carried(chain.palm)]
    else:
        places = [(poses[pad.link] @ [*pad.origin, 1.0])[:3] for pad in pads]
    target: Array = np.mean(places, axis=0)
    carriers = [joint.parent for joint in tree.branches(chain.palm)]
    tools = [link for part in TOOL_FRAMES for link in links if part in link]
    wanted = [*([] if to is None else [to]), *tools, *carriers, *links]
    fitting = [link for link in wanted if _points_to(poses[link], target)]
    way = target - poses[chain.palm][:3, 3]  # a frame beyond the pads may point as the fingers do
    fitting += [link for link in wanted if poses[link][:3, 2] @ way > ALONG * max(float(np.linalg.norm(way)), 0.01)]
    return (fitting[0], True) if fitting else (carriers[0], False)


def _points_to(T: Array, target: Array) -> bool:
    towards = target - T[:3, 3]
    return bool(towards @ T[:3, 2] > ALONG * np.linalg.norm(towards) and np.linalg.norm(towards) > 0.01)


def guessed_limits(found: Parts) -> dict[str, tuple[float, float]]:
    """Return limits to begin with for joints that need some and have none."""
    joints, chain = found.tree.joints, found.chain
    limits: dict[str, Any] = {name: usual_limits(joints[name], HALF_TURNS) for name in chain.arm}
    limits |= {name: usual_limits(joints[name]) for name in chain.hand}
    return {name: interval for name, interval in limits.items() if interval is not None}


def rests(found: Parts) -> dict[str, float]:
    """Return where joints of neither arm nor hand stay that cannot stay at zero: as near to it as they can, rad (m)."""
    near = {}
    for name in found.chain.still:
        joint = found.tree.joints[name]
        if joint.kind != "continuous" and usable(*joint.limits) and not joint.limits[0] <= 0.0 <= joint.limits[1]:
            near[name] = min(joint.limits, key=abs)
    return near
