"""Robot files, scene files and tasks: YAML in, frozen and validated data out.

`load` reads what `locate` finds by path, by name and through `package://`; `files` does so for YAML with line numbers.
`robot` (with `composition` and `hand`), `scene` and `task` hold the pydantic models. Nothing here knows Pinocchio or
Coal.
"""

from .load import load_robot_description, load_scene, load_unfinished_robot
from .locate import shipped_robots, shipped_scenes
from .pads import robot_for
from .robot import RobotDescription
from .scene import Scene
from .schema import schema
from .task import Task

__all__ = [
    "RobotDescription",
    "Scene",
    "Task",
    "load_robot_description",
    "load_scene",
    "load_unfinished_robot",
    "robot_for",
    "schema",
    "shipped_robots",
    "shipped_scenes",
]
