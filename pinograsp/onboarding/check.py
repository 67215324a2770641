"""The check of a robot file: everything that can be said of it without a scene."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from ..compiled import compiling
from ..descriptions import RobotDescription, load_robot_description, load_unfinished_robot
from ..descriptions.urdf import read_urdf
from ..errors import InputError
from ..frozen import Record
from ..kinematics.collision_elements import link_elements
from ..kinematics.robot import Robot
from ..progress import Report, no_report
from .collisions import collision_findings
from .coupled import coupled_findings
from .faces import hand_faces
from .findings import Face, Finding, LinkFigures, in_order
from .hand import hand_findings
from .joints import joint_findings, unusable_limits
from .link_meshes import link_meshes
from .meshes import link_figures, mesh_findings
from .pads import pad_findings


@dataclass(frozen=True, eq=False, repr=False)
class RobotReport(Record):
    """Findings of the check of a robot file."""

    not_in_json = ("robot",)
    also_in_json = ("wrong",)

    name: str
    """Of the robot."""
    findings: tuple[Finding, ...]
    """Remarks, the worst first, those with the same advice one after the other."""
    links: tuple[LinkFigures, ...] = ()
    """How closely the planner follows each link; empty if the file gives no robot."""
    faces: tuple[Face, ...] = ()
    """Flat faces of the hand, where its pads are still to be written."""
    robot: Robot | None = field(default=None, repr=False, compare=False)
    """The robot; None if the file gives none. It does not count in comparisons."""

    @property
    def wrong(self) -> bool:
        """Whether something is wrong."""
        return any(finding.level == "wrong" for finding in self.findings)


def check_robot(name: str | Path, progress: Report = no_report, *, packages: Sequence[str | Path] = ()) -> RobotReport:
    """Look at a robot file: what is wrong or doubtful with it, and how closely it is followed.

    A file that can be read and gives no robot is a finding, too, not an error.

    Args:
        name: path, folder, or name of a shipped robot.
        packages: folders in which `package://` is looked up besides those of the file, or `name=folder` for the folder
            of one package; relative to the working directory.
        progress: called as the work goes on: `convex pieces` of the meshes, and `compiling`, once on a machine.

    Raises:
        InputError: the robot file itself is missing, is not YAML, or has a key or value that is wrong.
    """
    unfinished: tuple[Finding, ...] = ()
    description: RobotDescription
    try:
        description = load_robot_description(name, packages)
    except InputError as error:
        if error.key != "pads":
            raise
        description, unfinished = load_unfinished_robot(name, packages), (_of(error),)
    try:
        robot = Robot(description)
    except InputError as error:
        return RobotReport(description.name, (*unfinished, *_refused(description, error)))
    try:
        meshes = link_meshes(link_elements(robot.urdf.composed, description.urdf_file))
        figures = link_figures(robot, meshes, progress)
    except InputError as error:
        return RobotReport(description.name, (*unfinished, _of(error)))
    with compiling(progress):
        findings = [
            *unfinished,
            *unusable_limits(description, robot.urdf.composed),
            *joint_findings(robot),
            *coupled_findings(robot),
            *([] if unfinished else hand_findings(robot)),
            *pad_findings(robot, meshes),
            *mesh_findings(figures, meshes, robot),
            *collision_findings(robot, meshes),
            *(Finding("ok", f"passed over in the URDF: {remark}") for remark in robot.urdf.composed.remarks),
        ]
    faces = hand_faces(robot, meshes) if unfinished else ()
    return RobotReport(description.name, in_order(findings), tuple(figures), faces, robot)


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
