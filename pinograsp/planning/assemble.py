"""A solved state in the terms of a result: the claim that is checked, and the grasp that is reported."""

from __future__ import annotations

from dataclasses import replace

from ..kinematics.contacts import pad_poses
from ..kinematics.wrist import wrist_pose
from ..problem import State, TaskModel
from ..results import Contact, Cost, Grasp
from ..verification import Certificate, Claim
from ..verification.check import Verifier


def claim_of(state: State) -> Claim:
    """Return what the solver claims at a state."""
    models, f = state.model.contact_models, state.forces.f
    return Claim(
        joints=state.model.robot.joints_by_name(state.configuration.posture),
        points=state.contacts.points,
        forces=models.forces(f),
        spin_torques=models.spins(f),
    )


def cost_of(state: State) -> Cost:
    """Return the cost index (10) in the paper's unit; Phi is zero in a task that desires no contacts."""
    phi_mm2 = 0.0
    if state.model.task.desired_contacts is not None:
        phi_mm2 = 1e6 * float(((state.contacts.points - state.desired) ** 2).sum())
    V = state.forces.V
    return Cost(phi_mm2 + state.model.task.force_weight * V, phi_mm2, V)


def grasp_of(start: int | None, state: State, claim: Claim, certificate: Certificate) -> Grasp:
    """Return the grasp at a state with everything derived from it.

    Args:
        start: index of the start that led to it, if one did.
        state: the state.
        claim: what it claims.
        certificate: of the claim.
    """
    robot = state.model.robot
    hand_angles = robot.joint_positions(state.configuration.posture)[robot.hand_joints]
    reference = hand_angles + state.statics.reference_displacement(state.forces.y)
    names = [robot.joint_names[joint] for joint in robot.hand_joints]
    normals, T_world_pads = state.surface[1], pad_poses(state.configuration)
    posture = robot.wrapped(state.configuration.posture)
    return Grasp(
        start=start,
        count=0 if start is None else 1,
        joints=claim.joints,
        q_arm=posture[: robot.arm_size],
        synergy=posture[robot.arm_size :],
        contact_parameters=state.x[robot.posture_size :],
        internal_forces=state.forces.y,
        q_r=dict(zip(names, reference.tolist(), strict=True)),
        cost=cost_of(state),
        contacts=tuple(
            Contact(
                pad=pad.name,
                link=pad.link,
                point=claim.points[i],
                normal=normals[i],
                force=claim.forces[i],
                spin_torque=float(claim.spin_torques[i]),
                desired_point=None if state.model.task.desired_contacts is None else state.desired[i],
                T_world_pad=T_world_pads[i],
            )
            for i, pad in enumerate(robot.description.pads)
        ),
        certificate=certificate,
        T_world_wrist=wrist_pose(state.configuration),
    )


def exact(grasp: Grasp, model: TaskModel, verifier: Verifier) -> Grasp:
    """Return a grasp with normals and V from the triangles of its object, if it is uneven: the solver interpolates.

    Args:
        grasp: of the task.
        model: the task.
        verifier: of the same task.
    """
    if not model.surface.uneven:
        return grasp
    derived = verifier.derive(grasp.claim)
    return replace(
        grasp,
        cost=Cost(grasp.cost.phi_mm2 + model.task.force_weight * derived.V, grasp.cost.phi_mm2, derived.V),
        contacts=tuple(replace(c, normal=n) for c, n in zip(grasp.contacts, derived.normals, strict=True)),
    )
