"""A robot mounted in the world: Pinocchio model, arm and hand variables, pads.

The model has every movable joint of the URDF as a joint of its own, mimic joints too. The posture
p = (q_a, sigma), shape (l + s,), gives all of them by

    q = B p + q_0,        dq/dp = B

where a column of B is a unit vector for an arm joint and a synergy for sigma (its joints and those that mimic them),
and q_0 holds where the hand rests. The rows of the hand joints and the columns of sigma form the paper's synergy
matrix S (3).
"""

from __future__ import annotations

import json
import math
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from ..arrays import Array, Indices
from ..descriptions import RobotDescription, load_robot_description
from ..descriptions.robot_files import hashes_of, require_same
from ..descriptions.urdf import Mimic
from ..descriptions.urdf_checks import usable
from ..errors import InputError, require_kind
from ..geometry.patches import patch_point
from . import urdf
from .names import check_names
from .pads import PadFrames, pads_of

TURN_STEP, SLIDE_STEP, SLIP_STEP = 1.0, 0.1, 0.02
"""Comparable steps of a turning joint, rad, a sliding joint, m, and a contact on its pad, m."""


class Robot:
    """A robot whose root link stands at `T_world_root`; see the module's docstring for B and q_0.

    The URDF is read once, here. `mounted` and `with_pads` give robots that share all else with this one, quickly.
    """

    def __init__(self, description: RobotDescription) -> None:
        require_kind("description", description, RobotDescription, remedy="Load the robot with `load_robot`")
        self.unmounted = self
        """The robot with its root link at the world's origin, from which this one was made."""
        self.description = description
        self.T_world_root: Array = np.eye(4)
        self.urdf = urdf.prepare(description)
        self.files = hashes_of(description, self.urdf.composed)
        """SHA-256 of URDFs, SRDFs and meshes when the robot was loaded."""
        check_names(description, self.urdf)
        self.model: Any = pin.buildModelFromXML(self.urdf.xml)
        self.joint_names: tuple[str, ...] = tuple(self.model.names)[1:]
        self.arm_size = len(description.arm.joints)
        self.posture_names = (*description.arm.joints, *(synergy.label for synergy in description.hand.synergies))
        self.B, self.q_0 = self._posture_map()
        self.joint_limits = self._joint_limits()
        self._check_rest()
        self.lower, self.upper = self._limits()
        self.shared_joints: Indices = np.flatnonzero((self.B != 0.0).sum(axis=1) > 1)
        """Joints that several synergies move: limits of the posture do not keep these within their own."""
        self.hand_joints: Indices = np.flatnonzero(np.abs(self.B[:, self.arm_size :]).any(axis=1))
        self.supports = self._supports()
        self.wrist_frame: int = self.model.getFrameId(description.arm.wrist, pin.BODY)
        self._place_pads()

    def _place_pads(self) -> None:
        description = self.description
        limits = [limits for pad in description.pads for limits in pad.patch.parameters]
        self.parameter_limits: Array = np.array(limits).reshape(-1, 2)
        self.pads = pads_of(self.model, description.pads)
        self.pad_frames = PadFrames.of(self.pads)
        self.step_units = self._step_units()
        self._check_pads()

    def __reduce__(self) -> tuple[object, ...]:
        """Build again from the description: an unpickled Pinocchio model is not to be trusted."""
        content = json.dumps(self.unmounted.description.model_dump(mode="json"))
        pads = tuple(pad.name for pad in self.description.pads)
        return (_rebuilt, (content, tuple(sorted(self.files.items())), pads, self.T_world_root))

    def mounted(self, T_world_root: Array) -> Robot:
        """Return the same robot with its root link at another pose, shape (4, 4)."""
        robot = self._alike()
        robot.T_world_root = T_world_root
        robot.model = _mounted(self.unmounted.model, T_world_root)
        return robot

    def with_pads(self, names: tuple[str, ...]) -> Robot:
        """Return the same robot with only some of its pads, by name, in the order given."""
        pads = {pad.name: pad for pad in self.unmounted.description.pads}
        robot = self._alike()
        robot.description = self.description.model_copy(update={"pads": tuple(pads[name] for name in names)})
        robot._place_pads()
        return robot

    def _alike(self) -> Robot:
        robot = object.__new__(Robot)
        robot.__dict__.update(self.__dict__)
        return robot

    @property
    def synergies(self) -> Array:
        """Synergy matrix S (3) of the hand joints, shape (h, s)."""
        return self.B[self.hand_joints][:, self.arm_size :].copy()

    @property
    def posture_size(self) -> int:
        """Number of arm joints and synergies, l + s."""
        return int(self.B.shape[1])

    def joint_positions(self, posture: Array) -> Array:
        """Return q of every movable joint in the model's order, rad (m), shape (nv,)."""
        return np.asarray(self.B @ posture + self.q_0)

    def turns_freely(self, joint: str) -> bool:
        """Whether a joint is a continuous arm joint without limits in the robot file: whole turns do not count."""
        arm = self.description.arm
        return joint in arm.joints and self.urdf.movable[joint] == "continuous" and joint not in arm.limits

    def moved_by_hand(self, first: int, second: int) -> bool:
        """Whether nothing but the hand's joints moves what two joints carry against each other.

        Args:
            first: number of a joint of the model.
            second: of the other one.
        """
        relative = np.flatnonzero(self.supports[first] != self.supports[second])
        return bool(np.isin(relative, self.hand_joints).all())

    def wrapped(self, posture: Array) -> Array:
        """Return the posture with continuous arm joints wrapped to (-pi, pi]."""
        result = posture.copy()
        for i, name in enumerate(self.description.arm.joints):
            if self.turns_freely(name):
                result[i] = _wrap(float(result[i]))
        return result

    def joints_by_name(self, posture: Array) -> dict[str, float]:
        """Return q by joint name in the order of the URDFs, continuous arm joints wrapped to (-pi, pi]."""
        q = dict(zip(self.joint_names, self.joint_positions(self.wrapped(posture)).tolist(), strict=True))
        return {name: q[name] for name in self.urdf.movable}

    def _refuse(self, problem: str, key: str, remedy: str | None = None) -> None:
        raise InputError(problem, file=self.description.source, key=key, remedy=remedy)

    def _columns(self) -> list[dict[str, float]]:
        """Return the columns of B as the robot file has them: joints with their factors."""
        arm, hand = self.description.arm, self.description.hand
        return [*({joint: 1.0} for joint in arm.joints), *(synergy.column for synergy in hand.synergies)]

    def _posture_map(self) -> tuple[Array, Array]:
        hand, columns = self.description.hand, self._columns()
        B = np.zeros((self.model.nv, len(columns)))
        q_0 = np.zeros(self.model.nv)
        for row, name in enumerate(self.joint_names):
            mimic = self.urdf.mimics.get(name, Mimic(name, 1.0, 0.0))
            B[row] = [mimic.multiplier * column.get(mimic.leader, 0.0) for column in columns]
            q_0[row] = mimic.multiplier * hand.rest.get(mimic.leader, 0.0) + mimic.offset
        return B, q_0

    def _joint_limits(self) -> tuple[Array, Array]:
        """Return the limits of every joint of the model, rad (m): those of the URDF, or given in the robot file."""
        given = dict(self.description.arm.limits)
        given |= {s.joint: s.limits for s in self.description.hand.synergies if s.joint and s.limits}
        order = [self.model.joints[self.model.getJointId(name)].idx_q for name in self.joint_names]
        lower, upper = self.model.lowerPositionLimit[order], self.model.upperPositionLimit[order]
        for row, name in enumerate(self.joint_names):
            lower[row], upper[row] = given.get(name, (lower[row], upper[row]))
        return lower, upper

    def _check_rest(self) -> None:
        """Refuse joints that no variable moves and that stay outside their limits."""
        low, high = self.joint_limits
        for row in np.flatnonzero(~self.B.any(axis=1)):
            name, angle = self.joint_names[row], self.q_0[row]
            if not low[row] - 1e-9 <= angle <= high[row] + 1e-9:
                problem = f"joint {name!r}, which no synergy moves, stays at {angle:g}, outside "
                self._refuse(f"{problem}[{low[row]:g}, {high[row]:g}]", "hand.rest", "Give its angle there")

    def _check_pads(self) -> None:
        """Refuse a pad that neither the hand moves nor what carries the fingers of others that it moves."""
        others = np.setdiff1d(np.arange(self.model.nv), self.hand_joints)
        moved = [pad for pad in self.pads if self.supports[pad.joint, self.hand_joints].any()]
        carriers = {tuple(self.supports[pad.joint, others]) for pad in moved}
        for number, pad in enumerate(self.pads):
            if pad not in moved and tuple(self.supports[pad.joint, others]) not in carriers:
                remedy = "A pad is on a finger, or on the link that carries the fingers of others"
                problem = f"link {pad.description.link!r} is not moved by the hand"
                self._refuse(problem, f"pads[{number}].link", remedy)

    def _limits(self) -> tuple[Array, Array]:
        """Return the limits of the posture that keep every joint within its own which one variable alone moves."""
        low, high = self.joint_limits
        synergies = self.description.hand.synergies
        given = [(-math.inf, math.inf)] * self.arm_size
        given += [(-math.inf, math.inf) if s.joint or not s.limits else s.limits for s in synergies]
        lower, upper = np.array(given).T.copy()
        by: dict[int, list[str]] = {}
        for row in np.flatnonzero((self.B != 0.0).sum(axis=1) == 1):
            column = int(np.flatnonzero(self.B[row])[0])
            factor = self.B[row, column]
            ends = [(end - self.q_0[row]) / factor + 0.0 for end in (low[row], high[row])][:: 1 if factor > 0.0 else -1]
            lower[column], upper[column] = max(lower[column], ends[0]), min(upper[column], ends[1])
            by.setdefault(column, []).append(f"{self.joint_names[row]} to {ends[0]:g} .. {ends[1]:g}")
        for column, name in enumerate(self.posture_names):
            if not usable(lower[column], upper[column]):
                key, what = ("arm.limits", "joint") if column < self.arm_size else ("hand.synergies", "synergy")
                joints = f": joints keep it, {'; '.join(by[column])}" if len(by.get(column, ())) > 1 else ""
                problem = f"{what} {name!r} has no usable limits ({lower[column]:g} .. {upper[column]:g}){joints}"
                remedy = "Mend the limits or <mimic> of the one that is not meant so" if joints else None
                self._refuse(problem, key, remedy or "Give them in the robot file")
        return lower, upper

    def _supports(self) -> Array:
        """Return which joints move which: row j has 1 at every joint between the root and joint j."""
        supports = np.zeros((self.model.njoints, self.model.nv))
        for joint in range(1, self.model.njoints):
            supports[joint] = supports[self.model.parents[joint]]
            supports[joint, self.model.joints[joint].idx_v] = 1.0
        return supports

    def _step_units(self) -> Array:
        """Return a step of every variable of x = (posture, q_c) that moves a contact alike, shape (v,)."""
        steps = {name: SLIDE_STEP if kind == "prismatic" else TURN_STEP for name, kind in self.urdf.movable.items()}
        posture = [min(steps[name] / abs(factor) for name, factor in column.items()) for column in self._columns()]
        middle = self.parameter_limits.mean(axis=1)
        lengths = [np.linalg.norm(patch_point(pad.patch, middle[pad.parameters]).d_point, axis=0) for pad in self.pads]
        return np.concatenate([posture, *(SLIP_STEP / length for length in lengths)])


