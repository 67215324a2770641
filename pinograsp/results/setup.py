"""The job that a result belongs to: robot, scene and task."""

from __future__ import annotations

from dataclasses import dataclass

from ..descriptions import RobotDescription, Scene


@dataclass(frozen=True)
class Setup:
    """Robot, scene and task: everything that a result can be drawn and verified with."""

    robot: RobotDescription
    """The robot file, with every pad of the robot."""
    scene: Scene
    task: str
    """Name of a task of the scene."""
