"""The check of a robot file: everything that can be said of it without a scene."""

from __future__ import annotations

from dataclasses import dataclass

from ..descriptions import RobotDescription
from ..descriptions.urdf import read_urdf
from ..errors import InputError
from ..kinematics.robot import RobotModel
from ..verification.kinematics import Kinematics, parsed
from ..verification.meshes import read_meshes
from .collisions import collision_findings
from .findings import Finding, LinkFigures
from .hand import hand_findings
from .joints import joint_findings, unusable_limits
from .meshes import link_figures, mesh_findings
from .pads import pad_findings


@dataclass(frozen=True)
class Report:
    """What a check found."""

    findings: tuple[Finding, ...]
    links: tuple[LinkFigures, ...] = ()
    robot: RobotModel | None = None
    """None if the file gives no robot."""

    @property
    def wrong(self) -> bool:
        """Whether something is wrong."""
        return any(finding.level == "wrong" for finding in self.findings)


def check_robot(description: RobotDescription) -> Report:
    """Look at a robot file. What makes it useless is a finding, too; nothing is raised."""
    try:
        urdf = read_urdf(description)
        unusable = tuple(unusable_limits(description, urdf))
        if unusable:
            return Report(unusable)
        robot = RobotModel(description)
        kinematics = Kinematics(parsed(urdf, description.urdf_file), description.urdf_file)
        meshes = read_meshes(parsed(urdf, description.urdf_file), description)
        figures = link_figures(robot, meshes)
    except InputError as error:
        return Report((_of(error),))
    findings = [
        *joint_findings(robot),
        *hand_findings(robot),
        *pad_findings(robot, meshes),
        *mesh_findings(figures, meshes, urdf, robot),
        *collision_findings(robot, urdf, kinematics, meshes),
    ]
    return Report(tuple(findings), tuple(figures), robot)


def _of(error: InputError) -> Finding:
    where = ": ".join(str(part) for part in (error.file, error.key) if part)
    return Finding("wrong", f"{where}: {error.problem}" if where else error.problem, error.remedy or "")
