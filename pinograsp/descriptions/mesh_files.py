"""Mesh files that scene files name: where they are, what content they have, and the unit of their coordinates."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BeforeValidator, ValidationInfo
from pydantic_core import PydanticKnownError

from ..disk import digest_of, is_folder
from ..errors import FileError
from .locate import package_folders, resolve
from .values import wrong

FILE_TYPES = ("stl", "obj", "ply", "glb", "dae", "off")
"""Suffixes of mesh files, in lower case."""
SCENE_FILE = "scene file"
"""Key of the validation's context: the file that is read."""

Unit = Literal["m", "mm", "cm", "in"]
METRES: dict[Unit, float] = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
"""Metres in each unit."""
LARGEST = 3.0
"""A body that is larger, were its coordinates metres, has them in millimetres, m."""


def metres_in_unit(unit: Unit | None, stated: float, extent: float) -> float:
    """Return the metres in a unit of a mesh file's coordinates.

    Args:
        unit: of the scene file, which goes before all; None: it gives none.
        stated: metres in a unit, as the mesh file says; 1 where it says nothing.
        extent: largest extent of the body along an axis, scale included, in the unit of the file.
    """
    if unit is not None:
        return METRES[unit]
    return METRES["mm"] if stated == 1.0 and extent > LARGEST else stated


def content_digest(file: Path) -> str:
    """Return the SHA-256 of a mesh file as a validator does, which raises what is wrong with the key `file`."""
    if is_folder(file):
        raise wrong(f"{file} is a folder", "file", remedy="Name a mesh file")
    try:
        return digest_of(file)
    except FileError as error:
        raise wrong(f"{file} {error.problem}", "file", remedy="Relative addresses start at the scene file") from None


def _absolute(address: object, info: ValidationInfo) -> Path:
    """Return where a mesh file is; relative addresses start at the scene file, in Python at the working directory."""
    if not isinstance(address, str | Path):
        raise PydanticKnownError("string_type")
    text = os.fspath(address)
    if Path(text).suffix[1:].lower() not in FILE_TYPES:
        known = ", ".join(f".{name}" for name in FILE_TYPES)
        raise wrong(f"{text!r} is no mesh file that can be read", remedy=f"The suffix must be one of {known}")
    scene = (info.context or {}).get(SCENE_FILE)
    if text.startswith("package://"):
        beside = Path("scene.yaml") if scene is None else scene
        folders = package_folders(beside, ())
        found = resolve(text, beside=beside, folders=folders)
        if found is None:
            raise wrong(f"{text} was not found", remedy="Looked in " + ", ".join(map(str, folders)))
        return found
    home = Path.cwd() if scene is None else scene.resolve().parent
    return Path(os.path.normpath(home / Path(text.removeprefix("file://")).expanduser()))


MeshAddress = Annotated[Path, BeforeValidator(_absolute)]
"""Where a mesh file is; absolute when it was validated."""
