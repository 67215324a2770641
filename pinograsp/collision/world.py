"""The bodies of a task, and which of them must keep apart.

A body is one or more convex solids that are fixed to each other. It stands in the frame of its parent, a joint of the
robot or the world (joint 0), at a pose that can change while its solids stay. A body that the hand holds has a joint
of the robot as its parent.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

from ..arrays import Array

Role = Literal["link", "wall", "obstacle", "target", "held"]
CLEARANCES: dict[Role, str] = {
    "wall": "enclosure clearance",
    "obstacle": "obstacle clearance",
    "target": "object clearance",
    "link": "self clearance",
    "held": "self clearance",
}
"""Name of the robot's clearance to bodies of a role, as in a certificate."""


class Solid(NamedTuple):
    """A convex shape in the frame of its body."""

    shape: Any
    """Coal geometry."""
    placement: Array
    """Pose of the shape in the body's frame, shape (4, 4)."""
    center: Array
    """Centre of the bounding sphere, body frame, m, shape (3,); unused for a wall."""
    radius: float
    """Of the bounding sphere, m; infinite for a wall."""
    part: int = 0
    """Which part of its body it belongs to; 0 but in a compound."""


class Hull(NamedTuple):
    """The convex hull of some solids of a body, or a single solid as it is."""

    solid: Solid
    parts: tuple[int, ...]
    """Which solids of the body it is the hull of."""


class BodyKey(NamedTuple):
    """Key of a body in its world: a link and an obstacle may have one name."""

    role: Role
    name: str


@dataclass(frozen=True)
class Body:
    """Convex solids that move as one."""

    role: Role
    name: str
    """Of the link, wall, obstacle or object."""
    joint: int
    """Parent: joint of the robot that carries the body; 0: the world."""
    pose: Array
    """Of the body's frame in the parent's, shape (4, 4)."""
    solids: tuple[Solid, ...]
    hulls: tuple[Hull, ...]
    """Hulls that together hold the solids: fewer, and larger."""

    @property
    def key(self) -> BodyKey:
        """Role and name."""
        return BodyKey(self.role, self.name)


@dataclass(frozen=True)
class World:
    """Bodies, least distances by role, and pairs of bodies that may touch."""

    bodies: tuple[Body, ...]
    margins: Mapping[Role, float]
    """Least distance of the robot, and of what it holds, to bodies of a role, m; a role that is left out is not
    kept clear of."""
    allowed: frozenset[frozenset[BodyKey]]
    """Pairs that are not checked."""

    def of(self, *roles: Role) -> tuple[Body, ...]:
        """Return the bodies in some roles, in their order."""
        return tuple(body for body in self.bodies if body.role in roles)

    def moved(self, key: BodyKey, pose: Array) -> World:
        """Return the world with one body at another pose in its parent's frame, shape (4, 4); nothing is rebuilt.

        Raises:
            KeyError: there is no such body.
        """
        if all(body.key != key for body in self.bodies):
            raise KeyError(key)
        return replace(self, bodies=tuple(replace(b, pose=pose) if b.key == key else b for b in self.bodies))

    def keep_apart(self, first: Body, second: Body, supports: Array) -> bool:
        """Whether two bodies must keep apart: they move against each other, and are not allowed to touch.

        Args:
            first: a link, or a body that is held.
            second: any other body.
            supports: which joints move which: `Robot.supports`, shape (joints, nv).
        """
        moving = bool((supports[first.joint] != supports[second.joint]).any())
        return moving and second.role in self.margins and frozenset((first.key, second.key)) not in self.allowed


def pair_of_links(first: str, second: str) -> frozenset[BodyKey]:
    """Return the pair of two links, as in `World.allowed`."""
    return frozenset((BodyKey("link", first), BodyKey("link", second)))
