"""Link poses of a URDF, from the tree that yourdfpy reads.

The product of joint transforms is written out here: it takes every joint's own angle from the claim (mimic
joints included) and needs a twentieth of the time of yourdfpy's scene graph.
"""

from __future__ import annotations

import copy
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yourdfpy

from ..arrays import Array
from ..descriptions.urdf import RobotUrdf
from ..errors import FileError, InputError

Poses = dict[str, Array]
"""Link name to T_world_link, shape (4, 4)."""

_MOVABLE = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Joint:
    """A movable joint: its limits (None if continuous) and what it mimics."""

    name: str
    limits: tuple[float, float] | None
    mimics: str | None
    multiplier: float
    offset: float


@dataclass(frozen=True)
class Twist:
    """A movable joint in the world."""

    joint: str
    revolute: bool
    """Whether it turns; otherwise it slides."""
    axis: Array
    """Unit vector, shape (3,)."""
    place: Array
    """A point of the axis, m, shape (3,)."""


def parsed(urdf: RobotUrdf, file: Path) -> Any:
    """Return a composed URDF as yourdfpy reads it, without its meshes.

    Raises:
        InputError: it is no URDF; `file` is named.
    """
    try:
        return yourdfpy.URDF.load(io.BytesIO(urdf.xml.encode()), build_scene_graph=False, load_meshes=False)
    except (OSError, SyntaxError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise FileError(f"cannot be read as URDF: {error}", file=file) from None


class Kinematics:
    """The tree of links and joints, its root at the world's origin until it is mounted.

    Args:
        urdf: as `parsed` returns it.
        file: the URDF, named in errors.
    """

    def __init__(self, urdf: Any, file: Path) -> None:
        self._T_world_root: Array = np.eye(4)
        self._tree = _from_root_outwards(urdf, file)
        self.root: str = self._tree[0].parent if self._tree else next(iter(urdf.link_map))
        self.joints = tuple(_joint(joint) for joint in self._tree if joint.type in _MOVABLE)
        self.joint_order = tuple(joint.name for joint in urdf.robot.joints if joint.type in _MOVABLE)
        """Names of the movable joints as the document has them."""
        self._origins = np.array([np.eye(4) if joint.origin is None else joint.origin for joint in self._tree]).reshape(
            -1, 4, 4
        )
        axes = np.array([_axis(joint) for joint in self._tree]).reshape(-1, 3)
        revolute = np.array([joint.type in ("revolute", "continuous") for joint in self._tree], dtype=bool)
        self._axes = axes
        self._above = {joint.child: i for i, joint in enumerate(self._tree)}
        self._slides = np.where(revolute[:, None], 0.0, axes)
        self._skew = np.zeros((len(axes), 3, 3))
        x, y, z = (axes * revolute[:, None]).T
        self._skew[:, 0, 1], self._skew[:, 0, 2], self._skew[:, 1, 2] = -z, y, -x
        self._skew -= self._skew.transpose(0, 2, 1)
        self._skew_squared = self._skew @ self._skew
        self.body = self._bodies()

    def mounted(self, T_world_root: Array) -> Kinematics:
        """Return the same tree with its root at a pose in the world, shape (4, 4)."""
        tree = copy.copy(self)
        tree._T_world_root = T_world_root
        return tree

    def _bodies(self) -> dict[str, str]:
        """Return for every link the first link of its body: links joined by fixed joints are one body."""
        body = {self.root: self.root}
        for joint in self._tree:
            body[joint.child] = joint.child if joint.type in _MOVABLE else body[joint.parent]
        return body

    def moves(self, link: str) -> bool:
        """Whether a link is not rigidly fixed to the root."""
        return self.body[link] != self.root

    def adjacent(self, first: str, second: str) -> bool:
        """Whether one movable joint joins the bodies of two links."""
        pair = {self.body[first], self.body[second]}
        return any({self.body[joint.parent], self.body[joint.child]} == pair for joint in self._tree)

    def twists(self, link: str, poses: Poses) -> list[Twist]:
        """Return the movable joints between the root and a link as they turn or slide in the world, root first.

        Args:
            link: its name.
            poses: of all links, as `poses` returns them.
        """
        found = []
        while link in self._above:
            i = self._above[link]
            joint = self._tree[i]
            if joint.type in _MOVABLE:
                T = poses[joint.child]
                found.append(Twist(joint.name, joint.type != "prismatic", T[:3, :3] @ self._axes[i], T[:3, 3]))
            link = joint.parent
        return found[::-1]

    def moved_by(self, first: str, second: str) -> set[str]:
        """Return the joints that move two links against each other; for a mimic joint, the one that leads it."""
        joints = {joint.name: joint for joint in self.joints}

        def on_the_way(link: str) -> set[str]:
            found: set[str] = set()
            while link in self._above:
                joint = self._tree[self._above[link]]
                found |= {joint.name} & joints.keys()
                link = joint.parent
            return found

        def leader(name: str) -> str:
            mimicked = joints[name].mimics
            return name if mimicked is None else leader(mimicked)

        return {leader(name) for name in on_the_way(first) ^ on_the_way(second)}

    def followed(self, angles: Mapping[str, float]) -> dict[str, float]:
        """Return the value of every movable joint, rad (m): as given, as a mimic joint has to follow, or zero."""
        joints = {joint.name: joint for joint in self.joints}

        def value(name: str) -> float:
            joint = joints[name]
            if joint.mimics is None:
                return angles.get(name, 0.0)
            return joint.multiplier * value(joint.mimics) + joint.offset

        return {name: value(name) for name in joints}

    def poses(self, angles: Mapping[str, float]) -> Poses:
        """Return the pose in the world of every link.

        Args:
            angles: angle (rad) or displacement (m) of every movable joint.
        """
        q = np.array([angles[joint.name] if joint.type in _MOVABLE else 0.0 for joint in self._tree])
        # Rodrigues: R = I + sin q [a] + (1 - cos q) [a]^2
        motion = np.tile(np.eye(4), (len(q), 1, 1))
        motion[:, :3, :3] += np.sin(q)[:, None, None] * self._skew
        motion[:, :3, :3] += (1.0 - np.cos(q))[:, None, None] * self._skew_squared
        motion[:, :3, 3] = q[:, None] * self._slides
        T_parent_child = self._origins @ motion
        poses = {self.root: self._T_world_root}
        for joint, T in zip(self._tree, T_parent_child, strict=True):
            poses[joint.child] = poses[joint.parent] @ T
        return poses


def _from_root_outwards(urdf: Any, file: Path) -> list[Any]:
    """Return all joints, parents before children."""
    children = {joint.child for joint in urdf.robot.joints}
    roots = [name for name in urdf.link_map if name not in children]
    if len(roots) != 1:
        raise InputError(f"has {len(roots)} root links, one is wanted", file=file)
    for joint in urdf.robot.joints:
        if joint.type not in (*_MOVABLE, "fixed"):
            raise InputError(f"joint {joint.name} is of type {joint.type}, which is not supported", file=file)
    ordered: list[Any] = []
    frontier = roots
    while frontier:
        found = [joint for joint in urdf.robot.joints if joint.parent in frontier]
        ordered += found
        frontier = [joint.child for joint in found]
    return ordered


def _axis(joint: Any) -> Array:
    if joint.type not in _MOVABLE:
        return np.zeros(3)
    axis = np.array([1.0, 0.0, 0.0] if joint.axis is None else joint.axis, dtype=np.float64)
    return np.asarray(axis / np.linalg.norm(axis))


def _joint(joint: Any) -> Joint:
    limits = None
    if joint.type != "continuous":
        # A limit that the URDF leaves out is 0 by its specification.
        lower, upper = (joint.limit.lower, joint.limit.upper) if joint.limit else (None, None)
        limits = _softened(float(lower or 0.0), float(upper or 0.0), joint.safety_controller)
    mimic = joint.mimic
    if mimic is None:
        return Joint(joint.name, limits, None, 1.0, 0.0)
    multiplier = 1.0 if mimic.multiplier is None else float(mimic.multiplier)
    return Joint(joint.name, limits, mimic.joint, multiplier, float(mimic.offset or 0.0))


def _softened(lower: float, upper: float, controller: Any) -> tuple[float, float]:
    """Return the part of a joint's range that a safety controller leaves; all of it if that is none."""
    if controller is None:
        return lower, upper
    ends = [controller.soft_lower_limit, controller.soft_upper_limit]
    low = lower if ends[0] is None or ends[0] < lower else float(ends[0])
    high = upper if ends[1] is None or ends[1] > upper else float(ends[1])
    return (low, high) if low < high else (lower, upper)
