"""The check of a robot file: everything that can be said of it without a scene."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

from ..descriptions import RobotDescription
from ..descriptions.urdf import read_urdf
from ..errors import InputError
from ..kinematics.collision_elements import link_elements
from ..kinematics.robot import Robot
from .collisions import collision_findings
from .findings import Finding, LinkFigures
from .hand import hand_findings
from .joints import joint_findings, unusable_limits
from .link_meshes import link_meshes
from .meshes import link_figures, mesh_findings
from .pads import pad_findings


@dataclass(frozen=True)
class Report:
    """What a check found."""

    findings: tuple[Finding, ...]
    links: tuple[LinkFigures, ...] = ()
    robot: Robot | None = None
    """None if the file gives no robot."""

    @property
    def wrong(self) -> bool:
        """Whether something is wrong."""
        return any(finding.level == "wrong" for finding in self.findings)


def check_robot(description: RobotDescription) -> Report:
    """Look at a robot file. What makes it useless is a finding, too; nothing is raised."""
    try:
        robot = Robot(description)
    except InputError as error:
        return Report(_refused(description, error))
    try:
        meshes = link_meshes(link_elements(robot.urdf.composed, description.urdf_file))
        figures = link_figures(robot, meshes)
    except InputError as error:
        return Report((_of(error),))
    findings = [
        *unusable_limits(description, robot.urdf.composed),
        *joint_findings(robot),
        *hand_findings(robot),
        *pad_findings(robot, meshes),
        *mesh_findings(figures, meshes, robot),
        *collision_findings(robot, meshes),
    ]
    return Report(tuple(findings), tuple(figures), robot)


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
