"""The `<collision>` elements of a composed URDF, without reading a mesh."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..descriptions.urdf import RobotUrdf
from ..descriptions.urdf_checks import number
from ..errors import InputError
from .robot import Robot


@dataclass(frozen=True)
class LinkElement:
    """One collision geometry of a link."""

    link: str
    origin: Array
    """Pose in the link's frame, shape (4, 4)."""
    kind: str
    """box, sphere, cylinder or mesh."""
    size: tuple[float, ...]
    """Box: edges; sphere: radius; cylinder: radius and length, m; mesh: scale along x, y, z."""
    mesh: Path | None
    """File of a mesh."""


@dataclass(frozen=True)
class CollisionElement(LinkElement):
    """One collision geometry of a robot."""

    joint: int
    """That moves it."""
    placement: Array
    """Pose in the joint's frame, shape (4, 4)."""


_SIZES = {"box": {"size": 3}, "sphere": {"radius": 1}, "cylinder": {"radius": 1, "length": 1}, "mesh": {}}
"""Sizes that every kind must have, with the count of numbers."""


def collision_elements(robot: Robot) -> list[CollisionElement]:
    """Return the collision geometry of all links of a robot, from the base outwards.

    Raises:
        InputError: a collision element is not understood.
    """
    found = []
    for element in link_elements(robot.urdf.composed, robot.description.urdf_file):
        index = robot.model.getFrameId(element.link, pin.BODY)
        frame = robot.model.frames[index]
        placement = frame.placement.homogeneous @ element.origin
        found.append((index, CollisionElement(**vars(element), joint=frame.parentJoint, placement=placement)))
    # Pinocchio numbers frames from the base outwards; the sort keeps the order within a link.
    return [element for _, element in sorted(found, key=lambda pair: pair[0])]


def link_elements(urdf: RobotUrdf, file: Path) -> list[LinkElement]:
    """Return the collision geometry of all links of a URDF, link by link in its order.

    Args:
        urdf: as composed.
        file: named in errors.

    Raises:
        InputError: a collision element is not understood. (Other readers of URDFs pass over it.)
    """
    return [element for link in urdf.tree.findall("link") for element in _of_link(link, file)]


class Place(NamedTuple):
    """Where an element stands, for errors."""

    file: Path
    link: str

    def error(self, problem: str, remedy: str | None = None) -> InputError:
        return InputError(problem, file=self.file, key=f"link {self.link}", remedy=remedy)


def _of_link(link: ET.Element, file: Path) -> Iterator[LinkElement]:
    place = Place(file, link.get("name", ""))
    for element in link.findall("collision"):
        kind, size, mesh = shape_of(element, place)
        yield LinkElement(place.link, _origin(element, place), kind, size, mesh)


def shape_of(element: ET.Element, place: Place) -> tuple[str, tuple[float, ...], Path | None]:
    """Return kind, size and mesh, as `LinkElement` has them, of a `<collision>` or `<visual>`.

    Raises:
        InputError: it has no geometry, or one that is not understood.
    """
    shape = element.find("geometry/*")
    if shape is None or shape.tag not in _SIZES:
        problem = "has no geometry" if shape is None else f"is a <{shape.tag}>"
        raise place.error(f"a {element.tag} {problem}", f"Use {', '.join(_SIZES)}")
    if shape.tag == "mesh":
        if not shape.get("filename"):
            raise place.error(f"the <mesh> of a {element.tag} names no file")
        scale = _numbers(shape, "scale", 3, place) if shape.get("scale") else (1.0, 1.0, 1.0)
        return shape.tag, scale, Path(shape.get("filename", ""))
    size = [v for key, count in _SIZES[shape.tag].items() for v in _numbers(shape, key, count, place)]
    if min(size) <= 0.0:
        raise place.error(f"the size of a <{shape.tag}> is not positive")
    return shape.tag, tuple(size), None


def _origin(element: ET.Element, place: Place) -> Array:
    """Return the pose of a collision in its link's frame, shape (4, 4)."""
    pose, origin = np.eye(4), element.find("origin")
    if origin is not None and origin.get("xyz"):
        pose[:3, 3] = _numbers(origin, "xyz", 3, place)
    if origin is not None and origin.get("rpy"):
        pose[:3, :3] = pin.rpy.rpyToMatrix(*_numbers(origin, "rpy", 3, place))
    return pose


def _numbers(element: ET.Element, key: str, count: int, place: Place) -> tuple[float, ...]:
    values = tuple(number(text, place.file, f"link {place.link}") for text in element.get(key, "").split())
    if len(values) != count:
        raise place.error(f"{key} of a <{element.tag}> has {len(values)} numbers, not {count}")
    return values
