"""Whether a grasp holds in spite of one set of errors.

The arm stands at its joints plus their error, the object at its pose plus its error, and the hand closes (`closing`).
What comes of it is judged by the independent verification, at the object's final pose:

    contact      pads and object touch and are tangent, on the pads, as a certificate has it
    clearance    nothing but pads touches the object, and the robot neither walls, obstacles nor itself: distances are
                 above zero. Margins are not asked for any more: errors are what they are there for
    balance      some contact forces within friction and spin limits (of hands of several drivers f_max, too) balance
                 the load at the planned squeeze

The load is the task's wrench times the factor of the weight, at the centre of mass where it really is. The drivers
keep the torque that they have in the planned grasp, tau = S^T sum_i J_i^T f_i: planned forces go along with their pads
and are scaled until |tau| is that of the plan (of several drivers the combination that is kept turns with the pads).
What is left of every inequality of the balance is the margin, in N: negative if the object slips, -inf if there is no
contact or if no forces balance the load however large they are, inf if friction locks the fingers.

Joint limits, reserves and the directions of approach are not asked for. A footprint that leaves the allowed part of
the surface is counted, and holds all the same.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..descriptions import robot_for
from ..descriptions.pose import Pose
from ..geometry.filled import center_of_mass
from ..geometry.shapes import surface_of
from ..kinematics.robot import Robot
from ..results import Grasp
from ..verification import Certificate, Claim
from ..verification.balance import BalanceProblem
from ..verification.check import Verifier, hold
from .closing import Closed, Closing, moved
from .errors import Draw
from .verdict import COLLIDES, LOST, OFF_PAD, PENETRATES, SLIPS, TOUCHES, Verdict

BALANCED = 1e-6
"""How much a margin may be below zero for the tolerance of the cone solver, N."""
NO_FRICTION = 1e-9
"""Coefficient that stands for none, which a task cannot have."""
_CLEARANCES = ("enclosure clearance", "obstacle clearance", "self clearance", "self collision")


class Judge:
    """Judges one grasp, whatever the errors.

    Args:
        grasp: of a result.

    Raises:
        InputError: it belongs to no result, or a file of its robot is missing or cannot be read.
    """

    def __init__(self, grasp: Grasp) -> None:
        self.grasp, self.setup = grasp, grasp.required_setup
        robot, scene = self.setup.robot, self.setup.scene
        self.task = scene.task(self.setup.task)
        self.body = scene.objects[self.task.object]
        self._pads = robot_for(robot, scene, self.setup.task).pads
        mount = scene.mounting.matrix
        self._robot = Robot(robot).with_pads(tuple(pad.name for pad in self._pads)).mounted(mount)
        self.T_world_object = self.body.pose.matrix
        self.wrench = scene.wrench_of(self.task).vector
        """External, force and torque about the centre of mass, world, N and N m, shape (6,)."""
        hand = np.concatenate([grasp.synergy, grasp.contact_parameters])
        surface = surface_of(self.body.shape)
        self.closing = Closing(self._robot, surface, grasp.q_arm, hand, self.T_world_object)
        self._as_planned = Verifier(robot, scene, self.setup.task)
        self._tau = float(np.linalg.norm(self._as_planned.drive_torques(grasp.claim)))

    @property
    def no_errors(self) -> Draw:
        """Errors of size zero."""
        return Draw.none(self.task.contact.friction, len(self.grasp.q_arm))

    def verdict(self, draw: Draw) -> Verdict:
        """Return the effect of a set of errors on the grasp."""
        closed = self._closed(draw)
        if closed.left:
            return Verdict(OFF_PAD, "", -math.inf, False)
        claim, verifier = self._claim(closed), self._verifier(closed.T_world_object, draw)
        certificate = verifier.check(claim)
        cause, where = _no_contact(certificate)
        if cause is not None:
            return Verdict(cause, where, -math.inf, False)
        margin = self._margin(hold(verifier, claim).problem, draw.weight)
        cause, where = _touching(certificate)
        if cause is None and margin < -BALANCED:
            cause = SLIPS
        regions = [figure for figure in certificate.figures if figure.name == "contact region"]
        return Verdict(cause, where, margin, any(not figure.holds for figure in regions))

    def balances(self, draw: Draw) -> bool:
        """Return whether the contacts balance the load, whether or not pads bear and links are clear."""
        return self._margin(self._problem(draw), draw.weight) >= -BALANCED

    def growth(self, directions: Array) -> Array:
        """Return by how much of each wrench the load may grow if there are no errors, shape (directions,).

        Args:
            directions: force and torque about the centre of mass, N and N m, not zero, shape (directions, 6).
        """
        return np.nan_to_num(self._problem(self.no_errors).multiples(self.wrench, directions))

    def _problem(self, draw: Draw) -> BalanceProblem:
        closed = self._closed(draw)
        return hold(self._verifier(closed.T_world_object, draw), self._claim(closed)).problem

    def _margin(self, problem: BalanceProblem, weight: float) -> float:
        margin = problem.margin(weight * self.wrench)
        return -math.inf if math.isnan(margin) else margin

    def _closed(self, draw: Draw) -> Closed:
        T, _ = moved(self.T_world_object, draw.position, draw.orientation)
        return self.closing.closed(self.grasp.q_arm + draw.joints, T)

    def _claim(self, closed: Closed) -> Claim:
        """Return the claim that the verification judges: planned forces moved with the pads, at the planned squeeze."""
        planned = self.grasp.claim
        turned = closed.rotations @ self.closing.planned.rotations.transpose(0, 2, 1)
        forces = np.einsum("nij,nj->ni", turned, planned.forces)
        joints = self._robot.joints_by_name(closed.posture)
        claim = Claim(joints, closed.points, forces, planned.spin_torques)
        tau = float(np.linalg.norm(self._as_planned.drive_torques(claim)))
        share = self._tau / tau if tau > 0.0 else 1.0
        return replace(claim, forces=share * forces, spin_torques=share * planned.spin_torques)

    def _verifier(self, T_world_object: Array, draw: Draw) -> Verifier:
        """Return the verifier of the scene as it is with these errors."""
        scene, name = self.setup.scene, self.setup.task
        center = tuple((center_of_mass(self.body) + draw.center_of_mass).tolist())
        body = self.body.model_copy(update={"pose": Pose.of(T_world_object), "center_of_mass": center})
        contact = self.task.contact.model_copy(update={"friction": max(draw.friction, NO_FRICTION)})
        task = self.task.model_copy(update={"contact": contact, "withstand": None})
        changed = scene.with_object(self.task.object, body).with_task(name, task)
        return Verifier(self.setup.robot, changed, name)


def _no_contact(certificate: Certificate) -> tuple[str | None, str]:
    """Return whether contact is lost, and at which pad."""
    for cause, name in ((LOST, "contact gap"), (LOST, "pad tangency"), (OFF_PAD, "contact on pad")):
        if not certificate[name].holds:
            return cause, certificate[name].where
    return None, ""


def _touching(certificate: Certificate) -> tuple[str | None, str]:
    """Return whether the robot touches what it must not, and what touches what."""
    for figure in certificate.figures:
        if figure.name == "pad clearance" and not figure.holds:
            return PENETRATES, figure.where
        if figure.name == "object clearance" and not figure.value > 0.0:
            return TOUCHES, figure.where
        if figure.name in _CLEARANCES and not figure.value > 0.0:
            return COLLIDES, figure.where
    return None, ""
