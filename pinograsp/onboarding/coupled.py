"""Two joints of a jaw that look coupled, though no `<mimic>` says so."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..geometry.patches import patch_point
from ..kinematics.robot import Robot
from ..kinematics.tree import TreeJoint, UrdfTree
from .findings import Finding
from .pad_text import number
from .yaml_text import text, texts

ALIKE = 0.05
"""Part by which ranges and rates of coupled joints differ at most."""
_STEP = 1e-4


class Facing(NamedTuple):
    """A pad, link frame."""

    link: str
    place: Array
    """Its middle, m, shape (3,)."""
    normal: Array
    """Outward, shape (3,)."""


@dataclass(frozen=True)
class Coupled:
    """Joints that move two fingers alike: second = factor * first + offset."""

    first: str
    second: str
    factor: float
    """1 or -1."""
    offset: float
    """rad (m)."""

    @property
    def synergy(self) -> str:
        """The two as one synergy of a robot file."""
        return f"{{name: close, joints: {{{text(self.first)}: 1.0, {text(self.second)}: {self.factor:.1f}}}}}"

    @property
    def rest(self) -> str | None:
        """Where the second joint is when the first is at 0, as a robot file has it; None: at 0, too."""
        return None if self.offset == 0.0 else f"{text(self.second)}: {number(self.offset)}"

    @property
    def apart(self) -> str:
        """The two as two synergies of a robot file."""
        return f"[{{joint: {text(self.first)}}}, {{joint: {text(self.second)}}}]"

    @property
    def said(self) -> str:
        """What is to be said of them."""
        return f"{texts((self.first, self.second))[1:-1]} move two fingers alike, and no <mimic> couples them"


def coupled_joints(tree: UrdfTree, hand: Sequence[str], pads: Sequence[Facing]) -> Coupled | None:
    """Return how the two joints of a jaw look coupled, or None if they do not.

    They do if each moves a finger with one of the two pads, as far and at the same rate towards its side.

    Args:
        tree: of the robot.
        hand: joints that follow none and move fingers.
        pads: of the hand.
    """
    if len(hand) != 2 or len(pads) != 2:
        return None
    movers = [[name for name in hand if name in _moved_by(tree, pad.link)] for pad in pads]
    if sorted(movers) != sorted([name] for name in hand):
        return None
    sides = dict(zip((names[0] for names in movers), pads, strict=True))
    first, second = (tree.joints[name] for name in hand)
    spans = [joint.limits[1] - joint.limits[0] for joint in (first, second)]
    rates = [_rate(tree, joint, sides[joint.name]) for joint in (first, second)]
    if first.kind != second.kind or not _alike(spans) or not _alike([abs(rate) for rate in rates]):
        return None
    factor = 1.0 if rates[0] * rates[1] > 0.0 else -1.0
    offset = second.limits[0 if factor > 0.0 else 1] - factor * first.limits[0]
    return Coupled(first.name, second.name, factor, offset if abs(offset) > ALIKE * max(spans) else 0.0)


def coupled_findings(robot: Robot) -> Iterator[Finding]:
    """Find two joints that a robot file moves on their own and that look coupled."""
    hand, pads = robot.description.hand.synergies, list[Facing]()
    for pad in robot.description.pads:
        middle = patch_point(pad.patch, np.mean(pad.patch.parameters, axis=1))
        R = pad.patch.rotation
        pads.append(Facing(pad.link, R @ middle.point + pad.patch.origin, R @ middle.normal))
    found = coupled_joints(robot.urdf.tree, [synergy.joint for synergy in hand if synergy.joint is not None], pads)
    if found is not None and len(hand) == 2:
        rest = "" if found.rest is None else f" and hand.rest: {{{found.rest}}}"
        yield Finding("doubtful", found.said, f"If they move together, hand.synergies: [{found.synergy}]{rest}")


def _moved_by(tree: UrdfTree, link: str) -> set[str]:
    return {joint.leader or joint.name for joint in tree.path(link)}


def _alike(sizes: Sequence[float]) -> bool:
    return min(sizes) > 0.0 and max(sizes) - min(sizes) < ALIKE * max(sizes)


def _rate(tree: UrdfTree, joint: TreeJoint, pad: Facing) -> float:
    """Return how fast a pad comes along its normal per unit of its joint, in the middle of the joint's range, m."""
    middle = sum(joint.limits) / 2
    ends = [tree.poses({joint.name: middle + step})[pad.link] for step in (-_STEP, _STEP)]
    moved = (ends[1] - ends[0]) @ [*pad.place, 1.0] / (2.0 * _STEP)
    normal = (ends[0] + ends[1])[:3, :3] @ pad.normal / 2.0
    return float(moved[:3] @ normal)
