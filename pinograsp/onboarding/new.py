"""The first robot file of a robot, from its URDF or from those of an arm and a hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from ..arrays import Numbers
from ..descriptions.composition import Attachment, Composition
from ..descriptions.pose import ZERO
from ..descriptions.urdf import RobotUrdf, attached, read_urdf
from ..descriptions.values import FileName
from ..errors import InputError, require_report
from ..kinematics.tree import UrdfTree
from ..progress import Report, no_report
from .addresses import address_of, find_urdf, loose_joints, needed_packages
from .chain import last_link
from .draft import Draft, draft_of
from .parts import parts_of
from .robot_file import robot_file, srdf_beside


@dataclass(frozen=True)
class HandMount:
    """A hand with a URDF of its own, and where it sits."""

    urdf: str | Path
    """Path or `package://` address of its URDF."""
    to: str | None = None
    """Link of the arm; its last one if not given."""
    root: str | None = None
    """Link of the hand's URDF with which the hand begins."""
    position: Numbers = ZERO
    """Of its root on that link, m."""
    rpy: Numbers = ZERO
    """Roll, pitch and yaw of its root on that link, rad."""
    prefix: str = ""
    """Put before every name of its links and joints."""


def new_robot_file(
    urdf: str | Path,
    output: str | Path,
    *,
    hand: HandMount | None = None,
    tip: str | None = None,
    packages: Sequence[str | Path] = (),
    use_visual: bool = False,
    progress: Report = no_report,
) -> Draft:
    """Return the draft of a first robot file; nothing is written.

    Args:
        urdf: path or `package://` address of the robot's URDF, or the arm's.
        output: where the file is going to be: addresses are relative to it.
        hand: a hand of its own.
        tip: a link of the body that carries the hand, where there are several.
        packages: folders in which `package://` is looked up, or `name=folder` for the folder of one package.
        use_visual: whether links without collision geometry collide as they are shown.
        progress: called as the `flat faces of links` are searched for pads.

    Raises:
        InputError: a file or mesh is missing, a name is unknown, or arm and hand cannot be told apart.
    """
    require_report(progress)
    output, folders = Path(output), list(packages)
    files = [find_urdf(str(urdf), folders, "urdf")]
    files += [] if hand is None else [find_urdf(str(hand.urdf), folders, "hand.urdf")]
    composition = Composition(
        format=1,
        urdf=address_of(files[0], output),
        packages=needed_packages(files, folders, output),
        hold=loose_joints(files[0]),
        use_visual=use_visual,
        source=output,
        digest="",
    )
    composed = read_urdf(composition)
    if hand is not None:
        file = composition.urdf_file
        to = last_link(UrdfTree(composed, file), file) if hand.to is None else hand.to
        composition = _with_hand(composition, hand, to, files[1], output)
        composed = _attached(composed, composition)
    found = parts_of(composition, composed, tip, progress)
    srdf = srdf_beside(files[0])
    name = _name_of(output)
    return draft_of(found, robot_file(found, name, None if srdf is None else address_of(srdf, output)))


def _attached(arm: RobotUrdf, composition: Composition) -> RobotUrdf:
    """Attach the hand; errors about keys of the robot file, which is not there yet, become those about `hand`."""
    try:
        return attached(arm, composition, 0)
    except InputError as error:
        if not (error.key or "").startswith("attach[0]."):
            raise
        key = str(error.key).replace("attach[0]", "hand")
        raise type(error)(error.problem, key=key, remedy=error.remedy) from None


def _with_hand(arm: Composition, hand: HandMount, to: str, file: Path, output: Path) -> Composition:
    part = Attachment(
        urdf=address_of(file, output),
        root=hand.root,
        to=to,
        prefix=hand.prefix,
        position=hand.position,
        rpy=hand.rpy,
        hold=loose_joints(file, hand.root),
        use_visual=arm.use_visual,
    )
    return arm.model_copy(update={"attach": (part,)})


def _name_of(output: Path) -> str:
    """Return the name of the folder of a robot file, as the name of the robot.

    Raises:
        InputError: it cannot be part of the names of files.
    """
    name = output.resolve().parent.name or "robot"
    try:
        return TypeAdapter(FileName).validate_python(name)
    except ValidationError as error:
        problem = f"the folder's name, {name!r}, becomes the robot's: {error.errors()[0]['msg']}"
        raise InputError(problem, key="output", remedy="Take another folder") from None
