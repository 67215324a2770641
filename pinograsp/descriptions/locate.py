"""Where files are: robots and scenes by path or by name, URDFs and meshes through `package://`.

A mesh or a URDF is looked for only in the folder of the file that names it, in the folders that the robot
file lists under `packages` (see `packages`), and in the `share` folder of the installed model wheels.
"""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path

from ..disk import is_file, is_folder
from ..errors import FileError, InputError, close_names
from .packages import PackageFolders, candidates, expanded, remedy_for

_PACKAGE = Path(__file__).resolve().parent.parent


def _shipped(kind: str) -> Path:
    """Return the folder of the shipped robots or scenes: inside the wheel, or at the top of the repository."""
    inside = _PACKAGE / "data" / kind
    return inside if inside.is_dir() else _PACKAGE.parent / kind


def shipped_robots() -> dict[str, Path]:
    """Return the robot files that come with pinograsp, by name."""
    return {file.parent.name: file for file in sorted(_shipped("robots").glob("*/robot.yaml"))}


def shipped_scenes() -> dict[str, Path]:
    """Return the scene files that come with pinograsp, by name."""
    return {file.stem: file for file in sorted(_shipped("scenes").glob("*.yaml"))}


def robot_file(name: str | Path) -> Path:
    """Find a robot file by path (the file or its folder) or by the name of a shipped robot."""
    path = _expanded(name)
    if is_file(path / "robot.yaml"):
        return path / "robot.yaml"
    return _by_path_or_name(path, "robot", shipped_robots())


def scene_file(name: str | Path) -> Path:
    """Find a scene file by path, or by the name of a shipped scene (`glovebox`, `scenes/glovebox.yaml`)."""
    return _by_path_or_name(_expanded(name), "scene", shipped_scenes())


def _expanded(name: str | Path) -> Path:
    """Return the path, with ~ replaced."""
    if name == "":  # which would be the working directory
        raise InputError("a path or a name is wanted, not ''")
    try:
        return expanded(name)
    except TypeError:
        raise InputError(f"a path or a name is wanted, not {name!r}") from None


def _by_path_or_name(path: Path, kind: str, shipped: dict[str, Path]) -> Path:
    if is_file(path):
        return path
    parts = [part for part in path.parts if part not in {f"{kind}s", "robot.yaml"}]
    if not path.is_absolute() and len(parts) == 1:
        name = parts[0].removesuffix(".yaml")
        if name in shipped:
            return shipped[name]
    if is_folder(path):
        problem = "is a folder, not a scene file" if kind == "scene" else "is a folder without robot.yaml"
        raise FileError(problem, file=path, remedy=f"Name a {kind} file")
    raise FileError(
        f"no such {kind} file, and no shipped {kind} has this name",
        file=path,
        remedy=close_names(path.stem if kind == "scene" else path.name, list(shipped)),
    )


def wheel_share() -> Path:
    """Return the folder into which the model wheels install their packages, the first one where Python looks for them.

    It need not be that of this environment: wheels may be the user's own, or those that an environment inherits.
    """
    inside = Path("cmeel.prefix") / "share"
    shares = (Path(folder) / inside for folder in sys.path)
    found = next((share for share in shares if share.is_dir()), None)
    return Path(sysconfig.get_path("purelib")) / inside if found is None else found


def package_folders(file: Path, packages: tuple[Path, ...]) -> PackageFolders:
    """Return the folders in which packages are looked up, in order.

    `example-robot-data` keeps its packages' content below `example-robot-data/robots`; its `package://`
    addresses start at the `share` folder like everyone else's.
    """
    beside = file.resolve().parent
    return PackageFolders(packages, beside, [beside, wheel_share()])


def resolve(address: str, *, beside: Path, folders: PackageFolders) -> Path | None:
    """Return the file behind an address, or None.

    `beside` is the file that holds the address. A result outside `folders` and the folder of `beside`
    is refused (None).
    """
    if "\0" in address:  # no file has it in its name
        return None
    home = beside.resolve().parent
    allowed = [home, *(folder.resolve() for folder in folders.all)]
    for candidate in candidates(address, home, folders):
        real = candidate.resolve()
        if is_file(real) and any(real.is_relative_to(folder) for folder in allowed):
            return real
    return None


def not_found(address: str, *, beside: Path, folders: PackageFolders) -> str:
    """Return what is to be done about an address that `resolve` does not find."""
    return remedy_for(address, beside.resolve().parent, folders)
