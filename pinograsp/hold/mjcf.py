"""The hold test of a grasp as a MuJoCo model (MJCF), in the frame of the world, complete in one text.

    hand     its first link fixed where the arm holds it; links without weight, so that the drive is the squeeze
    object   free, rigid, with the mass and the gravity that give the task's external force
    contact  between the object and the hand's pads and links alone; rigid bodies with Coulomb friction

The model's rest position is the grasp, and the drive is part of it: opened in a viewer, the hand holds the object.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Integers
from ..descriptions import robot_for
from ..descriptions.hand import PadDescription
from ..descriptions.mesh_keys import mesh_keys
from ..errors import InputError
from ..geometry.filled import center_of_mass
from ..geometry.shapes import surface_of
from ..results import Grasp, Setup
from ..verification.check import Verifier
from ..verification.kinematics import Poses
from ..verification.robot import read_robot
from .drive import Drive, coupled, numbers, servos
from .hand import HandLink, factors, hand_links
from .object_pieces import Standoff
from .objects import object_body, placed, required_mass
from .options import HoldOptions
from .pads import pad_geom, torsional_friction
from .pieces import link_pieces

OBJECT, LINK, PAD = "object", "link", "pad"
"""Names of geoms begin with these: `pad:left`, `link:palm:0`."""
TIMESTEP = 1e-3
"""s."""
_OPTIONS = {
    "timestep": f"{TIMESTEP}",
    "integrator": "implicitfast",
    "cone": "elliptic",  # pyramids creep by a millimetre a second
    "impratio": "10",
    "noslip_iterations": "10",
    "tolerance": "1e-10",
    "ccd_tolerance": "1e-9",  # with MuJoCo's own, an end of a line of contact is missed now and then
    "ccd_iterations": "200",
}
BEHIND = 2e-4
"""How far behind the face of a pad its link begins, m."""
_STIFF = {"solref": "0.004 1", "solimp": "0.95 0.99 0.001"}
_LACKING = {"pos": "0 0 0", "mass": "0.05", "diaginertia": "2e-5 2e-5 2e-5"}
"""Inertia of a link for which the URDF gives none: without effect at rest."""
_PAD_INERTIA = 0.5
"""Of a pad on springs, kg: MuJoCo's contacts give way the more the lighter the bodies are, and the springs should."""
_FIRM = {"solimp": "0.99 0.999 0.001"}
"""Contact of pads on springs."""


@dataclass(frozen=True)
class HoldModel:
    """The model of one grasp."""

    xml: str
    """MJCF."""
    gravity: Array
    """Acceleration of the object by the task's external force, m/s^2, shape (3,)."""
    torque: Array
    """External torque of the task on the object, world, N m, shape (3,)."""
    inertia: Array
    """Of the object about its centre of mass, world, kg m^2, shape (3, 3)."""
    slack: Array
    """Controls of the actuators with which the hand does not squeeze; with 0 it does as planned."""
    yields: bool
    """Whether joints and pads are springs, which give way under the weight."""


