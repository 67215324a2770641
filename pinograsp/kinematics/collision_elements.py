"""The `<collision>` elements of a prepared URDF, without reading a mesh."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..descriptions.urdf_checks import number
from ..errors import InputError
from .robot import RobotModel


@dataclass(frozen=True)
class CollisionElement:
    """One collision geometry of a link."""

    link: str
    joint: int
    """That moves it."""
    placement: Array
    """Pose in the joint's frame, shape (4, 4)."""
    kind: str
    """box, sphere, cylinder or mesh."""
    size: tuple[float, ...]
    """Box: edges; sphere: radius; cylinder: radius and length, m; mesh: scale along x, y, z."""
    mesh: Path | None
    """File of a mesh."""


_SIZES = {"box": {"size": 3}, "sphere": {"radius": 1}, "cylinder": {"radius": 1, "length": 1}, "mesh": {}}
"""Sizes that every kind must have, with the count of numbers."""


def collision_elements(robot: RobotModel) -> list[CollisionElement]:
    """Return the collision geometry of all links, from the base outwards.

    Raises:
        InputError: a collision element is not understood. (Other readers of URDFs pass over it.)
    """
    found = []
    for link in ET.fromstring(robot.urdf.xml).findall("link"):
        name = link.get("name", "")
        index = robot.model.getFrameId(name, pin.BODY)
        frame = robot.model.frames[index]
        for element in link.findall("collision"):
            kind, size, mesh = _shape(element, name, robot)
            placement = frame.placement.homogeneous @ _origin(element, name, robot)
            found.append((index, CollisionElement(name, frame.parentJoint, placement, kind, size, mesh)))
    # Pinocchio numbers frames from the base outwards; the sort keeps the order within a link.
    return [element for _, element in sorted(found, key=lambda pair: pair[0])]


def _shape(element: ET.Element, link: str, robot: RobotModel) -> tuple[str, tuple[float, ...], Path | None]:
    shape = element.find("geometry/*")
    if shape is None or shape.tag not in _SIZES:
        problem = "a collision has no geometry" if shape is None else f"a collision is a <{shape.tag}>"
        remedy = f"Use {', '.join(_SIZES)}"
        raise InputError(problem, file=robot.description.urdf_file, key=f"link {link}", remedy=remedy)
    if shape.tag == "mesh":
        scale = _numbers(shape, "scale", 3, link, robot) if shape.get("scale") else (1.0, 1.0, 1.0)
        return shape.tag, scale, Path(shape.get("filename", ""))
    size = [v for key, count in _SIZES[shape.tag].items() for v in _numbers(shape, key, count, link, robot)]
    if min(size) <= 0.0:
        problem = f"the size of a <{shape.tag}> is not positive"
        raise InputError(problem, file=robot.description.urdf_file, key=f"link {link}")
    return shape.tag, tuple(size), None


def _origin(element: ET.Element, link: str, robot: RobotModel) -> Array:
    """Return the pose of a collision in its link's frame, shape (4, 4)."""
    pose, origin = np.eye(4), element.find("origin")
    if origin is not None and origin.get("xyz"):
        pose[:3, 3] = _numbers(origin, "xyz", 3, link, robot)
    if origin is not None and origin.get("rpy"):
        pose[:3, :3] = pin.rpy.rpyToMatrix(*_numbers(origin, "rpy", 3, link, robot))
    return pose


def _numbers(element: ET.Element, key: str, count: int, link: str, robot: RobotModel) -> tuple[float, ...]:
    file = robot.description.urdf_file
    values = tuple(number(text, file, f"link {link}") for text in element.get(key, "").split())
    if len(values) != count:
        problem = f"{key} of a collision's <{element.tag}> has {len(values)} numbers, not {count}"
        raise InputError(problem, file=file, key=f"link {link}")
    return values
