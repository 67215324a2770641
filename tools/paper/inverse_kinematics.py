"""The arm for a pose of a two-pad hand, by damped least squares, as planners without optimisation do it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from pinograsp.problem import GraspProblem

STEPS = 50
DAMPING = 1e-4
LARGEST_STEP = 0.5
"""Of any joint, rad."""
DONE = 1e-8
"""Norm of the twist that may be left, m and rad."""
METRES_A_RADIAN = 0.1
"""How far a wrist may be away to count like a turn of one radian, for the choice of seeds."""


class ArmSolver:
    """Arm postures that bring a hand, closed to a width, to a pose.

    Args:
        problem: any grasp problem of the task; only its kinematics and limits are used.
        width: distance between the planes of the two pads, m.
        seeds: arm postures to begin from, rad, shape (N, l).

    Raises:
        ValueError: the hand has more than one synergy or not two pads.
    """

    def __init__(self, problem: GraspProblem, width: float, seeds: np.ndarray) -> None:
        robot = problem.model.robot
        if robot.posture_size != robot.arm_size + 1 or len(robot.pads) != 2:
            raise ValueError(f"{robot.description.name}: the simple way knows hands of two pads and one synergy only")
        self._problem, self._robot = problem, robot
        self._data = robot.model.createData()
        self._middle = 0.5 * (problem.lower + problem.upper)
        self._synergy = self._closed(width)
        hand = self._hand()
        self._T_hand_wrist = hand.inverse()
        self.reach = self._reach(hand)
        """How far the pads reach from their middle along the approach, m."""
        self._seeds = seeds
        wrists = [self._wrist(seed) for seed in seeds]
        self._positions = np.array([wrist.translation for wrist in wrists])
        self._rotations = np.array([wrist.rotation for wrist in wrists])

    def solve(self, rotation: np.ndarray, origin: np.ndarray, first_pad: int, seeds: int) -> list[np.ndarray]:
        """Return postures (q_a, sigma) with the hand at a pose, at most one for each of the nearest seeds.

        Args:
            rotation: of the hand in the world: x from one pad to the other, z the approach, shape (3, 3).
            origin: middle between the pads, world, m, shape (3,).
            first_pad: the pad from which x points away.
            seeds: number of seeds.
        """
        if first_pad == 1:  # the hand's x points away from pad 0: turn it about the approach
            rotation = rotation @ np.diag([-1.0, -1.0, 1.0])
        target = pin.SE3(rotation, origin) * self._T_hand_wrist
        nearest = np.argsort(self._distances(target))[:seeds]
        solved = (self._descend(self._seeds[i], target) for i in nearest)
        return [np.append(q, self._synergy) for q in solved if q is not None]

    def contact_parameters(self, posture: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Return q_c that brings the contact of every pad nearest to its point, world, m, shape (2, 3)."""
        size = self._robot.posture_size
        middle = self._middle[size:]
        contacts = self._problem.state(np.append(posture, middle)).contacts
        along = contacts.d_points[:, :, size:].reshape(-1, len(middle))
        return middle + np.linalg.lstsq(along, (points - contacts.points).ravel(), rcond=None)[0]

    def _descend(self, q: np.ndarray, target: Any) -> np.ndarray | None:
        """Return the arm posture with the wrist at the target, or nothing where the steps end elsewhere."""
        size = self._robot.arm_size
        lower, upper = self._robot.lower[:size], self._robot.upper[:size]
        q = q.copy()
        for _ in range(STEPS):
            twist = pin.log6(self._wrist(q).actInv(target)).vector
            if np.linalg.norm(twist) < DONE:
                return q
            J = pin.getFrameJacobian(self._robot.model, self._data, self._robot.wrist_frame, pin.LOCAL)
            J = (J @ self._robot.B)[:, :size]
            step = J.T @ np.linalg.solve(J @ J.T + DAMPING * min(1.0, float(twist @ twist)) * np.eye(6), twist)
            q = np.clip(q + step / max(1.0, float(np.abs(step).max()) / LARGEST_STEP), lower, upper)
        return None

    def _wrist(self, q: np.ndarray) -> Any:
        """Return the pose of the wrist in the world, and leave the Jacobians in the data."""
        model, data = self._robot.model, self._data
        pin.computeJointJacobians(model, data, self._robot.joint_positions(np.append(q, self._synergy)))
        return pin.updateFramePlacement(model, data, self._robot.wrist_frame).copy()

    def _closed(self, width: float) -> float:
        """Return the synergy at which the pads are a width apart, by bisection."""
        size = self._robot.arm_size
        low, high = float(self._robot.lower[size]), float(self._robot.upper[size])
        opens = self._gap(high) > self._gap(low)
        for _ in range(60):
            middle = 0.5 * (low + high)
            if (self._gap(middle) > width) == opens:
                high = middle
            else:
                low = middle
        return 0.5 * (low + high)

    def _gap(self, synergy: float) -> float:
        contacts = self._contacts(synergy)
        return float((contacts.points[1] - contacts.points[0]) @ contacts.normals[0])

    def _contacts(self, synergy: float) -> Any:
        """Return the contacts at the middle of the pads, the arm at mid-range."""
        x = self._middle.copy()
        x[self._robot.arm_size] = synergy
        return self._problem.state(x).contacts

    def _hand(self) -> Any:
        """Return the hand's pose in the wrist's frame: x from pad 0 to pad 1, z the approach, origin between them."""
        contacts = self._contacts(self._synergy)
        wrist = self._wrist(self._middle[: self._robot.arm_size])
        jaw = wrist.rotation.T @ contacts.normals[0]
        approach = np.array([0.0, 0.0, 1.0]) - jaw[2] * jaw
        approach /= np.linalg.norm(approach)
        frame = np.column_stack([jaw, np.cross(approach, jaw), approach])
        return pin.SE3(frame, wrist.actInv(contacts.points.mean(axis=0)))

    def _reach(self, hand: Any) -> float:
        size = self._robot.posture_size
        approach = self._wrist(self._middle[: self._robot.arm_size]).rotation @ hand.rotation[:, 2]
        along = approach @ self._contacts(self._synergy).d_points[:, :, size:]
        half = 0.5 * (self._problem.upper - self._problem.lower)[size:]
        return float((np.abs(along) @ half).min())

    def _distances(self, target: Any) -> np.ndarray:
        """Return how far the wrist of each seed is from a target: way and turn."""
        way = np.linalg.norm(self._positions - target.translation, axis=1)
        cosine = 0.5 * (np.einsum("nij,ij->n", self._rotations, target.rotation) - 1.0)
        return way / METRES_A_RADIAN + np.arccos(np.clip(cosine, -1.0, 1.0))
