"""A robot as the verification reads it: everything that no scene and no task changes."""

from __future__ import annotations

from ..descriptions import RobotDescription
from ..descriptions.urdf import read_urdf
from ..errors import InputError, UnknownNameError, close_names
from ..memo import remembered
from .allowed_pairs import Sampling
from .clearance import LinkPair
from .joints import joint_limits
from .kinematics import Kinematics, parsed
from .meshes import read_meshes
from .pairs import link_pairs
from .synergies import Synergies


@remembered
def read_robot(description: RobotDescription) -> VerifiedRobot:
    """Return the robot of a robot file; URDF, SRDF and meshes are read once, as long as `description` lives.

    Raises:
        InputError: a file is missing or cannot be read, or names a joint or link that is not there.
    """
    return VerifiedRobot(description)


class VerifiedRobot:
    """Kinematics, meshes, limits and synergies of a robot; its root stands at the world's origin."""

    def __init__(self, description: RobotDescription) -> None:
        # Not the robot file itself: what is remembered for it must not keep it alive.
        self.arm, self.hand = description.arm, description.hand
        self.urdf = read_urdf(description)
        urdf = parsed(self.urdf, description.urdf_file)
        self.kinematics = Kinematics(urdf, description.urdf_file)
        self.limits = joint_limits(self.kinematics.joints, description)
        self.synergies = Synergies.of(description, self.kinematics.joints)
        self.endless = {name for name in description.arm.joints if name not in self.limits}
        """Arm joints of which whole turns do not count."""
        self.meshes = read_meshes(urdf, description)
        _require_known(description, self.kinematics)
        # Links fixed to the root do not move: whether the mounting is free is not a matter of the grasp.
        self.moving = [mesh for mesh in self.meshes.values() if self.kinematics.moves(mesh.link)]
        if not self.moving:
            raise InputError(
                "no moving link has collision geometry, nothing can be verified", file=description.urdf_file
            )

    def pairs(self, margin: float) -> tuple[list[LinkPair], list[LinkPair]]:
        """Return the pairs of links that must keep a margin (m), and those that must not touch."""
        return _pairs(self, margin)


@remembered
def _pairs(robot: VerifiedRobot, margin: float) -> tuple[list[LinkPair], list[LinkPair]]:
    sampling = Sampling(robot.kinematics, robot.arm, robot.hand, robot.synergies, robot.limits)
    return link_pairs(robot.meshes, robot.urdf, sampling, margin)


def _require_known(robot: RobotDescription, kinematics: Kinematics) -> None:
    """Refuse a robot file that names joints or links which the URDF does not have."""
    joints = {joint.name for joint in kinematics.joints}
    used = {"arm": robot.arm.joints, "hand": (*sorted(robot.hand.joints), *robot.hand.rest)}
    for key, names in used.items():
        for name in names:
            if name not in joints:
                remedy = close_names(name, sorted(joints))
                raise UnknownNameError(
                    f"the URDF has no movable joint {name!r}", file=robot.source, key=key, remedy=remedy
                )
    links = [("arm.wrist", robot.arm.wrist), *(("pads", pad.link) for pad in robot.pads)]
    for key, link in links:
        if link not in kinematics.body:
            remedy = close_names(link, sorted(kinematics.body))
            raise UnknownNameError(f"the URDF has no link {link!r}", file=robot.source, key=key, remedy=remedy)
