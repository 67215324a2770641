"""The drive of a hand as joints, couplings and actuators of MuJoCo.

A servo of stiffness k pulls its joint towards q_r; a driver torque acts on one joint, whose motion the others follow by
stiff equality constraints. Both are biases of actuators whose control is 0: the control takes the squeeze away.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..results import Grasp
from .hand import HandLink

_COUPLED = {"solref": "0.002 1", "solimp": "0.99 0.999 0.0001"}
_ARMATURE = {False: 1e-3, True: 5e-2}
"""Inertia of the drives, added to every joint that turns, kg m^2, or slides, kg: hands have it, URDFs lack it."""
_DAMPING = {False: 1e-2, True: 1.0}
"""Of every joint under torque control, N m s / rad, N s / m: without effect at rest."""


@dataclass(frozen=True)
class Drive:
    """How the hand's joints are driven."""

    joints: dict[str, float]
    """Joints that move, and their angles at the grasp."""
    elements: tuple[ET.Element, ...]
    """Couplings and actuators."""
    slack: tuple[float, ...]
    stiffness: float | None
    """Of servos."""

    def of(self, slides: bool) -> dict[str, str]:
        """Return the attributes of every joint of a kind."""
        inertia = _ARMATURE[slides]
        # Servos are damped critically; what they move weighs little beside their own inertia.
        damping = _DAMPING[slides] if self.stiffness is None else 2.0 * float(np.sqrt(self.stiffness * inertia))
        return {"armature": f"{inertia!r}", "damping": f"{damping!r}"}


def coupled(grasp: Grasp, moved: dict[str, float], torque: float) -> Drive:
    """Return the drive of one torque, all joints following its joint."""
    driver = next(iter(moved))
    equality, actuator = ET.Element("equality"), ET.Element("actuator")
    for joint, factor in moved.items():
        if joint != driver:
            coupled = {"joint1": joint, "joint2": driver, "polycoef": numbers([0, factor, 0, 0, 0])}
            ET.SubElement(equality, "joint", coupled | _COUPLED)
    _add_actuator(actuator, driver, 1.0, (torque, 0.0))
    return Drive({joint: grasp.joints[joint] for joint in moved}, (equality, actuator), (-torque,), None)


def servos(grasp: Grasp, links: Iterable[HandLink], stiffness: float) -> Drive:
    """Return the drive of a servo for every joint that has a reference."""
    joints = [link.joint.name for link in links if link.joint is not None and link.joint.name in grasp.q_r]
    actuator = ET.Element("actuator")
    for joint in joints:
        _add_actuator(actuator, joint, stiffness, (stiffness * grasp.q_r[joint], -stiffness))
    angles = {joint: grasp.joints[joint] for joint in joints}
    return Drive(angles, (actuator,), tuple(angles[joint] - grasp.q_r[joint] for joint in joints), stiffness)


def _add_actuator(parent: ET.Element, joint: str, gain: float, bias: tuple[float, float]) -> None:
    """Add an actuator of torque gain * control + bias_0 + bias_1 * angle."""
    kinds = {"gaintype": "fixed", "biastype": "affine", "gainprm": numbers([gain])}
    ET.SubElement(parent, "general", kinds, name=joint, joint=joint, biasprm=numbers([*bias, 0.0]))


def numbers(values: Sequence[float] | Array, digits: int = 17) -> str:
    """Return numbers as the value of an attribute."""
    return " ".join(f"{value:.{digits}g}" for value in values)
