"""The job that a result belongs to: robot, scene and task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..descriptions import RobotDescription, Scene
from ..descriptions.model import FileRoot
from ..frozen import Record


@dataclass(frozen=True, eq=False, repr=False)
class Setup(Record):
    """Robot, scene and task: everything that a result can be drawn and verified with."""

    robot: RobotDescription
    """The robot file, with every pad of the robot."""
    scene: Scene
    """The scene, objects where they were when it was planned."""
    task: str
    """Name of a task of the scene."""

    def __str__(self) -> str:
        """Return the names in words."""
        return f"{self.robot.name} in {self.scene.name}, task {self.task}"

    def __repr__(self) -> str:
        return f"<Setup: {self}>"

    def to_json(self) -> dict[str, Any]:
        """Return the content of robot file and scene file and the name of the task, as JSON data."""
        return {"robot": _content(self.robot), "scene": _content(self.scene), "task": self.task}


def _content(description: FileRoot) -> dict[str, Any]:
    """Return the content of a robot file or scene file; where it was read from holds in every working directory."""
    source = description.source  # none of what was made in Python
    return description.model_dump(mode="json") | {"source": str(source.resolve()) if source else None}
