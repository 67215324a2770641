"""Mesh files that scene files name: where they are, what content they have, and the unit of their coordinates."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    FieldSerializationInfo,
    Tag,
    ValidationInfo,
    field_serializer,
    model_validator,
)
from pydantic_core import PydanticKnownError

from ..disk import content_of, digest, is_folder
from ..errors import FileError
from .collada import require_sound
from .locate import package_folders, resolve
from .model import Frozen
from .packages import readings
from .values import NotNegative, Positive, listed, wrong

FILE_TYPES = ("stl", "obj", "ply", "glb", "dae", "off")
"""Suffixes of mesh files, in lower case."""
SCENE_FILE = "scene file"
"""Key of the context of a validation: the file that is read."""
CONTENT = {"mesh files": "content"}
"""Context in which descriptions are written without the addresses of their mesh files: same content, same hash."""

Unit = Literal["m", "mm", "cm", "in"]
METRES: dict[Unit, float] = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
"""Metres in each unit."""
_POINTER = b"version https://git-lfs."
LARGEST = 3.0
"""A body that is larger, were its coordinates metres, has them in millimetres, m."""


def mesh_bytes(file: Path) -> bytes:
    """Return the content of a mesh file.

    Raises:
        FileError: it cannot be read, is empty, or a pointer of Git LFS stands in its place.
    """
    content = content_of(file)
    if content.startswith(_POINTER):
        raise FileError(
            "is a pointer of Git LFS, not the mesh", file=file, remedy="Run `git lfs pull` where it is from"
        )
    if not content.strip():
        raise FileError("is an empty file", file=file, remedy="Copy or export the mesh again")
    if file.suffix.lower() == ".dae":
        require_sound(content, file)
    return content


def metres_in_unit(unit: Unit | None, stated: float, extent: float) -> float:
    """Return the metres in the unit of a mesh file's coordinates.

    Args:
        unit: as described, which goes before all; None: it is not.
        stated: metres in the unit, as the mesh file says; 1 where it says nothing.
        extent: largest extent of the body along an axis, scale included, in the unit.
    """
    if unit is not None:
        return METRES[unit]
    return METRES["mm"] if stated == 1.0 and extent > LARGEST else stated


def _absolute(address: object, info: ValidationInfo) -> str:
    """Return where a mesh file is; relative addresses start at the scene file, in Python at the working directory."""
    if not isinstance(address, str | Path):
        raise PydanticKnownError("string_type")
    text = os.fspath(address)
    if Path(text).suffix[1:].lower() not in FILE_TYPES:
        known = ", ".join(f".{name}" for name in FILE_TYPES)
        raise wrong(f"{text!r} is no mesh file that can be read", remedy=f"The suffix must be one of {known}")
    scene: Path = (info.context or {}).get(SCENE_FILE, Path("scene.yaml"))
    if all(reading.package is None for reading in readings(text)):
        return os.path.normpath(scene.resolve().parent / readings(text)[0].path)
    folders = package_folders(scene, ())
    found = resolve(text, beside=scene, folders=folders)
    if found is None:
        looked = ", ".join(map(str, folders.all))
        raise wrong(f"{text} was not found", remedy=f"Looked in {looked}")
    return str(found)


MeshAddress = Annotated[Path, BeforeValidator(_absolute)]
"""Where a mesh file is; absolute when it was validated."""


def _how_many(scale: object) -> str:
    return "three" if isinstance(scale, list | tuple | np.ndarray) else "one"


Scale = Annotated[
    Annotated[Positive, Tag("one")]
    | Annotated[tuple[Positive, Positive, Positive], BeforeValidator(listed), Tag("three")],
    Discriminator(_how_many),  # so that errors are about what was given
]
"""A factor, or one along each axis."""


class MeshFile(Frozen):
    """A mesh file and how its coordinates are meant; its content is fixed when the description is made."""

    file: MeshAddress | None = None
    scale: Scale = 1.0
    """Factor on the coordinates in the file, or one along each axis; besides the unit."""
    unit: Unit | None = None
    """Of the coordinates; by default what the file says, else metres, or mm if the body were larger than 3 m."""
    largest_hole: NotNegative = 0.002
    """Holes of up to this diameter are closed, larger ones are refused, m."""
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")] | None = None
    """Of the content that the file must have; by default that which it has when the scene is read."""

    @model_validator(mode="after")
    def _content_fixed(self) -> Self:
        if self.file is not None and self.sha256 is None:
            self.__dict__["sha256"] = _digest(self.file)
        return self

    @field_serializer("file")
    def _address(self, file: Path | None, info: FieldSerializationInfo) -> str | None:
        if file is None:
            return None
        return file.suffix.lower() if info.context == CONTENT else str(file)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return the same with some fields replaced; the content of another file is another."""
        if update and "file" in update:
            update = {"sha256": None, **update}
        return super().model_copy(update=update, deep=deep)

    @property
    def scales(self) -> tuple[float, float, float]:
        """Factor on the coordinates in the file along each of x, y, z, besides the unit."""
        return self.scale if isinstance(self.scale, tuple) else (self.scale, self.scale, self.scale)

    def content(self) -> bytes:
        """Return the content of the file.

        Raises:
            FileError: it cannot be read, or is not that which was described.
        """
        assert self.file is not None
        found = mesh_bytes(self.file)
        if digest(found) != self.sha256:
            remedy = "Load the scene again; a result stands for the file that it was planned with"
            raise FileError("is not the file that the scene was made with", file=self.file, remedy=remedy)
        return found


def _digest(file: Path) -> str:
    if is_folder(file):
        raise wrong(f"{file} is a folder", "file", remedy="Name a mesh file")
    try:
        return digest(content_of(file))
    except FileError as error:
        raise wrong(
            f"{file} {error.problem}",
            "file",
            remedy="Relative addresses start at the scene file; in Python at the working folder",
        ) from None


def mesh_files(part: object, key: str = "") -> Iterator[tuple[str, MeshFile]]:
    """Yield the mesh files that a part of a scene names, however deep, each with its key path."""
    for path, mesh in described_meshes(part, key):
        if mesh.file is not None:
            yield f"{path}.file" if path else "file", mesh


def described_meshes(part: object, key: str = "") -> Iterator[tuple[str, MeshFile]]:
    """Yield what a part of a scene says of meshes, however deep, those that name no file too, with its key path."""
    if isinstance(part, MeshFile):
        yield key, part
    elif isinstance(part, Frozen):
        for name, inner in part.fields().items():
            yield from described_meshes(inner, f"{key}.{name}" if key else name)
    elif isinstance(part, Mapping):
        for name, inner in part.items():
            yield from described_meshes(inner, f"{key}.{name}" if key else name)
    elif isinstance(part, tuple):
        for index, inner in enumerate(part):
            yield from described_meshes(inner, f"{key}[{index}]")


def content_hashes(part: object) -> dict[str, str]:
    """Return the SHA-256 of the mesh files that a part of a scene names, as it was described, by key path."""
    return {key: str(mesh.sha256) for key, mesh in mesh_files(part)}
