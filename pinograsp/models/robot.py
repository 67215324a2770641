"""A robot mounted in the world: Pinocchio model, arm and hand variables, pads.

The model has every movable joint of the URDF as a joint of its own, mimic joints too. The posture
p = (q_a, sigma), shape (l + s,), gives all of them by

    q = B p + q_0,        dq/dp = B

where a column of B is a unit vector for an arm joint and a synergy (leader and mimic multipliers) for sigma.
The rows of the hand joints and the columns of sigma form the paper's synergy matrix S (3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from ..arrays import Array, Indices
from ..descriptions import RobotDescription
from ..descriptions.robot import PadDescription
from ..errors import InputError
from . import urdf


@dataclass(frozen=True)
class Pad:
    """A pad in the model: patch frame in its joint's frame, x and y along the contact parameters, z outward."""

    description: PadDescription
    joint: int
    rotation: Array
    """Shape (3, 3)."""
    translation: Array
    """m, shape (3,)."""


class RobotModel:
    """A robot whose root link stands at `T_world_root`; see the module's docstring for B and q_0.

    Pickling sends the robot file's data and builds the model again on the other side.
    """

    def __init__(self, description: RobotDescription, T_world_root: Array | None = None) -> None:
        self.description = description
        self.T_world_root = np.eye(4) if T_world_root is None else T_world_root
        self.urdf = urdf.prepare(description, self.T_world_root)
        self._check_names()
        self.model: Any = pin.buildModelFromXML(self.urdf.xml)
        self.joint_names: tuple[str, ...] = tuple(self.model.names)[1:]
        self.B, self.q_0 = self._posture_map()
        self.lower, self.upper = self._limits()
        self.arm_size = len(description.arm.joints)
        self.hand_joints: Indices = np.flatnonzero(np.abs(self.B[:, self.arm_size :]).any(axis=1))
        self.supports = self._supports()
        self.pads = tuple(self._pad(pad) for pad in description.pads)
        self.wrist_frame: int = self.model.getFrameId(description.arm.wrist)

    def __reduce__(self) -> tuple[object, ...]:
        """Build again from the description: an unpickled Pinocchio model is not to be trusted."""
        return (RobotModel, (self.description, self.T_world_root))

    def mounted(self, T_world_root: Array) -> RobotModel:
        """Return the same robot with its root link at another pose, shape (4, 4)."""
        return RobotModel(self.description, T_world_root)

    @property
    def synergies(self) -> Array:
        """Synergy matrix S (3) of the hand joints, shape (h, s)."""
        return self.B[self.hand_joints][:, self.arm_size :]

    @property
    def posture_size(self) -> int:
        """Number of arm joints and synergies, l + s."""
        return int(self.B.shape[1])

    def joint_positions(self, posture: Array) -> Array:
        """Return q of every movable joint in the model's order, rad (m), shape (nv,)."""
        return np.asarray(self.B @ posture + self.q_0)

    def wrapped(self, posture: Array) -> Array:
        """Return the posture with continuous arm joints wrapped to (-pi, pi]."""
        result = posture.copy()
        for i, name in enumerate(self.description.arm.joints):
            if self.urdf.movable[name] == "continuous" and name not in self.description.arm.limits:
                result[i] = _wrap(float(result[i]))
        return result

    def joints_by_name(self, posture: Array) -> dict[str, float]:
        """Return q by joint name, continuous arm joints wrapped to (-pi, pi]."""
        q = self.joint_positions(self.wrapped(posture))
        return dict(zip(self.joint_names, q.tolist(), strict=True))

    def _check_names(self) -> None:
        description, known = self.description, list(self.urdf.movable)
        for i, joint in enumerate(description.arm.joints):
            self._require_leader(joint, known, f"arm.joints[{i}]")
        for i, synergy in enumerate(description.hand.synergies):
            self._require_leader(synergy.joint, known, f"hand.synergies[{i}].joint")
            if synergy.joint in description.arm.joints:
                self._refuse(f"{synergy.joint!r} is already an arm joint", f"hand.synergies[{i}].joint")
        urdf.require(description.arm.wrist, list(self.urdf.links), "link", "arm.wrist", description)
        for i, pad in enumerate(description.pads):
            urdf.require(pad.link, list(self.urdf.links), "link", f"pads[{i}].link", description)

    def _require_leader(self, joint: str, known: list[str], key: str) -> None:
        urdf.require(joint, known, "joint", key, self.description)
        if joint in self.urdf.mimics:
            leader = self.urdf.mimics[joint].leader
            self._refuse(f"joint {joint!r} mimics {leader!r}", key, f"Name {leader!r} instead")

    def _refuse(self, problem: str, key: str, remedy: str | None = None) -> None:
        raise InputError(problem, file=self.description.source, key=key, remedy=remedy)

    def _posture_map(self) -> tuple[Array, Array]:
        leaders = [*self.description.arm.joints, *(s.joint for s in self.description.hand.synergies)]
        B = np.zeros((self.model.nv, len(leaders)))
        q_0 = np.zeros(self.model.nv)
        for row, name in enumerate(self.joint_names):
            mimic = self.urdf.mimics.get(name)
            leader = mimic.leader if mimic else name
            if leader in leaders:
                B[row, leaders.index(leader)] = mimic.multiplier if mimic else 1.0
                q_0[row] = mimic.offset if mimic else 0.0
        return B, q_0

    def _limits(self) -> tuple[Array, Array]:
        given = dict(self.description.arm.limits)
        given |= {s.joint: s.limits for s in self.description.hand.synergies if s.limits is not None}
        names = [*self.description.arm.joints, *(s.joint for s in self.description.hand.synergies)]
        limits: list[tuple[float, float]] = []
        for name in names:
            index = self.model.joints[self.model.getJointId(name)].idx_q
            from_urdf = (self.model.lowerPositionLimit[index], self.model.upperPositionLimit[index])
            lower, upper = given.get(name, from_urdf)
            if not (math.isfinite(lower) and math.isfinite(upper) and lower < upper):
                key = "arm.limits" if name in self.description.arm.joints else "hand.synergies"
                self._refuse(f"joint {name!r} has no usable limits", key, "Give them in the robot file")
            limits.append((lower, upper))
        array: Array = np.array(limits)
        return array[:, 0], array[:, 1]

    def _supports(self) -> Array:
        """Return which joints move which: row j has 1 at every joint between the root and joint j."""
        supports = np.zeros((self.model.njoints, self.model.nv))
        for joint in range(1, self.model.njoints):
            supports[joint] = supports[self.model.parents[joint]]
            supports[joint, self.model.joints[joint].idx_v] = 1.0
        return supports

    def _pad(self, pad: PadDescription) -> Pad:
        frame = self.model.frames[self.model.getFrameId(pad.link)]
        placement = frame.placement * pin.SE3(pad.patch.rotation, np.array(pad.patch.origin))
        if not self.supports[frame.parentJoint, self.hand_joints].any():
            number = self.description.pads.index(pad)
            self._refuse(f"link {pad.link!r} is not moved by the hand", f"pads[{number}].link")
        return Pad(pad, frame.parentJoint, placement.rotation.copy(), placement.translation.copy())


def _wrap(angle: float) -> float:
    wrapped = math.remainder(angle, 2 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped
