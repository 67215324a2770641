"""Wrench resistance: how strongly a held object may be accelerated before its grasp gives way.

The object of mass m weighs on its contacts with an inertial force m a d through its centre of mass as it is accelerated
by a against the direction d, and with a torque as it is turned. For the six directions d = +-x, +-y, +-z of the world

    Q_force    the least over d of the largest a such that the contacts balance the force m a d besides the load, m/s^2
    Q_torque   the same for the torque m a (50 mm) d about the centre of mass, m/s^2 with an arm of 50 mm

The contacts exert forces at the corners of their footprints (`footprint`; of large ones at most `CORNERS`, the contact
point among them), within friction and spin limits (`balance`). The load is what the planned forces balance, so
that a residual of the plan, which the balance figures judge, does not count here. The squeeze stays as planned: with
J_j the hand's Jacobian at the corner j, S the synergies and mimic joints in S, the driver torques of the plan are

    tau = S^T sum_i J_i^T f_i       and for the others   tau^T (S^T sum_j J_j^T f_j) = tau^T tau

One driver keeps its torque exactly, and with it bounds all forces: f_max, a limit of the plan, is nothing that makes an
object slip, neither in simulation nor in fact, and does not count. With so much friction that fingers lock in a
direction, a is infinite there, and others have the least. Several drivers, which hold positions rather than torques,
share the squeeze anew: only the combination that is planned is kept, and f_max counts, since nothing else bounds what a
finger bears. A hand whose drivers feel none of the planned forces keeps nothing.

Limits of the figures. Pads and object are rigid and pressures act at the footprint's corners, which is exact for points
and lines and close to it for areas; hand and arm do not yield; the object does not leave its contacts and touch
elsewhere. Where no forces balance a wrench, the figure is 0, and rightly so: two hard fingers with point contacts do
not resist a torque about the line that joins them, so that Q_torque is 0, and Q_force too unless the centre of mass is
on that line (up to the share `balance.SHARE` of the object's size).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, cross
from ..descriptions.hand import SoftFinger
from ..descriptions.task import Task
from .balance import BalanceProblem, ContactPoints, Limits
from .certificate import Certificate, Figure
from .claim import Claim
from .contacts import Pads
from .footprint import thinned

Q_FORCE, Q_TORQUE = "Q_force", "Q_torque"
"""Names of the figures."""
ARM = 0.05
"""Arm at which the forces of Q_torque act, m."""
CORNERS = 8
"""Most points of a footprint."""
MOST = 1e4
"""Largest value of the figures, m/s^2: where friction locks the fingers nothing bounds them."""
_DIRECTIONS = np.vstack([sign * np.eye(3)[axis] for axis in range(3) for sign in (1.0, -1.0)])
_NAMES = ("+x", "-x", "+y", "-y", "+z", "-z")


@dataclass(frozen=True)
class Hold:
    """A grasp as far as its resistance to wrenches goes."""

    problem: BalanceProblem
    """The wrenches that its contacts balance while the squeeze stays as planned."""
    load: Array
    """The wrench on the object that the planned forces balance: force and torque about the centre of mass, (6,)."""


def hold_of(
    claim: Claim,
    pads: Pads,
    normals: Array,
    areas: Sequence[Array],
    rates: Sequence[Array],
    task: Task,
    center_of_mass: Array,
    radius: float,
) -> Hold:
    """Return the resistance problem of a claim.

    Args:
        claim: contact points, planned forces and spin torques.
        pads: the pads at the claim's link poses.
        normals: of the contacts, into the object, world, shape (contacts, 3).
        areas: footprint of each contact, world, shape (k, 3), m.
        rates: of the link of each pad, its twist about the world's origin per unit of each synergy, (synergies, 6).
        task: friction and force limits.
        center_of_mass: of the object, world, shape (3,), m.
        radius: of the ball about the centre of mass that holds the object, m.
    """
    exerted = _exerted(claim, normals)
    torques = _felt(exerted, rates)
    size = float(np.linalg.norm(torques))
    squeeze = torques / size if size > 0.0 else torques
    corners = [_corners(area, point) for area, point in zip(areas, claim.points, strict=True)]
    contact = np.repeat(np.arange(len(corners)), [len(points) for points in corners])
    points, twists = np.concatenate(corners), (squeeze @ np.array(rates))[contact]
    drive = np.column_stack(
        [twists[:, :3] + cross(twists[:, 3:], points), (twists[:, 3:] * normals[contact]).sum(axis=1)]
    )
    radii = [pad.contact.torsion_radius if isinstance(pad.contact, SoftFinger) else 0.0 for pad in pads.pads]
    at = ContactPoints(contact, points, normals[contact], np.array(radii)[contact], drive)
    constants = task.contact
    most = math.inf if len(torques) == 1 else constants.max_force
    limits = Limits(constants.friction, constants.min_normal_force, most)
    force, torque = exerted[:, :3].sum(axis=0), exerted[:, 3:].sum(axis=0)
    load = -np.concatenate([force, torque - cross(center_of_mass, force)])
    return Hold(BalanceProblem(at, size, limits, center_of_mass, radius), load)


def drive_torques(claim: Claim, normals: Array, rates: Sequence[Array]) -> Array:
    """Return tau = S^T sum_i J_i^T f_i, N m (N) per unit of each synergy, (synergies,); arguments as for `hold_of`."""
    return _felt(_exerted(claim, normals), rates)


def _exerted(claim: Claim, normals: Array) -> Array:
    """Return force and torque about the world's origin that each contact exerts on the object, shape (contacts, 6)."""
    moments = cross(claim.points, claim.forces) + claim.spin_torques[:, None] * normals
    return np.column_stack([claim.forces, moments])


def _felt(exerted: Array, rates: Sequence[Array]) -> Array:
    """Return the drive torques of forces and torques about the world's origin, shape (synergies,)."""
    return np.asarray(np.einsum("isk,ik->s", np.array(rates), exerted))


def resistance_figures(hold: Hold, mass: float, least: float | None) -> tuple[Figure, ...]:
    """Return Q_force and Q_torque; where: the direction of the wrench that is withstood least.

    Args:
        hold: the grasp.
        mass: of the object, kg.
        least: Q_force that is wanted, m/s^2.
    """
    nothing = np.zeros((6, 3))
    forces = mass * np.hstack([_DIRECTIONS, nothing])
    torques = mass * ARM * np.hstack([nothing, _DIRECTIONS])
    Q = np.minimum(hold.problem.multiples(hold.load, np.vstack([forces, torques])), MOST).reshape(2, 6)
    limits = (-math.inf if least is None else least, -math.inf)
    return tuple(_figure(*given) for given in zip((Q_FORCE, Q_TORQUE), Q, limits, strict=True))


def is_graded(certificate: Certificate) -> bool:
    """Return whether a certificate has the figures of the resistance."""
    return Q_FORCE in certificate


def with_resistance(certificate: Certificate, figures: Sequence[Figure]) -> Certificate:
    """Return a certificate with the figures of the resistance after its own."""
    return Certificate((*certificate.figures, *figures))


def _figure(name: str, values: Array, limit: float) -> Figure:
    least = float(values.min())
    # The first of those that are equal but for rounding.
    worst = int(np.argmax(values <= least * (1.0 + 1e-6))) if math.isfinite(least) else 0
    return Figure(name, least, limit, "m/s^2", "at least", _NAMES[worst])


def _corners(area: Array, point: Array) -> Array:
    return area if len(area) <= CORNERS else np.vstack([thinned(area, CORNERS - 1), point])
