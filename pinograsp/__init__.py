"""pinograsp: verified optimal grasps for a robot arm and hand inside a narrow enclosure.

import pinograsp

robot = pinograsp.load_robot("gen3_2f85")
scene = pinograsp.load_scene("scenes/glovebox.yaml")
result = pinograsp.plan(robot, scene, task="sphere")
best = result.best
"""

from importlib.metadata import version as _version
from pathlib import Path as _Path

from .assessment import Assessment, Errors, assess
from .database import BuildProgress, Cone, Coverage, Database, build_database
from .descriptions import load_robot_description as _load_robot_description
from .descriptions import load_scene, shipped_robots, shipped_scenes
from .descriptions.pose import Pose
from .errors import InputError, PinograspError, WorkerLostError
from .hold import HoldOptions, HoldOutcome, hold_test
from .kinematics.robot import Robot
from .planning import ConfigurationCheck, Planner, Progress, plan
from .results import Contact, Cost, Difference, Different, Grasp, Result, Setup, read_json, verify, write_json
from .solve import SolverOptions
from .verification import Certificate, Figure

__version__ = _version("pinograsp")


def load_robot(name: str | _Path) -> Robot:
    """Read a robot file with its URDF, given by path, by folder or by the name of a shipped robot.

    Raises:
        InputError: a file is missing or wrong; the message names it, the key and the remedy.
    """
    return Robot(_load_robot_description(name))


__all__ = [
    "Assessment",
    "BuildProgress",
    "Certificate",
    "Cone",
    "ConfigurationCheck",
    "Contact",
    "Cost",
    "Coverage",
    "Database",
    "Difference",
    "Different",
    "Errors",
    "Figure",
    "Grasp",
    "HoldOptions",
    "HoldOutcome",
    "InputError",
    "PinograspError",
    "Planner",
    "Pose",
    "Progress",
    "Result",
    "Robot",
    "Setup",
    "SolverOptions",
    "WorkerLostError",
    "assess",
    "build_database",
    "hold_test",
    "load_robot",
    "load_scene",
    "plan",
    "read_json",
    "shipped_robots",
    "shipped_scenes",
    "verify",
    "write_json",
]
