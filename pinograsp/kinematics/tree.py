"""The tree of a URDF: bodies (links that fixed joints join), the movable joints between them, who follows whom."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..descriptions.urdf import Mimic, RobotUrdf, mimics_of
from .limits import limits_of
from .pinocchio_xml import pinocchio_xml


@dataclass(frozen=True)
class TreeJoint:
    """A joint of a URDF."""

    name: str
    kind: str
    """revolute, continuous, prismatic or fixed."""
    parent: str
    child: str
    limits: tuple[float, float]
    """rad (m), soft ones where there are some; 0, 0 where the URDF gives none."""
    leader: str | None
    """The joint that it mimics."""


class UrdfTree:
    """Links and joints, from the root outwards.

    Args:
        urdf: as composed.
        file: named in errors.

    Raises:
        InputError: a joint mimics itself, or what is no movable joint.
    """

    def __init__(self, urdf: RobotUrdf, file: Path) -> None:
        self._urdf = urdf
        self.root = urdf.root
        self.mimics = mimics_of(urdf.tree, file)
        """How joints follow others, by name."""
        self.joints: dict[str, TreeJoint] = {}
        for element in urdf.tree.findall("joint"):
            name = element.get("name", "")
            ends = [found.get("link", "") if (found := element.find(end)) is not None else "" for end in _ENDS]
            leader = self.mimics[name].leader if name in self.mimics else None
            self.joints[name] = TreeJoint(name, element.get("type", ""), ends[0], ends[1], limits_of(element), leader)
        self.movable = tuple(joint for joint in self.joints.values() if joint.kind != "fixed")
        self._above = {joint.child: joint for joint in self.joints.values()}
        self._carried: dict[str, list[TreeJoint]] = {}
        for joint in self.joints.values():
            self._carried.setdefault(joint.parent, []).append(joint)
        self.links = [self.root, *self.outwards(self.root)]

    def outwards(self, link: str) -> Iterator[str]:
        """Yield the links that a link carries, from the inside outwards."""
        waiting = [link]
        while waiting:
            inner = waiting.pop()
            if inner != link:
                yield inner
            waiting += [joint.child for joint in reversed(self._carried.get(inner, []))]

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
        return [joint for joint in self.movable if self.body(joint.parent) == body]

    def carried(self, body: str) -> list[TreeJoint]:
        """Return all movable joints beyond a body."""
        return [joint for joint in self.movable if any(body == self.body(j.parent) for j in self.path(joint.child))]

    def adjacent(self, first: str, second: str) -> bool:
        """Whether two links are of one body, or one movable joint joins their bodies."""
        pair = {self.body(first), self.body(second)}
        return len(pair) == 1 or any({self.body(j.parent), self.body(j.child)} == pair for j in self.movable)

    def followers(self, name: str) -> dict[str, Mimic]:
        """Return the joints that mimic a joint, and how."""
        return {follower: mimic for follower, mimic in self.mimics.items() if mimic.leader == name}

    def poses(self, angles: Mapping[str, float]) -> dict[str, Array]:
        """Return the pose of every link in the root link's frame, T_root_link, shape (4, 4).

        Args:
            angles: rad (m), of joints that mimic none; 0 for those not given. Joints that mimic others follow.
        """
        model = self._model
        q = np.zeros(model.nq)
        for joint in self.movable:
            mimic = self.mimics.get(joint.name, Mimic(joint.name, 1.0, 0.0))
            value = mimic.multiplier * angles.get(mimic.leader, 0.0) + mimic.offset
            q[model.joints[model.getJointId(joint.name)].idx_q] = value
        data = model.createData()
        pin.framesForwardKinematics(model, data, q)
        return {link: data.oMf[model.getFrameId(link, pin.BODY)].homogeneous for link in self.links}

    @cached_property
    def _model(self) -> Any:
        return pin.buildModelFromXML(pinocchio_xml(self._urdf.tree))


_ENDS = ("parent", "child")
