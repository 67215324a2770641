"""Content of the files that a robot file leads to: URDFs, SRDFs and collision meshes."""

from __future__ import annotations

from pathlib import Path

from ..disk import digest, digest_of
from ..errors import FileError
from .composition import Composition
from .urdf import RobotUrdf

Hashes = dict[str, str]


def hashes_of(robot: Composition, urdf: RobotUrdf) -> Hashes:
    """Return the SHA-256 hashes of the files of a robot, as they are on disk now.

    That is every URDF and SRDF under the key by which the robot file names it, and all collision meshes together under
    `meshes`: the hash of their hashes in the order of the links.

    Args:
        robot: the robot file.
        urdf: composed from it.

    Raises:
        FileError: one cannot be read.
    """
    meshes = (Path(mesh.get("filename", "")) for mesh in urdf.tree.iterfind("link/collision/geometry/mesh"))
    content = "".join(digest_of(file) for file in dict.fromkeys(meshes))
    return {key: digest_of(file) for key, file in robot.files.items()} | {"meshes": digest(content.encode())}


def require_same(robot: Composition, loaded: Hashes, now: Hashes) -> None:
    """Refuse a robot whose files are not those that it was loaded from.

    Raises:
        FileError: they differ; the keys are named.
    """
    if changed := [key for key in loaded.keys() | now.keys() if loaded.get(key) != now.get(key)]:
        problem = f"{', '.join(sorted(changed))} changed since the robot was loaded"
        raise FileError(problem, file=robot.source, remedy="Load it again")