def load_robot(name: str | Path) -> Robot:
    """Read a robot file with its URDF, given by path, by folder or by the name of a shipped robot.

    Raises:
        InputError: a file is missing or wrong; the message names it, the key and the remedy.
    """
    return Robot(load_robot_description(name))


def _mounted(model: Any, T_world_root: Array) -> Any:
    """Return a copy of a Pinocchio model whose root stands at a pose: joints and frames that the world carries move."""
    copied, mount = pin.Model(model), pin.SE3(T_world_root)
    for joint in range(1, copied.njoints):
        if copied.parents[joint] == 0:
            copied.jointPlacements[joint] = mount * copied.jointPlacements[joint]
    for frame in list(copied.frames)[1:]:  # the first one is the world itself
        if frame.parentJoint == 0:
            frame.placement = mount * frame.placement
    return copied


@lru_cache(maxsize=8)
def _built(content: str, files: tuple[tuple[str, str], ...]) -> Robot:
    """Return the robot of a robot file's content (JSON), built once a process for each content of its files.

    Raises:
        InputError: the files here are not those that the robot was loaded from.
    """
    robot = Robot(RobotDescription.model_validate_json(content))
    require_same(robot.description, dict(files), robot.files)
    return robot


def _rebuilt(content: str, files: tuple[tuple[str, str], ...], pads: tuple[str, ...], T_world_root: Array) -> Robot:
    """Return a pickled robot."""
    return _built(content, files).with_pads(pads).mounted(T_world_root)


def _wrap(angle: float) -> float:
    wrapped = math.remainder(angle, 2 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped
