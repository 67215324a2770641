"""The page of a robot file: the robot with joint sliders, its pads, and what a check says of it."""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Protocol

import numpy as np

from ..arrays import Array
from ..descriptions.urdf import RobotUrdf
from ..disk import as_path, write_whole
from ..errors import require_kind
from ..kinematics.forward import forward
from ..kinematics.robot import Robot
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


def write_robot_html(robot: Robot, file: Path | str, remarks: Sequence[Remark] = ()) -> None:
    """Write a robot as one HTML file: the picture, to turn with the mouse, beside joint sliders and remarks.

    The file is complete or not there; an older one is replaced. Links without visual geometry, or whose meshes for show
    are not found, are drawn as they are for collisions.

    Args:
        robot: from `load_robot`, or of a `RobotReport`.
        file: where to write.
        remarks: the findings of a `RobotReport`.

    Raises:
        InputError: a mesh cannot be drawn, or the file cannot be written.
    """
    require_kind("robot", robot, Robot, remedy="Make it with `load_robot`")
    recorder = Recorder()
    world = Visualizer(window=recorder)[ROOT]
    posture = 0.5 * (robot.lower + robot.upper)
    nodes, views = _draw(world, robot, posture)
    absolute = {f"/meshcat/{ROOT}/{path}": node for path, node in nodes.items()}
    panel = (
        f"<h1>{escape(robot.description.name)}</h1>",
        f"<p>{escape(robot.description.description)}</p>",
        "".join(view_button(name, label) for name, label in (("robot", "Whole robot"), ("hand", "Hand"))),
        sliders(robot, posture, absolute),
        legend(colors.PAD_LEGEND),
        _remarks(remarks),
    )
    write_whole(as_path("file", file), page(robot.description.name, "\n".join(panel), recorder.commands, views))


def _draw(world: Visualizer, robot: Robot, posture: Array) -> tuple[Nodes, dict[str, camera.View]]:
    """Draw robot, pads and wrist; return what moves with the joints, and the views of the page."""
    joints = dict(zip(robot.joint_names, robot.joint_positions(posture).tolist(), strict=True))
    drawn = draw_urdf(world, shown(robot.urdf.composed), robot.description, joints, np.eye(4))
    configuration = forward(robot, robot.model.createData(), posture)
    poses = [pose(R, p) for R, p in zip(configuration.rotations, configuration.translations, strict=True)]
    nodes: Nodes = {}
    for path, (name, T) in drawn.items():
        nodes[path] = (robot.model.getJointId(name) if name in robot.joint_names else 0, T)
    pads = []
    for number, pad in enumerate(robot.pads):
        path, local = f"pads/{number}", pose(pad.rotation, pad.translation)
        draw_pad(world[path], pad.patch)
        nodes[path] = (pad.joint, local)
        pads.append(poses[pad.joint] @ local)
        world[path].set_transform(pads[-1])
    frame = robot.model.frames[robot.wrist_frame]
    nodes["wrist"] = (int(frame.parentJoint), frame.placement.homogeneous)
    wrist = poses[frame.parentJoint] @ frame.placement.homogeneous
    beyond = max(float((place[:3, 3] - wrist[:3, 3]) @ wrist[:3, 2]) for place in pads)
    tip = np.array([0.0, 0.0, max(beyond, 0.0) + WRIST_ARROW])
    for name, piece in arrow(np.zeros(3), tip, WRIST_RADIUS).items():
        draw(world["wrist"][name], piece, Look(colors.APPROACH))
    world["wrist"].set_transform(wrist)
    clear_backdrop(world)
    views = _views(np.array([place[:3, 3] for place in poses]), np.array(pads), wrist)
    camera.place(world, views["robot"])
    return nodes, views


def pose(rotation: Array, translation: Array) -> Array:
    """Return a rotation, shape (3, 3), and a translation, shape (3,), as a pose, shape (4, 4)."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation, translation
    return T


def shown(urdf: RobotUrdf) -> str:
    """Return the URDF with collision geometry where a link has no visual geometry, or where that is not found."""
    tree = copy.deepcopy(urdf.tree)
    for link in tree.findall("link"):
        visuals = link.findall("visual")
        meshes = [Path(mesh.get("filename", "")) for mesh in link.iterfind("visual/geometry/mesh")]
        if visuals and all(mesh.is_file() for mesh in meshes):
            continue
        for visual in visuals:
            link.remove(visual)
        for collision in link.findall("collision"):
            collision.tag = "visual"
    return ET.tostring(tree, encoding="unicode")


def _views(joints: Array, pads: Array, wrist: Array) -> dict[str, camera.View]:
    """Return views of the whole robot and of its hand.

    Args:
        joints: places, shape (n, 3).
        pads: poses, shape (m, 4, 4).
        wrist: pose, shape (4, 4).
    """
    places = pads[:, :3, 3]
    points, middle, normal = np.concatenate([joints, places]), places.mean(axis=0), pads[0, :3, 2]
    # The first pad is seen askew, from beyond the finger tips.
    across = np.cross(normal, wrist[:3, 2]) + 0.7 * normal + 0.3 * wrist[:3, 2]
    return {
        "robot": camera.around(points.min(axis=0) - REST, points.max(axis=0) + REST, _SEEN_FROM),
        "hand": camera.around(middle - HAND_RADIUS, middle + HAND_RADIUS, across),
    }


def _remarks(remarks: Sequence[Remark]) -> str:
    rows = []
    for remark in remarks:
        style = {"wrong": "fails", "doubtful": "doubtful"}.get(remark.level, "")
        remedy = f"<small>{escape(remark.remedy)}</small>" if remark.remedy else ""
        rows.append(
            f'<tr class="{style}"><td>{remark.level}</td><td class="text">{escape(remark.what)}{remedy}</td></tr>'
        )
    return f"<table><caption>Check of the robot file</caption>{''.join(rows)}</table>"