class HandAndObject:
    """Builds the models of all grasps of one robot at one task.

    Args:
        setup: robot, scene and task.
        options: which drive, how much friction.

    Raises:
        InputError: a file of the robot is missing or cannot be read, the hold test knows no object of this shape, the
            object has neither mass nor weight, or a driver torque is wanted of a hand with several drivers.
    """

    def __init__(self, setup: Setup, options: HoldOptions) -> None:
        self._robot = robot_for(setup.robot, setup.scene, setup.task)
        read = read_robot(setup.robot)
        self._kinematics = read.kinematics.mounted(setup.scene.mounting.matrix)
        with mesh_keys(setup.scene):
            self._verifier = Verifier(setup.robot, setup.scene, setup.task)
        self._meshes, self._urdf = read.meshes, read.urdf
        self._links = hand_links(read.urdf, self._robot)
        self._task = setup.scene.task(setup.task)
        self._object = setup.scene.objects[self._task.object]
        self._mass = required_mass(setup.scene, self._task)
        self._wrench = setup.scene.wrench_of(self._task)
        with mesh_keys(setup.scene):
            self._body = object_body(self._task.object, self._object.shape)
        self._friction = self._task.contact.friction if options.friction is None else options.friction
        one = len(self._robot.hand.synergies) == 1
        if options.control == "torque" and not one:
            raise InputError("a hand of several synergies has no single driver", key="options.control")
        self._servos = options.control == "position" or not one

    @cached_property
    def _pieces(self) -> dict[str, list[Array]]:
        # Pads on springs give way, and the link must not touch then.
        yielding = self._task.contact.max_force / self._robot.stiffness.contact if self._servos else 0.0
        return link_pieces(self._urdf, self._robot, self.links, self._robot.pads, BEHIND + 2.0 * yielding)

    @property
    def links(self) -> tuple[str, ...]:
        """Names of the hand's links."""
        return tuple(link.name for link in self._links)

    @cached_property
    def _standoff(self) -> Standoff:
        return Standoff(surface_of(self._object.shape).tessellation().corners, self._body.pieces)

    def standoff(self, grasp: Grasp) -> float:
        """Return how far the convex pieces of the object stand off what pads touch, m; 0 where there are none."""
        if not self._body.pieces:
            return 0.0
        T = self._object.pose.matrix
        depths = {pad.name: pad.rubber_depth for pad in self._robot.pads}
        contacts = ((T[:3, :3].T @ (c.point - T[:3, 3]), T[:3, :3].T @ c.normal, depths[c.pad]) for c in grasp.contacts)
        return max(self._standoff.at(*contact) for contact in contacts)

    def model(self, grasp: Grasp, *, shown: bool = False) -> HoldModel:
        """Return the model of a grasp.

        Args:
            grasp: of the setup.
            shown: whether it has the links' meshes besides what touches, which only viewers need.
        """
        poses = self._kinematics.poses(grasp.joints)
        gravity = np.array(self._wrench.force) / self._mass
        root = ET.Element("mujoco", model="hold")
        ET.SubElement(root, "compiler", angle="radian", boundmass="0.001", boundinertia="1e-6", balanceinertia="true")
        option = ET.SubElement(root, "option", _OPTIONS, gravity=numbers(gravity))
        ET.SubElement(option, "flag", autoreset="disable")  # what diverges must not begin anew
        pose = self._object.pose.matrix
        _surroundings(root, pose[:3, 3])
        world, assets = ET.SubElement(root, "worldbody"), ET.SubElement(root, "asset")
        ET.SubElement(assets, "texture", _SKY)
        ET.SubElement(world, "light", pos=numbers(pose[:3, 3] + [0.3, -0.4, 0.8]), dir="-0.3 0.4 -0.8")
        drive = self._drive(grasp)
        self._add_hand(world, assets, poses, drive, shown)
        self._add_object(world, assets, pose)
        root.extend(drive.elements)
        R = pose[:3, :3]
        return HoldModel(
            xml=ET.tostring(root, encoding="unicode"),
            gravity=gravity,
            torque=np.array(self._wrench.torque),
            inertia=self._mass * R @ self._body.inertia @ R.T,
            slack=np.array(drive.slack),
            yields=self._servos,
        )

    def _drive(self, grasp: Grasp) -> Drive:
        if self._servos:
            return servos(grasp, self._links, self._robot.stiffness.joint)
        moved = factors(self._robot, self._urdf)
        per_synergy = float(self._verifier.drive_torques(grasp.claim)[0])
        return coupled(grasp, moved, per_synergy / self._robot.hand.synergies[0].column[next(iter(moved))])

    def _add_hand(self, world: ET.Element, assets: ET.Element, poses: Poses, drive: Drive, shown: bool) -> None:
        bodies: dict[str | None, ET.Element] = {None: world}
        for link in self._links:
            T = poses[link.name] if link.parent is None else np.linalg.inv(poses[link.parent]) @ poses[link.name]
            body = ET.SubElement(bodies[link.parent], "body", placed(T), name=link.name, gravcomp="1")
            bodies[link.name] = body
            _add_inertia(body, link)
            if link.joint is not None and link.joint.name in drive.joints:
                kind, angle = "slide" if link.joint.slides else "hinge", drive.joints[link.joint.name]
                attributes = {"axis": numbers(link.joint.axis), "ref": numbers([angle])} | drive.of(link.joint.slides)
                ET.SubElement(body, "joint", attributes, name=link.joint.name, type=kind)
            for k, vertices in enumerate(self._pieces[link.name]):
                _add_mesh(body, assets, f"{LINK}:{link.name}:{k}", vertices, self._touching(), shown=not shown)
            if shown and link.name in self._meshes:
                mesh = self._meshes[link.name]
                _add_mesh(body, assets, f"shown:{link.name}", mesh.vertices, _UNTOUCHED, faces=mesh.faces)
        for pad in self._robot.pads:
            self._add_pad(bodies[pad.link], pad)

    def _touching(self) -> dict[str, str]:
        """Return the attributes of what touches the object and nothing else."""
        friction = f"{self._friction!r} 0 0"
        return {"contype": "1", "conaffinity": "2", "condim": "3", "friction": friction, "priority": "1"} | _STIFF

    def _add_pad(self, body: ET.Element, pad: PadDescription) -> None:
        solid, T = pad_geom(pad), np.eye(4)
        T[:3, :3], T[:3, 3] = pad.patch.rotation, pad.patch.origin
        if self._servos:
            # Structural compliance (3.1): the pad gives along each axis of its frame.
            body = ET.SubElement(body, "body", placed(T), name=f"pad of {pad.link}: {pad.name}", gravcomp="1")
            inertia = numbers([1e-6] * 3)
            ET.SubElement(body, "inertial", pos="0 0 0", mass="0.001", diaginertia=inertia)
            stiffness = self._robot.stiffness.contact
            damping = 2.0 * float(np.sqrt(stiffness * _PAD_INERTIA))
            spring = {"type": "slide", "stiffness": f"{stiffness!r}", "damping": f"{damping!r}"}
            spring["armature"] = f"{_PAD_INERTIA}"
            for axis in np.eye(3):
                ET.SubElement(body, "joint", spring, axis=numbers(axis))
            T = np.eye(4)
        P = np.eye(4)
        P[:3, :3], P[:3, 3] = solid.rotation, solid.center
        torsion = torsional_friction(pad, self._friction)
        attributes = self._touching() | {"condim": "4", "friction": f"{self._friction!r} {torsion!r} 0", "mass": "0"}
        attributes |= _FIRM if self._servos else {}
        name, colour = f"{PAD}:{pad.name}", "0.15 0.15 0.17 1"
        ET.SubElement(
            body, "geom", attributes | placed(T @ P), name=name, type=solid.kind, size=numbers(solid.size), rgba=colour
        )

    def _add_object(self, world: ET.Element, assets: ET.Element, pose: Array) -> None:
        body = ET.SubElement(world, "body", placed(pose), name=OBJECT)
        ET.SubElement(body, "freejoint", name=OBJECT)
        _add_inertial(body, center_of_mass(self._object), self._mass, self._mass * self._body.inertia)
        touching = {"contype": "2", "conaffinity": "1", "rgba": "0.85 0.45 0.15 1"}
        for k, geom in enumerate(self._body.geoms):
            ET.SubElement(body, "geom", geom | touching, name=f"{OBJECT}:{k}")
        for k, vertices in enumerate(self._body.pieces, len(self._body.geoms)):
            _add_mesh(body, assets, f"{OBJECT}:{k}", vertices, touching)


