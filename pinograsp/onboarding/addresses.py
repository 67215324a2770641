"""How a robot file names the URDFs and meshes that it is made from."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from ..descriptions.locate import resolve, wheel_share
from ..descriptions.urdf import carried, ends, parse
from ..descriptions.urdf_checks import LOOSE
from ..disk import is_file
from ..errors import FileError

PACKAGE = "package://"


def find_urdf(address: str, packages: Sequence[Path], argument: str) -> Path:
    """Return the URDF behind a path or a `package://` address that was given as an argument.

    Raises:
        FileError: there is none.
    """
    if not address.startswith(PACKAGE):
        file = Path(address).expanduser()
        if not is_file(file):
            raise FileError("no such file", file=file, key=argument)
        return file.resolve()
    folders = [*packages, wheel_share()]
    for folder in folders:
        file = folder / address.removeprefix(PACKAGE)
        if is_file(file):
            return file.resolve()
    looked = ", ".join(str(folder) for folder in folders)
    remedy = f"Looked in {looked}; give further folders as packages"
    raise FileError(f"{address} was not found", key=argument, remedy=remedy)


def address_of(file: Path, output: Path) -> str:
    """Return how the robot file `output` is to name a URDF: by its package if a wheel holds it, else by its path."""
    share = wheel_share().resolve()
    if file.is_relative_to(share):
        return f"{PACKAGE}{file.relative_to(share).as_posix()}"
    return _relative(file, output.resolve().parent)


def needed_packages(urdfs: Sequence[Path], packages: Sequence[Path], output: Path) -> tuple[Path, ...]:
    """Return the folders that the robot file must list so that URDFs and meshes are found, relative to it.

    These are the given ones, those of URDFs that are not below the robot file, and parents of a URDF below which its
    meshes turn out to be, as in a ROS workspace.
    """
    home, share = output.resolve().parent, wheel_share().resolve()
    folders = [folder.resolve() for folder in packages]

    def add(folder: Path) -> None:
        if not any(folder.is_relative_to(known) for known in (home, share, *folders)):
            folders.append(folder)

    for urdf in urdfs:
        add(urdf.parent)
        for mesh in parse(urdf, "robot").iterfind("link/*/geometry/mesh"):
            address = mesh.get("filename", "")
            if resolve(address, beside=urdf, folders=[*folders, home, share]) is None:
                above = _holding(address, urdf)
                if above is not None and above not in folders:
                    folders.append(above)
    return tuple(Path(_relative(folder, home)) for folder in folders)


def loose_joints(urdf: Path, root: str | None = None) -> dict[str, float]:
    """Return the joints of a URDF, or of what a link of it carries, that a robot file has to hold, each at 0."""
    tree = parse(urdf, "robot")
    links = None if root is None else carried(tree, root)
    return {
        joint.get("name", ""): 0.0
        for joint in tree.findall("joint")
        if joint.get("type") in LOOSE and (links is None or ends(joint)[0] in links)
    }


def _holding(address: str, urdf: Path) -> Path | None:
    """Return the innermost folder above a URDF with which an address in it leads to a file."""
    if address.startswith(PACKAGE):
        tail = address.removeprefix(PACKAGE)
        return next((folder for folder in urdf.parents if (folder / tail).is_file()), None)
    file = (urdf.parent / address.removeprefix("file://")).resolve()
    return Path(os.path.commonpath([urdf.parent, file.parent])) if file.is_file() else None


def _relative(path: Path, home: Path) -> str:
    return Path(os.path.relpath(path, home)).as_posix()
