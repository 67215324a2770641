"""The tree of a URDF: bodies (links that fixed joints join), the movable joints between them, who follows whom."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ..descriptions.urdf import RobotUrdf, mimics_of


@dataclass(frozen=True)
class TreeJoint:
    """A joint of a URDF."""

    name: str
    kind: str
    """revolute, continuous, prismatic or fixed."""
    parent: str
    child: str
    limits: tuple[float, float]
    """rad (m); 0, 0 where the URDF gives none."""
    leader: str | None
    """The joint that it mimics."""
    multiplier: float


class Tree:
    """Links and joints, from the root outwards.

    Args:
        urdf: as composed.
        file: named in errors.
    """

    def __init__(self, urdf: RobotUrdf, file: Path) -> None:
        mimics = mimics_of(urdf.tree, file)
        self.root = urdf.root
        self.joints: dict[str, TreeJoint] = {}
        for element in urdf.tree.findall("joint"):
            name = element.get("name", "")
            ends = [found.get("link", "") if (found := element.find(end)) is not None else "" for end in _ENDS]
            limit = element.find("limit")
            low, high = (0.0 if limit is None else float(limit.get(key, "0")) for key in ("lower", "upper"))
            mimic = mimics.get(name)
            leader, multiplier = (None, 1.0) if mimic is None else (mimic.leader, mimic.multiplier)
            kind = element.get("type", "")
            self.joints[name] = TreeJoint(name, kind, ends[0], ends[1], (low, high), leader, multiplier)
        self._above = {joint.child: joint for joint in self.joints.values()}
        self.links = [self.root, *self._outwards(self.root)]

    def _outwards(self, link: str) -> Iterator[str]:
        for joint in self.joints.values():
            if joint.parent == link:
                yield joint.child
                yield from self._outwards(joint.child)

    def path(self, link: str) -> list[TreeJoint]:
        """Return the movable joints between the root and a link, from the root outwards."""
        found = []
        while link in self._above:
            joint = self._above[link]
            found += [] if joint.kind == "fixed" else [joint]
            link = joint.parent
        return found[::-1]

    def body(self, link: str) -> str:
        """Return the innermost link of a link's body."""
        while link in self._above and self._above[link].kind == "fixed":
            link = self._above[link].parent
        return link

    def body_links(self, body: str) -> list[str]:
        """Return the links of a body, from the inside outwards."""
        return [link for link in self.links if self.body(link) == body]

    def branches(self, body: str) -> list[TreeJoint]:
        """Return the movable joints that a body carries directly."""
        return [joint for joint in self.movable() if self.body(joint.parent) == body]

    def carried(self, body: str) -> list[TreeJoint]:
        """Return all movable joints beyond a body."""
        return [joint for joint in self.movable() if any(body == self.body(j.parent) for j in self.path(joint.child))]

    def movable(self) -> list[TreeJoint]:
        """Return the movable joints."""
        return [joint for joint in self.joints.values() if joint.kind != "fixed"]

    def followers(self, name: str) -> list[TreeJoint]:
        """Return the joints that mimic a joint."""
        return [joint for joint in self.joints.values() if joint.leader == name]


_ENDS = ("parent", "child")
