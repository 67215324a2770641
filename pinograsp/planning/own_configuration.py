"""A configuration that the user gives, as the independent check has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..arrays import Array, Numbers, real_array
from ..errors import InputError, UnknownNameError, close_names, real_number
from ..kinematics.contacts import contact_kinematics
from ..kinematics.forward import forward
from ..kinematics.robot import Robot
from ..problem import DesiredPoints, GraspProblem, State, TaskModel
from ..results import Grasp, Result, Setup
from ..results.configuration_check import ConfigurationCheck
from ..solve.projection import nearest_assignment
from ..verification.check import Verifier
from .assemble import claim_of, exact, grasp_of

STEPS = 20
TOWARDS_DESIRED = 1e-3
"""Weight of the desired points, which decide where a contact is that could be anywhere along a line.

If the task has none, it is as near to the middle of its pad as it can.
"""


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
    state = _touching(model, posture)
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
    return ConfigurationCheck(grasp, verifier.clearances(claim.joints))


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


def _touching(model: TaskModel, posture: Array) -> State:
    """Return the state of a posture with contacts where pads and object are nearest to touching."""
    # The whole pads: whether contacts keep a reserve from the rims is for the check to say.
    size, (low, high) = model.robot.posture_size, model.robot.parameter_limits.T
    x = np.concatenate([posture, 0.5 * (low + high)])
    desired = _below_the_middles(model, x) if model.task.desired_contacts is None else None
    problem = GraspProblem(model, tuple(range(len(model.robot.pads))), desired=desired)
    problem = GraspProblem(model, nearest_assignment(model, problem.state(x), desired), desired=desired)
    for _ in range(STEPS):
        residual = problem.projection_residual(x, TOWARDS_DESIRED, 0.0)
        J = residual.jacobian[:, size:]
        step = np.linalg.lstsq(J, -residual.values, rcond=1e-9)[0]
        moved = np.clip(x[size:] + step, low, high)
        done = np.abs(moved - x[size:]).max() < 1e-12
        x = np.concatenate([posture, moved])
        if done:
            break
    return problem.state(x)


def _below_the_middles(model: TaskModel, x: Array) -> DesiredPoints:
    """Return the points of the object that are nearest to contacts at x, shape (v,)."""
    robot, size = model.robot, model.robot.posture_size
    points = contact_kinematics(forward(robot, robot.model.createData(), x[:size]), x[size:]).points
    distances, normals, _ = model.object_surface(points)
    return DesiredPoints(points - distances[:, None] * normals, np.zeros_like(points))
