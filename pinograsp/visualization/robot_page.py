"""The page of a robot file: the robot with joint sliders, its pads, and what a check says of it."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import zip_longest
from pathlib import Path
from typing import Protocol

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..descriptions.patches import PlanePatch
from ..disk import as_path, write_whole
from ..errors import require_kind
from ..kinematics.forward import forward
from ..kinematics.robot import Robot
from ..words import number_of
from . import camera, colors
from .pads import draw_pad
from .page import legend, page, view_button
from .robot import draw_urdf
from .sliders import Nodes, sliders
from .symbols import Look, arrow, draw
from .viewer import Recorder, Visualizer, clear_backdrop

ROOT = "robot_file"
"""Node of the viewer's tree that holds the world."""
WRIST_ARROW = 0.08
"""How far the arrow along the wrist's z axis goes beyond the pads, m."""
HAND_RADIUS = 0.1
"""Radius around the pads that the view of the hand shows, m."""
WRIST_RADIUS = 0.0015
REST = 0.1
"""How far links reach beyond joints and pads, about, m."""
_SEEN_FROM = np.array([1.0, -1.0, 0.6])


class Remark(Protocol):
    """One line of the panel, such as a `Finding`."""

    @property
    def level(self) -> str:
        """The level: ok, doubtful or wrong."""

    @property
    def what(self) -> str:
        """The remark."""

    @property
    def remedy(self) -> str:
        """Words on how to mend it; may be empty."""


class FlatFace(Protocol):
    """A flat face to be shown, such as a `Face`; link frame."""

    @property
    def link(self) -> str:
        """Name of the link."""

    @property
    def origin(self) -> Array:
        """Middle, m, shape (3,)."""

    @property
    def axes(self) -> Array:
        """Rotation, shape (3, 3); columns x and y along the sides, outward normal."""

    @property
    def sides(self) -> Array:
        """Along x and y, m, shape (2,)."""

    @property
    def pad(self) -> str:
        """YAML of a pad there."""


def write_robot_html(
    robot: Robot, file: Path | str, remarks: Sequence[Remark] = (), faces: Sequence[FlatFace] = ()
) -> None:
    """Write a robot as one HTML file: the picture, to turn with the mouse, beside joint sliders and remarks.

    The file is complete or not there; an older one is replaced. Links without visual geometry, or whose meshes for show
    cannot be drawn, are drawn as they collide.

    Args:
        robot: from `load_robot`, or of a `RobotReport`.
        file: where to write.
        remarks: the findings of a `RobotReport`.
        faces: those of a `RobotReport`, to be drawn and listed.

    Raises:
        InputError: the file cannot be written.
    """
    require_kind("robot", robot, Robot, remedy="Make it with `load_robot`")
    recorder = Recorder()
    world = Visualizer(window=recorder)[ROOT]
    posture = 0.5 * (robot.lower + robot.upper)
    nodes, views = _draw(world, robot, posture, faces)
    absolute = {f"/meshcat/{ROOT}/{path}": node for path, node in nodes.items()}
    panel = (
        f"<h1>{escape(robot.description.name)}</h1>",
        f"<p>{escape(robot.description.description)}</p>",
        "".join(view_button(name, label) for name, label in (("robot", "Whole robot"), ("hand", "Hand"))),
        sliders(robot, posture, absolute),
        legend(colors.PAD_LEGEND),
        _remarks(remarks),
        _faces(faces),
    )
    write_whole(as_path("file", file), page(robot.description.name, "\n".join(panel), recorder.commands, views))


