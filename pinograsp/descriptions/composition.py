"""URDFs in a robot file: which ones, what of them is taken, how they are put together, where they are."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from pydantic import Field, StrictBool

from ..errors import FileError
from . import locate
from .model import FileRoot, Frozen
from .pose import Pose
from .values import FilePath, Format1, Name, Number, Table, empty


class UrdfPart(Frozen):
    """The part that is taken of one URDF: all, or what `root` carries, less what the links under `leave_out` carry."""

    urdf: Name
    """URDF: a path relative to the robot file, or `package://`."""
    srdf: str | None = None
    """SRDF that says which pairs of links are left out, found in the same way; none if not given."""
    root: Name | None = None
    """Link with which it begins; the URDF's own root if not given."""
    leave_out: tuple[Name, ...] = ()
    """Links that are left out, with all that they carry."""
    hold: Table[Name, Number] = Field(default_factory=empty)
    """Joints fixed for good, with those that follow them, rad (m). One that floats or moves in a plane: at 0."""
    use_visual: StrictBool = False
    """Whether links without collision geometry collide as they are shown."""


class Attachment(UrdfPart, Pose):
    """A further URDF, fixed to a link: a hand on an arm, an arm on a rail. The pose is that of its root in the link."""

    to: Name
    """Link of what is there so far."""
    prefix: str = ""
    """Put before every name of links and joints of this URDF."""


class UrdfFiles(NamedTuple):
    """Files on disk."""

    urdf: Path
    srdf: Path | None


class Composition(FileRoot, UrdfPart):
    """The URDFs of a robot file: one, or several put together, and where they are."""

    format: Format1
    """Version of the file's format."""
    source: FilePath
    """Where the robot file was read from: what it names is found from there."""
    attach: tuple[Attachment, ...] = ()
    """Further URDFs, each fixed to a link of what is there so far."""
    packages: tuple[FilePath, ...] = ()
    """Folders, besides those of the installed wheels, in which `package://` is looked up, or `name=folder` of one."""

    @cached_property
    def folders(self) -> list[Path]:
        """Folders in which packages are looked up, those of single packages first."""
        return locate.package_folders(self.source, self.packages).all

    @cached_property
    def urdf_file(self) -> Path:
        """The URDF on disk."""
        return self._resolve("urdf", self.urdf)

    @cached_property
    def srdf_file(self) -> Path | None:
        """The SRDF on disk, if the file names one."""
        return None if self.srdf is None else self._resolve("srdf", self.srdf)

    @cached_property
    def attached_files(self) -> tuple[UrdfFiles, ...]:
        """Files of the attached URDFs."""
        return tuple(
            UrdfFiles(
                self._resolve(f"attach[{i}].urdf", part.urdf),
                None if part.srdf is None else self._resolve(f"attach[{i}].srdf", part.srdf),
            )
            for i, part in enumerate(self.attach)
        )

    @property
    def files(self) -> dict[str, Path]:
        """All files that the robot file names, by key."""
        parts = [("", UrdfFiles(self.urdf_file, self.srdf_file))]
        parts += [(f"attach[{i}].", files) for i, files in enumerate(self.attached_files)]
        named = {f"{key}{role}": file for key, files in parts for role, file in files._asdict().items()}
        return {key: file for key, file in named.items() if file is not None}

    def _resolve(self, key: str, address: str) -> Path:
        folders = locate.package_folders(self.source, self.packages)
        found = locate.resolve(address, beside=self.source, folders=folders)
        if found is None:
            raise FileError(
                f"{address} was not found",
                file=self.source,
                key=key,
                remedy=locate.not_found(address, beside=self.source, folders=folders),
            )
        return found
