"""Robot files, scene files and tasks: YAML in, frozen and validated data out.

`files` reads YAML with line numbers, `locate` finds files by path, by name and through `package://`,
`robot` (with `composition` and `hand`) and `scene` hold the pydantic models. Nothing here knows Pinocchio or Coal.
"""

from .locate import shipped_robots, shipped_scenes
from .pads import robot_for
from .robot import RobotDescription, load_robot_description
from .scene import Scene, Task, load_scene
from .schema import schema

__all__ = [
    "RobotDescription",
    "Scene",
    "Task",
    "load_robot_description",
    "load_scene",
    "robot_for",
    "schema",
    "shipped_robots",
    "shipped_scenes",
]
