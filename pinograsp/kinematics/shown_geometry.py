"""What of a link is shown: its visual geometry, or that for collisions where a mesh for show cannot be drawn."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import NamedTuple

import coal
import numpy as np

from ..arrays import Array
from ..descriptions.mesh_files import mesh_bytes
from ..disk import is_file
from ..errors import FileError, InputError
from .collision_elements import Place, shape_of

_IMAGES = "{*}library_images//{*}init_from"


class Shown(NamedTuple):
    """What is shown of a link."""

    elements: list[ET.Element]
    """`<visual>` or `<collision>` elements that can be drawn."""
    problems: list[str]
    """What cannot be drawn, and why, in words."""


def shown_of(link: ET.Element, file: Path, loader: coal.CachedMeshLoader) -> Shown:
    """Return what is shown of a link of a composed URDF: all of its visual geometry, else that for collisions.

    Args:
        link: the link.
        file: its URDF.
        loader: of meshes, for Pinocchio as well, so that none is read twice.
    """
    place = Place(file, link.get("name", ""))
    visuals, problems = _drawable(link.findall("visual"), place, loader)
    if visuals and not problems:
        return Shown(visuals, [])
    collisions, more = _drawable(link.findall("collision"), place, loader)
    return Shown(collisions, list(dict.fromkeys([*problems, *more])))


def _drawable(elements: list[ET.Element], place: Place, loader: coal.CachedMeshLoader) -> Shown:
    found = Shown([], [])
    for element in elements:
        try:
            _, size, mesh = shape_of(element, place)
            if mesh is not None:
                _require_drawable(mesh, np.array(size), loader)
            found.elements.append(element)
        except FileError as error:
            address = next(element.iterfind("geometry/mesh")).get("filename")
            found.problems.append(f"{address} {error.problem}")
        except InputError as error:
            found.problems.append(error.problem)
    return found


def _require_drawable(mesh: Path, scale: Array, loader: coal.CachedMeshLoader) -> None:
    """Refuse what the viewer cannot draw; it is given the text of a COLLADA file, and its textures.

    Raises:
        FileError: it is a mesh like that.
    """
    if not is_file(mesh):
        raise FileError("was not found", file=mesh)
    content = mesh_bytes(mesh)
    try:
        read = loader.load(str(mesh), scale)
    except (ValueError, RuntimeError):
        raise FileError(f"cannot be read as {mesh.suffix[1:].upper() or 'a mesh'}", file=mesh) from None
    if not np.isfinite(read.vertices()).all():
        raise FileError("has corners that are not finite", file=mesh)
    if mesh.suffix.lower() == ".dae":
        try:
            images = [image.text or "" for image in ET.fromstring(content.decode()).iterfind(_IMAGES)]
        except (UnicodeDecodeError, ET.ParseError):
            raise FileError("is not XML in UTF-8", file=mesh) from None
        if missing := [image for image in images if not is_file(mesh.parent / image)]:
            raise FileError(f"names a texture that was not found, {missing[0]}", file=mesh)
