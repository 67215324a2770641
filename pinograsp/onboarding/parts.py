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
from ..kinematics.collision_elements import link_elements
from ..kinematics.tree import UrdfTree
from ..progress import Progress, Report, no_report
from .chain import Chain, find_chain
from .facets import Facet, facets_of
from .facing import facing_pair, usual_limits
from .link_meshes import link_meshes

ALONG = math.cos(math.radians(30.0))
"""A wrist's z axis is at most this far off the direction to the pads."""
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
    pads: tuple[Facet, Facet] | None
    """Flat faces of the fingers, each of a `link`, that close on each other; None: there are no such two."""
    wrist: str
    """Name of the wrist link."""
    towards: bool
    """Whether the wrist's z axis points to the pads."""


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
    chain = find_chain(tree, file, tip, hand)
    moved = {tree.body(joint.child) for joint in tree.carried(chain.palm) if (joint.leader or joint.name) in chain.hand}
    meshes = {link: mesh for link, mesh in link_meshes(link_elements(urdf, file)).items() if tree.body(link) in moved}
    facets: list[Facet] = []
    for done, (link, mesh) in enumerate(meshes.items()):
        report(Progress("flat faces of links", done, len(meshes)))
        facets += facets_of(link, mesh)
    pads = facing_pair(facets, tree, chain.palm, chain.hand)
    to = composition.attach[-1].to if composition.attach else None
    wrist, towards = _wrist(tree, chain, pads, to)
    return Parts(composition, tree, chain, pads, wrist, towards)


def _last_attached(tree: UrdfTree, composition: Composition) -> frozenset[str]:
    """Return the movable joints of what is attached last."""
    root = tree.joints[attachment_joint(len(composition.attach) - 1)].child
    links = {root, *tree.outwards(root)}
    return frozenset(joint.name for joint in tree.movable if joint.parent in links)


def _wrist(tree: UrdfTree, chain: Chain, pads: Sequence[Facet] | None, to: str | None) -> tuple[str, bool]:
    """Return a link of the palm whose z axis points to the pads (without pads, to the fingers), and whether it does.

    Best is what a hand of its own is mounted on, then what is called like a tool frame, then what carries the fingers.
    """
    links = tree.body_links(chain.palm)
    poses = tree.poses({})
    if pads is None:
        places = [poses[joint.child][:3, 3] for joint in tree.carried(chain.palm)]
    else:
        places = [(poses[pad.link] @ [*pad.origin, 1.0])[:3] for pad in pads]
    target: Array = np.mean(places, axis=0)
    carriers = [joint.parent for joint in tree.branches(chain.palm)]
    tools = [link for part in TOOL_FRAMES for link in links if part in link]
    wanted = [*([] if to is None else [to]), *tools, *carriers, *links]
    fitting = [link for link in wanted if _points_to(poses[link], target)]
    return (fitting[0], True) if fitting else (carriers[0], False)


def _points_to(T: Array, target: Array) -> bool:
    towards = target - T[:3, 3]
    return bool(towards @ T[:3, 2] > ALONG * np.linalg.norm(towards) and np.linalg.norm(towards) > 0.01)


def guessed_limits(found: Parts) -> dict[str, tuple[float, float]]:
    """Return limits to begin with for joints that need some and have none."""
    names = (*found.chain.arm, *found.chain.hand)
    limits: dict[str, Any] = {name: usual_limits(found.tree.joints[name]) for name in names}
    return {name: interval for name, interval in limits.items() if interval is not None}
