"""Where the arm ends and the hand begins."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError, UnknownNameError, close_names
from ..kinematics.tree import UrdfTree
from ..words import in_words, number_of

LONGEST_FINGER = 5
"""Joints of a finger, if the arm has no more."""


@dataclass(frozen=True)
class Chain:
    """Arm and hand of a tree."""

    arm: tuple[str, ...]
    """Joints, from the base outwards."""
    palm: str
    """Innermost link of the body that the last arm joint moves and that carries the fingers."""
    hand: tuple[str, ...]
    """Joints of the hand that others may follow, but which follow none."""
    still: tuple[str, ...]
    """Movable joints of neither, which follow none."""


Closes = Callable[[str, tuple[str, ...]], bool]
"""Whether joints of a hand, by name, close something on a body or on each other."""


def find_chain(tree: UrdfTree, file: Path, tip: str | None, hand: frozenset[str] | None, closes: Closes) -> Chain:
    """Find the longest chain of joints up to a body from which two or more fingers branch off.

    Joints of the chain neither follow others nor are followed: that sets the arm apart from the linkages of a hand.
    Where nothing branches off, the last joint of the longest chain is the hand if it closes a finger on the body that
    carries it.

    Args:
        tree: of the robot.
        file: named in errors.
        tip: a link of the body that carries the hand, if it is known.
        hand: the hand's joints, if they are known.
        closes: asked about a palm and the one joint beyond it.

    Raises:
        InputError: there are several such bodies, or none, or no such link.
    """
    if tip is not None and tip not in tree.links:
        raise UnknownNameError(f"there is no link {tip!r}", key="tip", remedy=close_names(tip, tree.links))
    palm = tree.body(tip) if tip is not None else _palm(tree, file, closes)
    arm = tuple(joint.name for joint in tree.path(palm) if _free(tree, joint.name))
    moved = [joint for joint in tree.carried(palm) if hand is None or joint.name in hand]
    leaders = tuple(joint.name for joint in moved if joint.leader is None)
    if not arm:
        raise InputError(f"no joint moves {palm}", file=file, key="tip", remedy="Name a link at the end of the arm")
    if not leaders:
        raise _no_fingers(tree, file, palm)
    used = {*arm, *leaders}
    still = tuple(joint.name for joint in tree.movable if joint.leader is None and joint.name not in used)
    return Chain(arm, palm, leaders, still)


def last_link(tree: UrdfTree, file: Path) -> str:
    """Return the one link at the end of an arm without fingers.

    Raises:
        InputError: there are several.
    """
    ends = [link for link in tree.links if not any(joint.parent == link for joint in tree.joints.values())]
    longest = max(len(tree.path(link)) for link in ends)
    found = [link for link in ends if len(tree.path(link)) == longest]
    if len(found) > 1:
        raise InputError(f"the arm ends in {in_words(found)}", file=file, key="hand.to", remedy="Name one of them")
    return found[0]


def _palm(tree: UrdfTree, file: Path, closes: Closes) -> str:
    bodies = dict.fromkeys(map(tree.body, tree.links))
    forks = [body for body in bodies if len(tree.branches(body)) > 1 and tree.path(body)]
    palms = [body for body in forks if all(_free(tree, joint.name) for joint in tree.path(body)) and _hand(tree, body)]
    if not palms:
        ends = [body for body in bodies if not tree.branches(body)]
        last = max(ends, key=lambda body: len(tree.path(body)))
        joints = tree.path(last)
        if len(joints) > 1 and all(_free(tree, joint.name) for joint in joints):
            palm, jaw = tree.body(joints[-1].parent), joints[-1].name
            if closes(palm, (jaw,)):
                return palm
        raise _no_fingers(tree, file, last)
    longest = max(len(tree.path(palm)) for palm in palms)
    tips = [palm for palm in palms if len(tree.path(palm)) == longest]
    if len(tips) > 1:
        problem = f"{len(tips)} tips, each after {number_of(longest, 'joint')}: {in_words(tips)}"
        remedy = f"Name the one that is to hold, for example {tips[0]}"
        raise InputError(problem, file=file, key="tip", remedy=remedy)
    return tips[0]


def _hand(tree: UrdfTree, palm: str) -> bool:
    """Whether what a body carries may be fingers: a torso carries arms."""
    lengths = [len(tree.path(joint.child)) - len(tree.path(palm)) for joint in tree.carried(palm)]
    return max(lengths) <= max(LONGEST_FINGER, len(tree.path(palm)))


def _free(tree: UrdfTree, name: str) -> bool:
    return tree.joints[name].leader is None and not tree.followers(name)


def _no_fingers(tree: UrdfTree, file: Path, palm: str) -> InputError:
    links, count = tree.body_links(palm), len(tree.path(palm))
    return InputError(
        f"no fingers were found: none branch off {in_words(links)}, after {number_of(count, 'joint')}",
        file=file,
        key="hand",
        remedy=f"Give the URDF of a gripper, and the link that it sits on, for example {links[-1]}",
    )
