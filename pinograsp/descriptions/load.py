"""Scenes and robot files read, given by path or by the name of a shipped one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from . import locate
from .model import Root
from .packages import absolute_entry
from .robot import RobotDescription
from .scene import Scene


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
    description = _read(locate.robot_file(name), RobotDescription)
    if packages:
        first = tuple(map(absolute_entry, packages))
        description = description.model_copy(update={"packages": (*first, *description.packages)})
    _ = description.files
    return description


def _read(file: Path, model: type[Root]) -> Root:
    from .files import read_file  # YAML, which who reads a result does not need

    return read_file(file, model)
