"""A grasp and the result of a run."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from ..arrays import Array
from ..verification.certificate import Certificate
from .setup import Setup


@dataclass(frozen=True)
class Cost:
    """The cost index (10): U = phi_mm2 + k V."""

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
    setup: Setup | None = field(default=None, repr=False)
    """Robot, scene and task that it belongs to; every grasp of a result has them. None on the way there: worker
    processes do not send them with each grasp."""


@dataclass(frozen=True)
class Blocked:
    """The starts whose most violated constraint was of one kind."""

    starts: int
    nearest_miss: float
    """Least violation among them, in `unit`."""
    unit: str
    where: str
    """Bodies, pad or figure of the nearest miss."""


@dataclass(frozen=True)
class Result:
    """What a run found: verified grasps sorted by U, and what became of every start."""

    setup: Setup = field(repr=False)
    """Robot, scene and task; each of the grasps gets this object too."""
    grasps: tuple[Grasp, ...]
    starts: int
    """Starts asked for."""
    counts: dict[str, int]
    """Starts per outcome of the solver: converged, feasible, infeasible, budget spent, failed."""
    reliable: int
    """Starts that ended in a grasp which the independent check verified."""
    refuted: int
    """Starts whose grasp the solver called feasible and the independent check refuted."""
    blocked: dict[str, Blocked]
    """What kept the other starts from being reliable, by kind of constraint."""
    interrupted: bool = False
    times: dict[str, float] = field(default_factory=dict)
    """Seconds per stage; `solver_mean` is the mean of one start on one core."""
    provenance: dict[str, Any] = field(default_factory=dict)
    """Package versions, hashes of the input files, seed and options."""
    warnings: tuple[str, ...] = ()
    """What is odd about the task."""
    altered: bool = False
    """Whether it was read from a file that somebody changed: the content is not that of the file's digest."""

    def __post_init__(self) -> None:
        """Tell every grasp where it belongs."""
        grasps = tuple(g if g.setup is self.setup else replace(g, setup=self.setup) for g in self.grasps)
        object.__setattr__(self, "grasps", grasps)

    @property
    def robot(self) -> str:
        """Name of the robot."""
        return self.setup.robot.name

    @property
    def scene(self) -> str:
        """Name of the scene."""
        return self.setup.scene.name

    @property
    def task(self) -> str:
        """Name of the task."""
        return self.setup.task

    @property
    def best(self) -> Grasp | None:
        """The grasp of least U, or None."""
        return self.grasps[0] if self.grasps else None

    @property
    def done(self) -> int:
        """Number of starts that were solved."""
        return sum(self.counts.values())
