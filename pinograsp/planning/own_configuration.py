"""A configuration that the user gives, as the independent check has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..arrays import Array, Numbers, real_array
from ..errors import InputError, UnknownNameError, close_names, real_number
from ..kinematics.robot import Robot
from ..problem import TaskModel, file_findings
from ..results import Grasp, Result, Setup
from ..results.configuration_check import ConfigurationCheck
from ..verification.check import Verifier
from .assemble import claim_of, exact, grasp_of
from .own_contacts import touching

Configuration = Mapping[str, float] | Numbers
"""Values by the names of arm joints and synergies, or in their order, rad (m)."""


def checked(model: TaskModel, verifier: Verifier, q: Configuration) -> ConfigurationCheck:
    """Check a configuration.

    Args:
        model: the task.
        verifier: of the same task.
        q: values by name, of every arm joint and synergy at least, further joints of the URDF as they are given (those
            of a grasp do); or arm joints and synergies in the order of the robot file, shape (l + s,); rad (m).

    Raises:
        InputError: a value is missing, unknown or not finite.
    """
    posture, given = _posture(model.robot, q)
    state = touching(model, posture)
    claim = claim_of(state)
    claim = replace(claim, joints={**claim.joints, **given})
    grasp = exact(grasp_of(None, state, claim, verifier.certify(claim)), model, verifier)
    # The wrist and the pads are where the given joints have them, even if these keep to no synergy.
    derived = verifier.derive(claim)
    placed = zip(grasp.contacts, derived.T_world_pads, strict=True)
    grasp = replace(
        grasp,
        contacts=tuple(replace(contact, T_world_pad=T) for contact, T in placed),
        T_world_wrist=derived.T_world_wrist,
        setup=Setup(model.robot.unmounted.description, model.scene, model.task_name),
    )
    odd = file_findings(model.scene, model.task, model.robot.description)
    return ConfigurationCheck(grasp, verifier.clearances(claim.joints), tuple(odd))


def _posture(robot: Robot, q: Configuration) -> tuple[Array, dict[str, float]]:
    """Return the posture (q_a, sigma), shape (l + s,), and the joints that were given by name."""
    if isinstance(q, Grasp | Result):
        remedy = "Give its `joints`" if isinstance(q, Grasp) else "Give `best.joints`"
        raise InputError(f"must be values of joints, not a {type(q).__name__}", key="joints", remedy=remedy)
    names = robot.posture_names
    if not isinstance(q, Mapping):
        try:
            return real_array("joints", q, len(names)), {}
        except InputError as error:
            raise InputError(error.problem, key="joints", remedy=f"Give {', '.join(names)}") from None
    known = [*names, *robot.joint_names]
    for name in q:
        if name not in known:
            raise UnknownNameError(f"there is no joint {name!r}", key="joints", remedy=close_names(name, known))
    numbers = {name: real_number(f"joints.{name}", value) for name, value in q.items()}
    given = {name: value for name, value in numbers.items() if name in robot.joint_names}
    values = _synergies(robot, given) | numbers
    if missing := [name for name in names if name not in values]:
        raise InputError(f"no value is given for {missing[0]!r}", key="joints", remedy=f"Give {', '.join(missing)}")
    return np.array([values[name] for name in names]), given


def _synergies(robot: Robot, joints: Mapping[str, float]) -> dict[str, float]:
    """Return the synergies that come nearest to the angles of the hand's joints; nothing if some are not given."""
    names = [robot.joint_names[joint] for joint in robot.hand_joints]
    if not all(name in joints for name in names):
        return {}
    moved = np.array([joints[name] for name in names]) - robot.q_0[robot.hand_joints]
    sigma = np.linalg.lstsq(robot.synergies, moved, rcond=None)[0]
    return dict(zip(robot.posture_names[robot.arm_size :], sigma.tolist(), strict=True))
