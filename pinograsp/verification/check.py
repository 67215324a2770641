"""The verifier: a claim in, a certificate out."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from ..arrays import Array
from ..descriptions import RobotDescription, Scene, robot_for
from ..errors import InputError, TaskError, UnknownNameError, close_names, require_kind
from .certificate import Certificate, Figure, PairClearance
from .claim import Claim
from .clearance import Placed
from .clearances import Clearances
from .contacts import Pads, contact_figures, footprint_figure, footprints, known_normals, region_figure, rim_figures
from .derived import Derived
from .force_cost import force_cost
from .forces import balance_figures, force_figures
from .jacobians import manipulability_figure, rate_of_twist
from .joints import limits_figure, mimic_figure, reserve_figure
from .kinematics import Kinematics, Poses
from .preferences import approach_figure, ranges_figure
from .resistance import Hold, drive_torques, hold_of, is_graded, resistance_figures, with_resistance
from .robot import read_robot
from .shapes import PlacedShape
from .synergies import Synergies


class Described(Protocol):
    """A robot that has the content of its robot file, as a `Robot` does; nothing else of it is used."""

    @property
    def description(self) -> RobotDescription:
        """The content of the robot file."""


class Verifier:
    """Checks grasps of one robot at one task; URDF, SRDF and meshes are read once for all tasks of a robot file.

    Args:
        robot: from `load_robot`, or the content of a robot file, as the setup of a result has it.
        scene: from `load_scene`.
        task_name: a task of the scene.

    Raises:
        InputError: robot or scene is of another class.
        FileError: a file is missing or cannot be read.
        UnknownNameError: there is no such task, or a joint, link or pad that is named.
        TaskError: it asks for an acceleration without a mass.
    """

    def __init__(self, robot: RobotDescription | Described, scene: Scene, task_name: str) -> None:
        description = _description_of(robot)
        require_kind("scene", scene, Scene, remedy="Make it with `load_scene`, or in Python")
        read = read_robot(description)
        self._robot = read
        self._task = scene.task(task_name)
        self._contact_region = scene.region_of(self._task)
        self._pads = robot_for(description, scene, task_name).pads
        self._kinematics = read.kinematics.mounted(scene.mounting.matrix)
        _require_ranges_known(scene, task_name, self._kinematics, read.synergies)
        body = scene.objects[self._task.object]
        self._wrench, self._mass = scene.wrench_of(self._task).vector, scene.mass_of(self._task)
        if self._task.withstand is not None and self._mass is None:
            key, remedy = f"tasks.{task_name}.withstand", f"Give `objects.{self._task.object}.mass` in kg"
            raise TaskError("an acceleration needs a mass", file=scene.source, key=key, remedy=remedy)
        self._rates = read.synergies.rates(self._kinematics.joints)
        self._T_world_object = body.pose.matrix
        self._target = PlacedShape(self._task.object, body)
        self._center_of_mass = self._target.to_world(
            self._target.centroid if body.center_of_mass is None else np.array(body.center_of_mass)
        )
        self._radius = self._target.radius_about(self._center_of_mass)
        obstacles = [PlacedShape(name, body) for name, body in scene.bodies_besides(self._task).items()]
        self._clearances = Clearances(read, self._task, self._pads, scene.enclosure.walls, self._target, obstacles)
        self._last: tuple[Array, Array] = np.zeros((0, 3)), np.zeros((0, 3))

    def check(self, claim: Claim) -> Certificate:
        """Recompute every figure of a claim; those of its resistance only if the task says what is to be withstood.

        A claim with a number that is not finite gets figures that are all not a number.

        Raises:
            InputError: a joint is missing, or there is not one contact a pad.
        """
        self._require_complete(claim)
        if not claim.is_finite:
            return Certificate(_unknown(self._figures(self._rest())))
        return Certificate(tuple(self._figures(claim)))

    def certify(self, claim: Claim) -> Certificate:
        """Recompute every figure of a claim, those of its resistance too, whether or not the task asks for them.

        Raises:
            InputError: a joint is missing, or there is not one contact a pad.
        """
        certificate = self.check(claim)
        return certificate if is_graded(certificate) else with_resistance(certificate, self.resistance(claim))

    def resistance(self, claim: Claim) -> tuple[Figure, ...]:
        """Compute how strongly the object may be accelerated, Q_force and Q_torque in m/s^2 (see `resistance`).

        None of them if neither the object nor the weight of the task's force gives a mass. `certify` has them in every
        certificate, `check` only if the task says what is to be withstood.

        Raises:
            InputError: a joint is missing, or there is not one contact a pad.
        """
        if self._mass is None:
            return ()
        finite = claim.is_finite
        held = hold(self, claim if finite else self._rest())
        figures = resistance_figures(held, self._mass, self._task.withstand)
        return figures if finite else _unknown(figures)

    def drive_torques(self, claim: Claim) -> Array:
        """Return the torques with which the hand's drives exert the forces of a claim, S^T J^T f.

        In the order of the synergies, N m (N) per unit of each, shape (synergies,).

        Raises:
            InputError: a joint is missing, or there is not one contact a pad.
        """
        self._require_complete(claim)
        poses = self._kinematics.poses(claim.joints)
        normals = self._normals(claim.points, Pads.at(self._pads, poses))
        return drive_torques(claim, normals, self._pad_rates(poses))

    def _hold(self, claim: Claim, poses: Poses) -> Hold:
        pads = Pads.at(self._pads, poses)
        normals = self._normals(claim.points, pads)
        areas = footprints(claim.points, normals, pads, self._target)
        return hold_of(
            claim, pads, normals, areas, self._pad_rates(poses), self._task, self._center_of_mass, self._radius
        )

    def _normals(self, points: Array, pads: Pads) -> Array:
        """Return the normals of the contacts, into the object, world, shape (contacts, 3)."""
        return known_normals(self._inward(points), points, pads)

    def _inward(self, points: Array) -> Array:
        """Return the inward normals of the object at contacts, world, shape (contacts, 3); nan where it has none.

        Those of the last points are kept: who derives what a grasp reports has checked it before.
        """
        if not np.array_equal(points, self._last[0]):
            self._last = points.copy(), np.array([self._target.inward(point) for point in points])
        return self._last[1]

    def _pad_rates(self, poses: Poses) -> list[Array]:
        """Return, of each pad's link, the twist about the world's origin per unit of each synergy, (synergies, 6)."""
        return [rate_of_twist(self._kinematics.twists(pad.link, poses), self._rates) for pad in self._pads]

    def derive(self, claim: Claim) -> Derived:
        """Recompute what a grasp reports besides its certificate.

        Raises:
            InputError: a joint is missing, or there is not one contact a pad.
        """
        self._require_complete(claim)
        poses = self._kinematics.poses(claim.joints)
        pads = Pads.at(self._pads, poses)
        inward = self._inward(claim.points)
        return Derived(
            normals=-inward,
            synergies=np.array(list(self._robot.synergies.values(claim.joints).values())),
            T_world_wrist=poses[self._robot.arm.wrist],
            V=force_cost(claim, known_normals(inward, claim.points, pads), self._pads, self._task),
            T_world_pads=pads.poses,
            joint_order=self._kinematics.joint_order,
        )

    def check_posture(self, joints: Mapping[str, float]) -> Certificate:
        """Recompute the clearances of a posture to enclosure, obstacles and itself; the object does not count.

        Args:
            joints: every movable joint of the URDF by name, rad (m).
        """
        poses = self._kinematics.poses(joints)
        return Certificate(tuple(self._clearances.figures(Placed(self._robot.meshes, poses))))

    def clearances(self, joints: Mapping[str, float]) -> tuple[PairClearance, ...]:
        """Return the distances below 50 mm of a posture, pair by pair, the least first.

        Args:
            joints: every movable joint of the URDF by name, rad (m).
        """
        return self._clearances.pairs(Placed(self._robot.meshes, self._kinematics.poses(joints)))

    def _figures(self, claim: Claim) -> list[Figure]:
        poses = self._kinematics.poses(claim.joints)
        placed = Placed(self._robot.meshes, poses)
        figures = [*self._clearances.figures(placed), *self._clearances.of_object(placed), *self._statics(claim, poses)]
        figures += self._joints(claim.joints)
        arm = self._robot.arm
        figures.append(manipulability_figure(self._kinematics, poses, arm.joints, arm.wrist))
        figures += self._preferences(claim, poses)
        if self._task.withstand is not None and self._mass is not None:
            figures += resistance_figures(self._hold(claim, poses), self._mass, self._task.withstand)
        return figures

    def _joints(self, angles: Mapping[str, float]) -> list[Figure]:
        limits, joints = self._robot.limits, self._kinematics.joints
        figures = [
            limits_figure(limits, angles) if limits else None,
            reserve_figure(limits, self._robot.arm.joints, angles, self._task.reserve.joint),
            mimic_figure(joints, angles),
            self._robot.synergies.figure(angles),
        ]
        return [figure for figure in figures if figure is not None]

    def _preferences(self, claim: Claim, poses: Poses) -> list[Figure]:
        figures = []
        if self._task.approach is not None:
            pose = poses[self._robot.arm.wrist]
            figures.append(approach_figure(self._task.approach, self._T_world_object, pose, self._robot.arm.wrist))
        if self._task.intervals:
            positions = {**self._robot.synergies.values(claim.joints), **claim.joints}
            figures.append(ranges_figure(self._task.intervals, positions, self._robot.endless))
        return figures

    def _statics(self, claim: Claim, poses: Poses) -> list[Figure]:
        pads = Pads.at(self._pads, poses)
        inward = self._inward(claim.points)
        normals = known_normals(inward, claim.points, pads)
        return [
            *contact_figures(claim.points, inward, pads, self._target),
            *self._region(claim.points, normals, pads),
            *rim_figures(claim.points, pads, self._target, self._task.reserve.rim),
            *self._balance(claim, normals),
            *force_figures(claim, inward, self._pads, self._task),
        ]

    def _balance(self, claim: Claim, normals: Array) -> list[Figure]:
        balanced = self._task.balance_wrench
        turn = self._target.limits.turn
        return balance_figures(
            claim, normals, self._center_of_mass, self._radius, self._wrench, turn=turn, balanced=balanced
        )

    def _region(self, points: Array, normals: Array, pads: Pads) -> list[Figure]:
        region = self._contact_region
        if region is None:
            return []
        if self._task.contact_regions == "point":
            return [region_figure(points, region, pads, self._target)]
        areas = footprints(points, normals, pads, self._target)
        return [footprint_figure(areas, pads.rubber(points), region, pads, self._target)]

    def _rest(self) -> Claim:
        """Return a claim of zeros, which has every figure."""
        contacts = len(self._pads)
        joints = {joint.name: 0.0 for joint in self._kinematics.joints}
        return Claim(joints, np.zeros((contacts, 3)), np.zeros((contacts, 3)), np.zeros(contacts))

    def _require_complete(self, claim: Claim) -> None:
        claim.require_complete([joint.name for joint in self._kinematics.joints], len(self._pads))


def hold(verifier: Verifier, claim: Claim) -> Hold:
    """Return what wrenches the contacts of a claim balance while the hand squeezes as planned.

    Raises:
        InputError: a joint is missing, or there is not one contact a pad.
    """
    verifier._require_complete(claim)
    return verifier._hold(claim, verifier._kinematics.poses(claim.joints))


def _description_of(robot: RobotDescription | Described) -> RobotDescription:
    found = robot if isinstance(robot, RobotDescription) else getattr(robot, "description", None)
    if not isinstance(found, RobotDescription):
        problem = f"must be of class Robot or RobotDescription, not {reprlib.repr(robot)}"
        raise InputError(problem, key="robot", remedy="Make it with `load_robot`")
    return found


def _unknown(figures: Sequence[Figure]) -> tuple[Figure, ...]:
    where = "the claim holds numbers that are not finite"
    return tuple(replace(figure, value=math.nan, where=where) for figure in figures)


def _require_ranges_known(scene: Scene, task_name: str, kinematics: Kinematics, synergies: Synergies) -> None:
    """Refuse a task with ranges or locks of joints that the URDF does not have, and that are no synergies."""
    joints = {*(joint.name for joint in kinematics.joints), *synergies.names}
    for where, name, _, _ in scene.task(task_name).intervals:
        if name not in joints:
            key, remedy = f"tasks.{task_name}.{where}.{name}", close_names(name, sorted(joints))
            raise UnknownNameError(f"the URDF has no movable joint {name!r}", file=scene.source, key=key, remedy=remedy)