def _draw(
    world: Visualizer, robot: Robot, posture: Array, faces: Sequence[FlatFace]
) -> tuple[Nodes, dict[str, camera.View]]:
    """Draw robot, pads, faces and wrist; return what moves with the joints, and the views of the page."""
    joints = dict(zip(robot.joint_names, robot.joint_positions(posture).tolist(), strict=True))
    drawn = draw_urdf(world, robot.urdf.composed, robot.description, joints, np.eye(4))
    configuration = forward(robot, robot.model.createData(), posture)
    poses = [pose(R, p) for R, p in zip(configuration.rotations, configuration.translations, strict=True)]
    nodes: Nodes = {}
    for path, (name, T) in drawn.items():
        nodes[path] = (robot.model.getJointId(name) if name in robot.joint_names else 0, T)
    marks = []
    for number, pad in enumerate(robot.pads):
        draw_pad(world[f"pads/{number}"], pad.patch)
        marks.append((f"pads/{number}", pad.joint, pose(pad.rotation, pad.translation)))
    for number, face in enumerate(faces):
        frame = robot.model.frames[robot.model.getFrameId(face.link, pin.BODY)]
        draw_pad(world[f"faces/{number}"], _patch(face), colors.of_number(number))
        local = frame.placement.homogeneous @ pose(face.axes, face.origin)
        marks.append((f"faces/{number}", int(frame.parentJoint), local))
    for path, joint, local in marks:
        nodes[path] = (joint, local)
        world[path].set_transform(poses[joint] @ local)
    frame = robot.model.frames[robot.wrist_frame]
    nodes["wrist"] = (int(frame.parentJoint), frame.placement.homogeneous)
    wrist = poses[frame.parentJoint] @ frame.placement.homogeneous
    places = np.array([poses[joint] @ local for _, joint, local in marks] or [wrist])
    beyond = float(((places[:, :3, 3] - wrist[:3, 3]) @ wrist[:3, 2]).max())
    tip = np.array([0.0, 0.0, max(beyond, 0.0) + WRIST_ARROW])
    for name, piece in arrow(np.zeros(3), tip, WRIST_RADIUS).items():
        draw(world["wrist"][name], piece, Look(colors.APPROACH))
    world["wrist"].set_transform(wrist)
    clear_backdrop(world)
    first = places[0, :3, 2] if robot.pads else wrist[:3, 0]
    views = _views(np.array([place[:3, 3] for place in poses]), places[:, :3, 3], first, wrist)
    camera.place(world, views["robot"])
    return nodes, views


def _patch(face: FlatFace) -> PlanePatch:
    """Return a face in its own frame."""
    (u, v) = (0.5 * face.sides).tolist()
    origin, z, x = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
    return PlanePatch(type="plane", origin=origin, normal=z, x_axis=x, u=(-u, u), v=(-v, v))


def pose(rotation: Array, translation: Array) -> Array:
    """Return a rotation, shape (3, 3), and a translation, shape (3,), as a pose, shape (4, 4)."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation, translation
    return T


def _views(joints: Array, places: Array, normal: Array, wrist: Array) -> dict[str, camera.View]:
    """Return views of the whole robot and of its hand.

    Args:
        joints: places, shape (n, 3).
        places: of pads and of faces, shape (m, 3).
        normal: of the first pad; without pads, another direction across the hand, shape (3,).
        wrist: pose, shape (4, 4).
    """
    points, middle = np.concatenate([joints, places]), places.mean(axis=0)
    # The first pad is seen askew, from beyond the finger tips.
    across = np.cross(normal, wrist[:3, 2]) + 0.7 * normal + 0.3 * wrist[:3, 2]
    return {
        "robot": camera.around(points.min(axis=0) - REST, points.max(axis=0) + REST, _SEEN_FROM),
        "hand": camera.around(middle - HAND_RADIUS, middle + HAND_RADIUS, across),
    }


def _remarks(remarks: Sequence[Remark]) -> str:
    """Return a table of what is wrong and doubtful, advice that remarks share below the last of them, and of the rest.

    Args:
        remarks: the worst first.
    """
    rows: dict[bool, list[str]] = {True: [], False: []}
    for remark, after in zip_longest(remarks, remarks[1:]):
        style = {"wrong": "fails", "doubtful": "doubtful"}.get(remark.level, "")
        same = after is not None and (after.level, after.remedy) == (remark.level, remark.remedy)
        remedy = f"<small>{escape(remark.remedy)}</small>" if remark.remedy and not same else ""
        rows[remark.level == "ok"].append(
            f'<tr class="{style}"><td>{remark.level}</td><td class="text">{escape(remark.what)}{remedy}</td></tr>'
        )
    caption, fine = "<caption>Check of the robot file</caption>", number_of(len(rows[True]), "thing")
    found = f"<table>{caption}{''.join(rows[False])}</table>"
    more = f"<details><summary>ok: {fine} looked at</summary><table>{''.join(rows[True])}</table></details>"
    return found + more if rows[True] else found


def _faces(faces: Sequence[FlatFace]) -> str:
    """Return a list of faces by their colours, each with the pad that a robot file would have there."""
    if not faces:
        return ""
    rows = []
    for number, face in enumerate(faces):
        swatch = f'<span style="color: {colors.css(colors.of_number(number))}">&#9632;</span>'
        size = " &times; ".join(f"{1e3 * side:.1f}" for side in face.sides)
        summary = f"<summary>{swatch}&nbsp;{number + 1} {escape(face.link)}, {size} mm</summary>"
        rows.append(f"<details>{summary}<pre>{escape(face.pad)}</pre></details>")
    return f"<table><caption>Flat faces of the hand, each as a pad</caption></table>{''.join(rows)}"
