"""A grasp: one solution with everything derived from it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array
from ..verification.certificate import Certificate
from ..verification.claim import Claim
from .setup import Setup


@dataclass(frozen=True)
class Cost:
    """The cost index (10): U = phi_mm2 + k V, all three in the paper's unit, mm^2 with k in mm^2 and V without one."""

    U: float
    phi_mm2: float
    V: float


@dataclass(frozen=True)
class Contact:
    """One contact of a grasp; world frame, m and N."""

    pad: str
    link: str
    point: Array
    """Contact point, shape (3,)."""
    normal: Array
    """Outward normal of the object at the contact point, shape (3,)."""
    force: Array
    """Force on the object, shape (3,)."""
    spin_torque: float
    """Torque on the object about the pad's outward normal, N m; zero for a hard finger."""
    desired_point: Array
    """The desired contact point that this pad serves, shape (3,)."""


@dataclass(frozen=True)
class Grasp:
    """One verified solution Q with everything derived from it."""

    start: int
    """Index of the start that found it."""
    count: int
    """How many starts found a near-identical grasp, this one included."""
    joints: dict[str, float]
    """Every movable joint of the URDF by name, rad (m), continuous joints within (-pi, pi]."""
    q_arm: Array
    """Arm joints in the order of the robot file, rad, shape (l,)."""
    synergy: Array
    """Hand synergies sigma, rad (m), shape (s,)."""
    contact_parameters: Array
    """q_c: contact parameters of each pad in turn, m or rad, shape (m,)."""
    internal_forces: Array
    """y: active internal forces in the basis E_s, N, shape (e_s,)."""
    q_r: dict[str, float]
    """Reference angles of the hand joints by name that squeeze with these forces, rad."""
    cost: Cost
    contacts: tuple[Contact, ...]
    certificate: Certificate
    T_world_wrist: Array
    """Pose of the wrist link, m, shape (4, 4)."""
    setup: Setup | None = field(default=None, repr=False)
    """Robot, scene and task that it belongs to; every grasp of a result has them. None on the way there: worker
    processes do not send them with each grasp."""

    @property
    def claim(self) -> Claim:
        """The part that the check proves or refutes: joints, contact points and forces."""
        return Claim(
            joints=self.joints,
            points=np.array([contact.point for contact in self.contacts]),
            forces=np.array([contact.force for contact in self.contacts]),
            spin_torques=np.array([contact.spin_torque for contact in self.contacts]),
        )
