"""The check of a robot file: everything that can be said of it without a scene."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ..compiled import compiling
from ..descriptions import RobotDescription, load_robot_description
from ..descriptions.urdf import read_urdf
from ..errors import InputError
from ..kinematics.collision_elements import link_elements
from ..kinematics.robot import Robot
from ..progress import Report, no_report
from .collisions import collision_findings
from .findings import Finding, LinkFigures
from .hand import hand_findings
from .joints import joint_findings, unusable_limits
from .link_meshes import link_meshes
from .meshes import link_figures, mesh_findings
from .pads import pad_findings


@dataclass(frozen=True)
class RobotReport:
    """Findings of the check of a robot file."""

    name: str
    """Of the robot."""
    findings: tuple[Finding, ...]
    """In the order in which things are looked at."""
    links: tuple[LinkFigures, ...] = ()
    """How closely each link is followed; empty if the file gives no robot."""
    robot: Robot | None = None
    """None if the file gives no robot."""

    @property
    def wrong(self) -> bool:
        """Whether something is wrong."""
        return any(finding.level == "wrong" for finding in self.findings)


def check_robot(name: str | Path, progress: Report = no_report) -> RobotReport:
    """Look at a robot file: what is wrong or doubtful with it, and how closely it is followed.

    A file that can be read and gives no robot is a finding, too, not an error.

    Args:
        name: path, folder, or name of a shipped robot.
        progress: called as the work goes on: `convex pieces` of the meshes, and `compiling`, once on a machine.

    Raises:
        InputError: the robot file itself is missing, is not YAML, or has a key or value that is wrong.
    """
    description = load_robot_description(name)
    try:
        robot = Robot(description)
    except InputError as error:
        return RobotReport(description.name, _refused(description, error))
    try:
        meshes = link_meshes(link_elements(robot.urdf.composed, description.urdf_file))
        figures = link_figures(robot, meshes, progress)
    except InputError as error:
        return RobotReport(description.name, (_of(error),))
    with compiling(progress):
        findings = [
            *unusable_limits(description, robot.urdf.composed),
            *joint_findings(robot),
            *hand_findings(robot),
            *pad_findings(robot, meshes),
            *mesh_findings(figures, meshes, robot),
            *collision_findings(robot, meshes),
        ]
    return RobotReport(description.name, tuple(findings), tuple(figures), robot)


def _refused(description: RobotDescription, error: InputError) -> tuple[Finding, ...]:
    """Return why there is no robot model: if for unusable limits, all of them (the error names one), else the error."""
    with suppress(InputError):  # of a URDF that cannot be read: that is the error given
        unusable = tuple(unusable_limits(description, read_urdf(description)))
        if unusable:
            return unusable
    return (_of(error),)


def _of(error: InputError) -> Finding:
    where = ": ".join(str(part) for part in (error.file, error.key) if part)
    return Finding("wrong", f"{where}: {error.problem}" if where else error.problem, error.remedy or "")
