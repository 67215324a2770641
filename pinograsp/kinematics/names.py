"""Names of joints and links in a robot file, held against the URDF."""

from __future__ import annotations

from ..descriptions import RobotDescription
from ..errors import InputError, UnknownNameError, close_names
from .urdf import PreparedUrdf


def check_names(description: RobotDescription, urdf: PreparedUrdf) -> None:
    """Refuse a robot file that names what the URDF does not have, or for what it is not.

    Raises:
        InputError: a joint or link is unknown, mimics another one, or is named for arm and hand.
    """
    known, links = list(urdf.movable), list(urdf.links)

    def refuse(problem: str, key: str, remedy: str) -> None:
        raise InputError(problem, file=description.source, key=key, remedy=remedy)

    def require_leader(joint: str, key: str) -> None:
        require(joint, known, "joint", key, description)
        if joint in urdf.mimics:
            leader = urdf.mimics[joint].leader
            refuse(f"joint {joint!r} mimics {leader!r}", key, f"Name {leader!r} instead")

    def require_hand_joint(joint: str, key: str) -> None:
        require_leader(joint, key)
        if joint in description.arm.joints:
            raise InputError(f"{joint!r} is already an arm joint", file=description.source, key=key)

    for i, joint in enumerate(description.arm.joints):
        require_leader(joint, f"arm.joints[{i}]")
    for i, synergy in enumerate(description.hand.synergies):
        for joint in synergy.column:
            require_hand_joint(joint, f"hand.synergies[{i}].joint" + (f"s.{joint}" if synergy.joint is None else ""))
        if synergy.joint is None and synergy.label in known:
            refuse("a joint has this name", f"hand.synergies[{i}].name", "Use another one")
    for joint in description.hand.rest:
        require_hand_joint(joint, f"hand.rest.{joint}")
    require(description.arm.wrist, links, "link", "arm.wrist", description)
    for i, pad in enumerate(description.pads):
        require(pad.link, links, "link", f"pads[{i}].link", description)
    for link in description.collision.links:
        require(link, links, "link", f"collision.links.{link}", description)


def require(name: str, known: list[str], what: str, key: str, description: RobotDescription) -> None:
    """Raise an UnknownNameError unless the URDF has a joint or link of this name."""
    if name not in known:
        raise UnknownNameError(
            f"{what} {name!r} is not in {_files(description)}",
            file=description.source,
            key=key,
            remedy=close_names(name, known),
        )


def _files(description: RobotDescription) -> str:
    files = [description.urdf_file, *(files.urdf for files in description.attached_files)]
    return " or ".join(file.name for file in files)
