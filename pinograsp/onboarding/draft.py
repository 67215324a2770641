"""A first robot file, and what it says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..frozen import Record
from ..words import in_words, number_of
from .parts import Parts


@dataclass(frozen=True, eq=False, repr=False)
class Draft(Record):
    """A first robot file as text, and what it says; from `new_robot_file`."""

    not_in_json = ("text",)
    also_in_json = ("checks",)

    text: str
    """YAML of the robot file. Lines with CHECK hold what a URDF does not say."""
    arm: tuple[str, ...]
    """Names of the arm's joints, from the base outwards."""
    hand: tuple[str, ...]
    """Names of the hand's joints that others may follow, but which follow none: one synergy each."""
    followers: Mapping[str, tuple[str, ...]]
    """Names of the joints that follow each of these."""
    wrist: str
    """Name of the wrist link."""
    pads: tuple[str, ...]
    """Names of the links whose flat faces close on each other, the thumb's first where there are more than two; empty:
    there are no two, write pads by hand."""
    pad_sizes: Array
    """Edges of these faces, m, shape (pads, 2)."""

    coupled: str
    """That two joints move fingers alike and are taken for one synergy, in words; empty: there are no such two."""

    @property
    def checks(self) -> dict[int, str]:
        """Lines of the text with CHECK, by their number."""
        numbered = list(enumerate(self.text.splitlines(), 1))[1:]  # the first says what CHECK means
        return {number: line.strip() for number, line in numbered if "CHECK" in line}

    def summary(self) -> list[str]:
        """Return lines that say what was found, pads in mm."""
        followers = sum(map(len, self.followers.values()))
        followed = f", followed by {number_of(followers, 'joint')}" if followers else ""
        lines = [
            f"arm: {number_of(len(self.arm), 'joint')}, {self.arm[0]} .. {self.arm[-1]}; wrist {self.wrist}",
            f"hand: {in_words(list(self.hand))}{followed}",
        ]
        lines += [self.coupled] if self.coupled else []
        if not self.pads:
            return [*lines, "pads: no two flat faces of the fingers close on each other; write them by hand"]
        sizes = zip(self.pads, 1e3 * self.pad_sizes, strict=True)
        size = " and ".join(f"{u:.1f} x {v:.1f} mm of {link}" for link, (u, v) in sizes)
        return [*lines, f"pads: flat faces that close on each other, {size}"]


def draft_of(parts: Parts, text: str) -> Draft:
    """Return the draft of a robot file.

    Args:
        parts: what was found.
        text: of the robot file, made of them.
    """
    pads, hand = parts.pads, parts.chain.hand
    return Draft(
        text=text,
        arm=parts.chain.arm,
        hand=hand,
        followers={joint: tuple(parts.tree.followers(joint)) for joint in hand},
        wrist=parts.wrist,
        pads=tuple(pad.link for pad in pads),
        pad_sizes=np.array([pad.sides for pad in pads]).reshape(-1, 2),
        coupled="" if parts.coupled is None else f"{parts.coupled.said}: taken for one synergy",
    )
