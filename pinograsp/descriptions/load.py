"""Scenes and robot files read, given by path or by the name of a shipped one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from . import locate
from .model import Root
from .packages import absolute_entry
from .robot import RobotDescription, UnfinishedRobot
from .scene import Scene

Described = TypeVar("Described", bound=RobotDescription)


def load_scene(name: str | Path) -> Scene:
    """Read a scene file, given by path or by the name of a shipped scene.

    Raises:
        FileError: the file is missing, cannot be read or is not YAML.
        InputError: a key or value is wrong; the message names file, line and key.
    """
    return _read(locate.scene_file(name), Scene)


def load_robot_description(name: str | Path, packages: Sequence[str | Path] = ()) -> RobotDescription:
    """Read a robot file, given by path, by folder or by the name of a shipped robot.

    Args:
        name: of the file.
        packages: folders, or `name=folder`, that go before those of the file; relative to the working directory.

    Raises:
        FileError: the file, its URDF or its SRDF is missing, cannot be read or is not YAML.
        InputError: a key or value is wrong; the message names file, line and key.
    """
    return _with_packages(_read(locate.robot_file(name), RobotDescription), packages)


def load_unfinished_robot(name: str | Path, packages: Sequence[str | Path] = ()) -> UnfinishedRobot:
    """Read a robot file that may still be without pads, otherwise as `load_robot_description` does.

    Args:
        name: as there.
        packages: as there.

    Raises:
        FileError: as there.
        InputError: as there.
    """
    return _with_packages(_read(locate.robot_file(name), UnfinishedRobot), packages)


def _with_packages(description: Described, packages: Sequence[str | Path]) -> Described:
    """Return a robot file with folders before its own, its files there."""
    if packages:
        first = tuple(map(absolute_entry, packages))
        description = description.model_copy(update={"packages": (*first, *description.packages)})
    _ = description.files
    return description


def _read(file: Path, model: type[Root]) -> Root:
    from .files import read_file  # YAML, which who reads a result does not need

    return read_file(file, model)
