"""A grasp: one solution with everything derived from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..frozen import Record, frozen
from ..json_types import Transform, Vector
from ..verification.certificate import Certificate
from ..verification.claim import Claim
from .setup import Setup


@dataclass(frozen=True, eq=False, repr=False)
class Cost(Record):
    """The cost index (10): U = phi_mm2 + k V."""

    U: float
    """The cost index, in the paper's unit: mm^2, with k in mm^2."""
    phi_mm2: float
    """Sum of the squared distances of contact points from their desired points, mm^2; 0 in a task that desires none."""
    V: float
    """Cost of the contact forces (A7); no unit."""


@dataclass(frozen=True, eq=False, repr=False)
class Contact(Record):
    """One contact of a grasp; world frame, m and N."""

    pad: str
    """Name of the pad in the robot file."""
    link: str
    """Name of the link that the pad lies on."""
    point: Vector
    """Contact point, world, m, shape (3,)."""
    normal: Vector
    """Outward normal of the object at the contact point, world, shape (3,)."""
    force: Vector
    """Force on the object, world, N, shape (3,)."""
    spin_torque: float
    """Torque on the object about the pad's outward normal, N m; zero for a hard finger."""
    desired_point: Vector | None
    """The desired contact point that this pad serves, world, m, shape (3,); None in a task that desires none."""
    T_world_pad: Transform
    """Pose of the pad's patch frame, world, m, shape (4, 4): with the keys of the robot file, its origin is the patch's
    `origin`, its x axis `x_axis` and its z axis `normal`, outward from the finger."""


@dataclass(frozen=True, eq=False, repr=False)
class Grasp(Record):
    """One solution Q with everything derived from it; those of a result are verified."""

    not_in_json = ("setup",)

    start: int | None
    """Index of the start that found it, from 0; None: no start did, it was made from a configuration of the user's."""
    count: int
    """Number of starts that found a near-identical grasp, this one included."""
    joints: Mapping[str, float]
    """Every movable joint by name, rad (m), mimic joints included, continuous arm joints within (-pi, pi]. In the order
    of the URDFs: as the document has them, those of an attached URDF behind those of what it is attached to."""
    q_arm: Array
    """Arm joints in the order of the robot file, rad (m), shape (l,)."""
    synergy: Array
    """Hand synergies sigma in the order of the robot file, rad (m), shape (s,)."""
    contact_parameters: Array
    """q_c: contact parameters of each pad in turn, m or rad, shape (m,)."""
    internal_forces: Array
    """y: active internal forces in the basis E_s, N, shape (e_s,)."""
    q_r: Mapping[str, float]
    """Reference angles of the hand joints by name that squeeze with these forces, rad (m)."""
    cost: Cost
    """U and its parts; `phi_mm2` in mm^2."""
    contacts: tuple[Contact, ...]
    """One for each pad of the task, in the order of its pads."""
    certificate: Certificate
    """Every figure of the independent check."""
    T_world_wrist: Transform
    """Pose of the wrist link, m, shape (4, 4)."""
    setup: Setup | None = field(default=None, repr=False)
    """Robot, scene and task that it belongs to; every grasp of a result has them. None on the way there: worker
    processes do not send them with each grasp."""

    @property
    def q(self) -> Array:
        """`joints` as an array, rad (m), in their order, shape (n,)."""
        q: Array = frozen(np.array(list(self.joints.values()), dtype=np.float64))
        return q

    @property
    def T_object_wrist(self) -> Array:
        """Pose of the wrist link in the frame of the task's object, m, shape (4, 4).

        Raises:
            InputError: the grasp belongs to no result.
        """
        setup = self.required_setup
        T_world_object = setup.scene.objects[setup.scene.task(setup.task).object].pose.matrix
        T: Array = frozen(np.linalg.solve(T_world_object, self.T_world_wrist))
        return T

    @property
    def required_setup(self) -> Setup:
        """Robot, scene and task that it belongs to.

        Raises:
            InputError: they are not known.
        """
        if self.setup is None:
            problem = "belongs to no result: its robot and its scene are not known"
            raise InputError(problem, key="grasp", remedy="Take one of `Result.grasps`")
        return self.setup

    @property
    def claim(self) -> Claim:
        """Joints, contact points and forces: what the check proves or refutes."""
        return Claim(
            joints=self.joints,
            points=np.array([contact.point for contact in self.contacts]),
            forces=np.array([contact.force for contact in self.contacts]),
            spin_torques=np.array([contact.spin_torque for contact in self.contacts]),
        )

    def __repr__(self) -> str:
        found = (
            "own configuration"
            if self.start is None
            else f"found by {self.count} {'start' if self.count == 1 else 'starts'}"
        )
        verdict = "verified" if self.certificate.verified else "not verified"
        return f"<Grasp: {verdict}, U {self.cost.U:.4g}, {found}{_place(self.setup)}>"

    def _repr_html_(self) -> str:
        from .html import grasp_html  # it loops over the criteria, which read grasps

        return grasp_html(self)


def _place(setup: Setup | None) -> str:
    return f"; {setup}" if setup else ""
