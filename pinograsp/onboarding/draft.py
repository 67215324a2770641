"""A first robot file: what a URDF says of arm, hand, pads and wrist."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..descriptions.composition import Composition
from ..descriptions.urdf import read_urdf
from ..verification.kinematics import Kinematics, parsed
from ..verification.meshes import read_meshes
from .chain import Chain, find_chain, last_link, require_link
from .facets import Facet, facets_of
from .facing import facing_pair, usual_limits
from .tree import Tree

ALONG = math.cos(math.radians(30.0))
"""A wrist's z axis is at most this far off the direction to the pads."""
TOOL_FRAMES = ("end_effector", "tool0", "ee_link", "eef", "flange")
"""Parts of names that tool frames have; the first one in this order is taken."""


@dataclass(frozen=True)
class Draft:
    """What was found."""

    composition: Composition
    tree: Tree
    chain: Chain
    pads: tuple[Facet, Facet] | None
    wrist: str
    towards: bool
    """Whether the wrist's z axis points to the pads."""


def draft(composition: Composition, tip: str | None) -> Draft:
    """Find out what can be known without asking.

    Args:
        composition: the URDFs; what is attached last is the hand, if anything is.
        tip: a link of the body that carries the hand, where there are several.

    Raises:
        InputError: a URDF or a mesh cannot be read, or arm and hand cannot be told apart.
    """
    urdf, file = read_urdf(composition), composition.urdf_file
    tree = Tree(urdf, file)
    hand = None
    if composition.attach:
        alone = Tree(read_urdf(arm_alone(composition)), file)
        hand, tip = frozenset(tree.joints.keys() - alone.joints.keys()), composition.attach[-1].to
    elif tip is not None:
        require_link(tree, tip, "--tip")
    chain = find_chain(tree, file, tip, hand)
    read = parsed(urdf, file)
    kinematics = Kinematics(read, file)
    moved = {tree.body(joint.child) for joint in tree.carried(chain.palm) if (joint.leader or joint.name) in chain.hand}
    meshes = read_meshes(read, composition)
    facets = [facet for link, mesh in meshes.items() if tree.body(link) in moved for facet in facets_of(mesh)]
    pads = facing_pair(facets, tree, kinematics, chain.palm, chain.hand)
    to = composition.attach[-1].to if composition.attach else None
    wrist, towards = _wrist(tree, chain, kinematics, pads, to)
    return Draft(composition, tree, chain, pads, wrist, towards)


def arm_alone(composition: Composition) -> Composition:
    """Return a composition without what is attached last."""
    return composition.model_copy(update={"attach": composition.attach[:-1]})


def tip_of(arm: Composition) -> str:
    """Return the link at the end of an arm that has no hand.

    Raises:
        InputError: there are several.
    """
    return last_link(Tree(read_urdf(arm), arm.urdf_file), arm.urdf_file)


def _wrist(
    tree: Tree, chain: Chain, kinematics: Kinematics, pads: Sequence[Facet] | None, to: str | None
) -> tuple[str, bool]:
    """Return a link of the palm whose z axis points to the pads (without pads, to the fingers), and whether it does.

    Best is what a hand of its own is mounted on, then what is called like a tool frame, then what carries the fingers.
    """
    links = tree.body_links(chain.palm)
    poses = kinematics.poses(kinematics.followed(dict.fromkeys(chain.hand, 0.0)))
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


def guessed_limits(found: Draft) -> dict[str, tuple[float, float]]:
    """Return limits to begin with for joints that need some and have none."""
    names = (*found.chain.arm, *found.chain.hand)
    limits: dict[str, Any] = {name: usual_limits(found.tree.joints[name]) for name in names}
    return {name: interval for name, interval in limits.items() if interval is not None}
