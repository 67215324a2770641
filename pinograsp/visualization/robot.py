"""The robot as it is shown, at the grasp's joint angles."""

from __future__ import annotations

import copy
import math
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Set
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..descriptions import RobotDescription
from ..descriptions.urdf import RobotUrdf, read_urdf
from ..errors import InputError
from ..kinematics.shown_geometry import shown_of
from ..verification.robot import read_robot
from . import colors
from .symbols import Look, Piece, draw
from .viewer import Visualizer, geometry


def draw_robot(
    viewer: Visualizer,
    robot: RobotDescription,
    joints: Mapping[str, float],
    mounting: Array,
    marked: Set[str] = frozenset(),
) -> None:
    """Draw the robot below the node `robot`.

    Args:
        viewer: node of the viewer that holds the world.
        robot: the robot file.
        joints: every movable joint of the URDF by name, rad (m).
        mounting: pose of the robot's root link in the world, shape (4, 4).
        marked: links that offend.

    Raises:
        InputError: a mesh is missing or unreadable, or a joint has no angle.
    """
    draw_urdf(viewer, read_urdf(robot), robot, joints, mounting)
    if marked:
        _draw_marked(viewer["offenders"], robot, joints, mounting, marked)


def _draw_marked(
    viewer: Visualizer, robot: RobotDescription, joints: Mapping[str, float], mounting: Array, marked: Set[str]
) -> None:
    """Draw the collision geometry of links over what is seen of them: visual meshes have colours of their own."""
    verified = read_robot(robot)
    poses = verified.kinematics.poses(joints)
    for name in sorted(marked & verified.meshes.keys()):
        mesh = verified.meshes[name]
        triangles = geometry.TriangularMeshGeometry(mesh.vertices, mesh.faces)
        look = Look(colors.OFFENDER, 0.75, colors.OBJECT_LAYER)
        draw(viewer[name], Piece(triangles, mounting @ poses[name]), look)


def draw_urdf(
    viewer: Visualizer,
    urdf: RobotUrdf,
    robot: RobotDescription,
    joints: Mapping[str, float],
    mounting: Array,
) -> dict[str, tuple[str, Array]]:
    """Draw what is shown of a URDF made from a robot file below the node `robot`.

    Arguments and errors as for `draw_robot`.

    Returns:
        For every node what it is fixed to, a joint or `universe`, and its pose there with its scale, shape (4, 4).
    """
    from pinocchio.visualize import MeshcatVisualizer

    file = robot.urdf_file
    loader = coal.CachedMeshLoader()
    xml = _shown(urdf, file, loader)
    try:
        model = pin.buildModelFromXML(xml)
        visuals = pin.buildGeomFromUrdfString(model, xml, pin.GeometryType.VISUAL, mesh_loader=loader)
    except (ValueError, RuntimeError) as error:
        raise InputError(f"cannot be drawn: {error}", file=file) from None
    q = configuration(model, joints, robot)
    painter = MeshcatVisualizer(model, None, visuals)
    painter.initViewer(viewer)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", UserWarning)  # how Pinocchio says that it leaves a mesh out
        try:
            painter.loadViewerModel("robot")
        except UserWarning as problem:
            raise InputError(f"cannot be drawn: {problem}", file=file) from None
    painter.display(q)
    viewer["robot"].set_transform(mounting)
    return {
        painter.getViewerNodeName(item, pin.GeometryType.VISUAL): (
            model.names[item.parentJoint],
            item.placement.homogeneous @ np.diag([*item.meshScale, 1.0]),
        )
        for item in visuals.geometryObjects
    }


def _shown(urdf: RobotUrdf, file: Path, loader: coal.CachedMeshLoader) -> str:
    """Return the URDF with what is shown of every link as its visual geometry."""
    tree = copy.deepcopy(urdf.tree)
    for link in tree.findall("link"):
        elements = shown_of(link, file, loader).elements
        for element in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(element)
        for element in elements:
            element.tag = "visual"
        link.extend(elements)
    return ET.tostring(tree, encoding="unicode")


def configuration(model: pin.Model, joints: Mapping[str, float], robot: RobotDescription) -> Array:
    """Return Pinocchio's configuration, shape (nq,): (cos, sin) for a continuous joint, else the value.

    Raises:
        InputError: a joint has no angle.
    """
    q = pin.neutral(model)
    for name, joint in zip(model.names[1:], model.joints[1:], strict=True):
        if name not in joints:
            raise InputError(f"the grasp has no angle for the joint {name!r}", file=robot.source)
        angle = joints[name]
        q[joint.idx_q : joint.idx_q + joint.nq] = (math.cos(angle), math.sin(angle)) if joint.nq == 2 else angle
    return np.asarray(q)