_SKY = {
    "type": "skybox",
    "builtin": "gradient",
    "rgb1": "1 1 1",
    "rgb2": "0.75 0.8 0.87",
    "width": "64",
    "height": "64",
}
_UNTOUCHED = {"contype": "0", "conaffinity": "0", "mass": "0", "rgba": "0.55 0.57 0.62 1"}


def _add_mesh(
    body: ET.Element,
    assets: ET.Element,
    name: str,
    vertices: Array,
    attributes: dict[str, str],
    faces: Integers | None = None,
    shown: bool = True,
) -> None:
    # The links' inertias are given; MuJoCo would refuse to compute those of flat meshes that are no shells.
    mesh = {"name": name, "vertex": numbers(vertices.ravel(), 7), "inertia": "shell"}
    if faces is not None:
        mesh["face"] = " ".join(map(str, faces.ravel().tolist()))
    ET.SubElement(assets, "mesh", mesh)
    ET.SubElement(body, "geom", attributes, name=name, type="mesh", mesh=name, group="2" if shown else "3")


def _add_inertia(body: ET.Element, link: HandLink) -> None:
    if link.inertia is None:
        ET.SubElement(body, "inertial", _LACKING)
    else:
        _add_inertial(body, link.inertia.center, link.inertia.mass, link.inertia.matrix)


def _add_inertial(body: ET.Element, center: Sequence[float] | Array, mass: float, inertia: Array) -> None:
    I = inertia  # noqa: E741
    full = numbers([I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]])
    ET.SubElement(body, "inertial", pos=numbers(center), mass=f"{mass!r}", fullinertia=full)


def _surroundings(root: ET.Element, center: Array) -> None:
    """Add where a viewer looks, and its light."""
    ET.SubElement(root, "statistic", center=numbers(center), extent="0.25")
    visual = ET.SubElement(root, "visual")
    ET.SubElement(visual, "headlight", ambient="0.4 0.4 0.4", diffuse="0.5 0.5 0.5")
    ET.SubElement(visual, "global", offwidth="960", offheight="720")
