"""Which pairs of links are checked against each other: all, less those that the SRDF or the tree excuses."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

from ..errors import InputError
from .clearance import LinkPair
from .kinematics import Kinematics
from .meshes import LinkMesh

_EXCUSED = {"adjacent", "default", "always", "user"}


def link_pairs(
    meshes: dict[str, LinkMesh], kinematics: Kinematics, srdf: Path | None
) -> tuple[list[LinkPair], list[LinkPair]]:
    """Return the pairs that must keep the margin and those that must not touch.

    Links of one body are never checked. The second list holds the pairs that the SRDF disables because no
    sample showed them in collision ("Never", or no reason): a claim, so it is checked. Without an SRDF,
    adjacent links are left out and all others must keep the margin.
    """
    reasons = None if srdf is None else _disabled(srdf)
    enabled: list[LinkPair] = []
    never: list[LinkPair] = []
    for first, second in combinations(meshes.values(), 2):
        if kinematics.body[first.link] == kinematics.body[second.link]:
            continue
        if reasons is None:
            if not kinematics.adjacent(first.link, second.link):
                enabled.append((first, second))
            continue
        given = reasons.get(frozenset((first.link, second.link)))
        if given is None:
            enabled.append((first, second))
        elif not given & _EXCUSED:
            never.append((first, second))
    return enabled, never


def _disabled(srdf: Path) -> dict[frozenset[str], set[str]]:
    """Return the reasons, in lower case, for which pairs of links are disabled."""
    try:
        root = ElementTree.parse(srdf).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise InputError(f"cannot be read as SRDF: {error}", file=srdf) from None
    reasons: dict[frozenset[str], set[str]] = {}
    for entry in root.iter("disable_collisions"):
        pair = frozenset((entry.get("link1", ""), entry.get("link2", "")))
        reasons.setdefault(pair, set()).add(entry.get("reason", "").lower())
    return reasons
