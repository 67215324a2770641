"""The hand in a robot file: synergies, pads with their contact models, compliance."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from .model import Frozen
from .patches import Patch
from .values import Interval, Name, NotNegative, Number, Positive, Table, empty, ordered, wrong

_SYNERGY = "a synergy is one joint, or has a name and joints"
_SYNERGY_REMEDY = "Write `joint: finger`, or `name: close` with `joints: {finger: 1.0, thumb: 0.5}`"


class SynergyDescription(Frozen):
    """One input of the hand, a column of the synergy matrix S (3): a joint, or several joints that move together.

    Joints that mimic these follow.
    """

    joint: Name | None = None
    """URDF joint: the synergy is its angle, rad (m)."""
    name: Name | None = None
    """Of a synergy of several joints."""
    joints: Table[Name, Number] = Field(default_factory=empty)
    """Angle of each joint, rad (m), per unit of the synergy; it adds to the others' and to `HandDescription.rest`."""
    limits: Interval | None = None
    """Limits in rad (m), or in units of the synergy; what the URDF allows its joints if not given."""

    @model_validator(mode="before")
    @classmethod
    def _names_joints(cls, value: Any) -> Any:
        """Refuse a column of a matrix, which does not say which joint a number is for."""
        if isinstance(value, list | str | int | float):
            raise wrong(_SYNERGY, remedy=_SYNERGY_REMEDY)
        if isinstance(value, dict) and isinstance(value.get("joints"), list):
            raise wrong("the angles of a synergy go with the names of joints", "joints", remedy=_SYNERGY_REMEDY)
        return value

    @field_validator("limits")
    @classmethod
    def _limits_ordered(cls, value: Interval | None) -> Interval | None:
        return None if value is None else ordered(value)

    @model_validator(mode="after")
    def _one_or_several(self) -> SynergyDescription:
        if (self.joint is None) == (not self.joints) or (self.joint is None) == (self.name is None):
            raise wrong(_SYNERGY, remedy=_SYNERGY_REMEDY)
        for name, factor in self.joints.items():
            if factor == 0.0:
                raise wrong("0 moves nothing", "joints", name, remedy="Leave it out")
        return self

    @property
    def label(self) -> str:
        """The name of the synergy: that of its joint, if it is one."""
        return self.joint or self.name or ""

    @property
    def column(self) -> dict[str, float]:
        """Angle of its joints per unit of the synergy."""
        return dict(self.joints) if self.joint is None else {self.joint: 1.0}


class HandDescription(Frozen):
    """The hand's synergies: angles of its joints = rest + S sigma, where column k of S (3) is synergy k."""

    synergies: Annotated[tuple[SynergyDescription, ...], Field(min_length=1)]
    """Inputs of the hand, the columns of S (3)."""
    rest: Table[Name, Number] = Field(default_factory=empty)
    """Angles, rad (m), with all synergies at 0; 0 if not given. A joint of no synergy stays there."""

    @model_validator(mode="after")
    def _joints_once(self) -> HandDescription:
        labels = [synergy.label for synergy in self.synergies]
        single = {synergy.joint for synergy in self.synergies}
        for index, synergy in enumerate(self.synergies):
            if synergy.label in labels[:index]:
                key = "name" if synergy.joint is None else "joint"
                raise wrong(f"{synergy.label!r} is given twice", "synergies", index, key)
            for name in synergy.joints:
                if name in single:
                    raise wrong(f"{name!r} is a synergy of its own", "synergies", index, "joints", name)
        for name in self.rest:
            if name in single:
                raise wrong(f"{name!r} is a synergy of its own: it has no rest", "rest", name)
        return self

    @property
    def joints(self) -> frozenset[str]:
        """The joints that synergies move, without those that mimic them."""
        return frozenset(name for synergy in self.synergies for name in synergy.column)


class HardFinger(Frozen):
    """Point contact with friction: three force components (the paper's model)."""

    model: Literal["hard_finger"] = "hard_finger"


class SoftFinger(Frozen):
    """Hard finger plus the spin torque about the normal, as a rubber pad gives it."""

    model: Literal["soft_finger"] = "soft_finger"
    torsion_radius: Positive
    """e in the friction term norm(f, m_n / e), m."""
    torsional_stiffness: Positive
    """Spin torque per angle of spin, N m / rad."""


ContactModel = Annotated[HardFinger | SoftFinger, Field(discriminator="model")]


class PadDescription(Frozen):
    """The surface patch of a finger link where contact is wanted."""

    name: Name
    """Of the pad; tasks and results call it so."""
    link: Name
    """Link of the URDF that carries it."""
    patch: Patch
    """Surface where contact may be, in the link's frame, m."""
    contact: ContactModel
    """What a contact on it transmits."""
    rubber_depth: NotNegative = 0.001
    """How deep an object without a smooth surface, a mesh, may press into the pad, m."""


class StiffnessDescription(Frozen):
    """Compliance of the hand, section 3.1 of the paper."""

    joint: Positive
    """k_ss, N m / rad (N / m if it slides), of every hand joint that synergies move; others count as rigid."""
    contact: Positive
    """k_stru, N / m, of every contact force component."""
