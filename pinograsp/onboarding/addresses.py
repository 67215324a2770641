"""How a robot file names the URDFs and meshes that it is made from."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from ..descriptions.locate import resolve, wheel_share
from ..descriptions.packages import (
    PackageFolders,
    candidates,
    expanded,
    folders_in,
    named_folder,
    package_name,
    readings,
    remedy_for,
)
from ..descriptions.urdf_checks import LOOSE
from ..descriptions.urdf_xml import carried, ends, parse
from ..disk import is_file
from ..errors import FileError

PACKAGE = "package://"
BESIDE = 3
"""Folders above a URDF in which packages beside its own are looked for."""


def find_urdf(address: str, packages: Sequence[str | Path], argument: str) -> Path:
    """Return the URDF behind a path or a `package://` address that was given as an argument.

    Raises:
        FileError: there is none.
    """
    if readings(address)[0].package is None:
        file = Path(readings(address)[0].path)
        if not is_file(file):
            raise FileError("no such file", file=file, key=argument)
        return file.resolve()
    folders = PackageFolders(packages, Path.cwd(), [wheel_share()])
    for file in candidates(address, Path.cwd(), folders):
        if is_file(file):
            return file.resolve()
    raise FileError(f"{address} was not found", key=argument, remedy=remedy_for(address, Path.cwd(), folders))


def address_of(file: Path, output: Path) -> str:
    """Return how the robot file `output` is to name a URDF: by its package if a wheel holds it, else by its path."""
    share = wheel_share().resolve()
    if file.is_relative_to(share):
        return f"{PACKAGE}{file.relative_to(share).as_posix()}"
    return _relative(file, output.resolve().parent)


def needed_packages(urdfs: Sequence[Path], packages: Sequence[str | Path], output: Path) -> tuple[Path, ...]:
    """Return the entries that the robot file must have so that URDFs and meshes are found, relative to it.

    These are the given ones, those of URDFs that are not below the robot file, and parents of a URDF below which its
    meshes turn out to be, as in a ROS workspace, or which turn out to be their package, whatever their name is.
    """
    home, share = output.resolve().parent, wheel_share().resolve()
    given = [(name, expanded(folder).resolve()) for name, folder in map(named_folder, packages)]

    for urdf in urdfs:
        known = (home, share, *(folder for name, folder in given if name is None))
        if not any(urdf.is_relative_to(folder) for folder in known):
            given.append((None, urdf.parent))
        for mesh in parse(urdf, "robot").iterfind("link/*/geometry/mesh"):
            address = mesh.get("filename", "")
            folders = PackageFolders([_entry(*one) for one in given], home, [home, share])
            if resolve(address, beside=urdf, folders=folders) is None:
                found = _holding(address, urdf)
                given += [] if found is None or found in given else [found]
    return tuple(Path(_entry(name, _relative(folder, home))) for name, folder in given)


def loose_joints(urdf: Path, root: str | None = None) -> dict[str, float]:
    """Return the joints of a URDF, or of what a link of it carries, that a robot file has to hold, each at 0."""
    tree = parse(urdf, "robot")
    links = None if root is None else carried(tree, root)
    return {
        joint.get("name", ""): 0.0
        for joint in tree.findall("joint")
        if joint.get("type") in LOOSE and (links is None or ends(joint)[0] in links)
    }


def _entry(name: str | None, folder: str | Path) -> str:
    return str(folder) if name is None else f"{name}={folder}"


def _holding(address: str, urdf: Path) -> tuple[str | None, Path] | None:
    """Return the innermost folder with which an address in a URDF leads to a file.

    That is one above the URDF; or, with the name of the package, that of the package, above or beside the URDF, by its
    `package.xml`, also if it lacks the file, or as it has the file.
    """
    for package, path in readings(address):
        if package is None:
            file = (urdf.parent / path).resolve()
            if is_file(file):
                return None, Path(os.path.commonpath([urdf.parent, file.parent]))
            continue
        above = list(urdf.parents)
        for folder in above:
            if is_file(folder / package / path):
                return None, folder
        beside = [inner for folder in above[:BESIDE] for inner in folders_in(folder)]
        ones = [folder for folder in (*above, *beside) if package_name(folder) == package]
        for folder in (*ones, *above):
            if is_file(folder / path):
                return package, folder
        if ones:  # not the file, but then what is to be done about that can be said
            return package, ones[0]
    return None


def _relative(path: Path, home: Path) -> str:
    return Path(os.path.relpath(path, home)).as_posix()
