"""Figures of the contact forces: balance of the wrench, friction, force limits."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from ..descriptions.hand import PadDescription, SoftFinger
from ..descriptions.task import Task
from .certificate import Figure
from .claim import Claim


def balance_figures(
    claim: Claim, normals: Array, center_of_mass: Array, radius: float, wrench: Array, *, turn: float, balanced: bool
) -> list[Figure]:
    """Return the unbalanced force, N, and torque about the centre of mass, N m.

    Args:
        claim: points, forces and spin torques.
        normals: of the contacts, into the object, world, shape (contacts, 3).
        center_of_mass: of the object, world, shape (3,), m.
        radius: of the ball about the centre of mass that holds the object, m.
        wrench: external, force and torque about the centre of mass, world, N and N m, shape (6,).
        turn: how far normals may be off, and spin torques about them with them, rad.
        balanced: whether it must be balanced; if not, the limits are infinite.
    """
    force = claim.forces.sum(axis=0) + wrench[:3]
    torque = np.cross(claim.points - center_of_mass, claim.forces).sum(axis=0)
    torque = torque + claim.spin_torques @ normals + wrench[3:]
    weight, moment = float(np.linalg.norm(wrench[:3])), float(np.linalg.norm(wrench[3:]))
    force_limit = 1e-3 * weight if weight > 0.0 else 1e-6
    torque_limit = 2e-3 * max(weight * radius, moment, 1e-9)
    torque_limit += math.sin(turn) * float(np.abs(claim.spin_torques).sum())
    if not balanced:
        force_limit = torque_limit = math.inf
    return [
        Figure("force balance", float(np.linalg.norm(force)), force_limit, "N", "at most"),
        Figure("torque balance", float(np.linalg.norm(torque)), torque_limit, "N m", "at most"),
    ]


def force_figures(claim: Claim, inward: Array, pads: Sequence[PadDescription], task: Task) -> list[Figure]:
    """Return the figures of friction and force limits, N.

    Args:
        claim: forces and spin torques.
        inward: inward normals of the object at the contacts, world, shape (contacts, 3).
        pads: contact models, contact i on pad i.
        task: friction coefficient and force limits.
    """
    normal = np.einsum("ij,ij->i", claim.forces, inward)
    magnitude = np.linalg.norm(claim.forces, axis=1)
    spin = np.array([spin_force(t, pad) for t, pad in zip(claim.spin_torques, pads, strict=True)])
    alpha = 1.0 / math.sqrt(1.0 + task.contact.friction**2)
    slip = alpha * np.hypot(magnitude, spin) - normal
    slipping, lightest, strongest = int(slip.argmax()), int(normal.argmin()), int(magnitude.argmax())
    least, most = task.contact.min_normal_force, task.contact.max_force
    return [
        Figure("friction", float(slip[slipping]), 0.0, "N", "at most", pads[slipping].name),
        Figure("normal force", float(normal[lightest]), least, "N", "at least", pads[lightest].name),
        Figure("force limit", float(magnitude[strongest]), most, "N", "at most", pads[strongest].name),
    ]


def spin_force(torque: float, pad: PadDescription) -> float:
    """Return m_n / e, the share of a spin torque in the friction term, N; a hard finger bears no torque."""
    if isinstance(pad.contact, SoftFinger):
        return float(torque) / pad.contact.torsion_radius
    return math.inf if torque != 0.0 else 0.0
