"""Grasp matrix, stiffness and the maps of forces, (1)-(7).

Wrenches are (force, torque about the centre of mass) on the object. Torques are divided by a length rho, the
size of the object, so that all six rows of G have one unit and ranks and residuals mean something.

With f the forces on the object and w the external wrench, balance is w + G f = 0. Two hard fingers leave G
with rank 5 and G K G^T singular, so (6) takes the pseudo-inverse: G_K^R = K G^T (G K G^T)^+, and
P = G G_K^R projects on the wrenches that the contacts can exert. The rest, (I - P) w, no force balances.

    f = -G_K^R w + E_s y,   range(E_s) = range(F_s),   F_s = (I - G_K^R G) K J S

F_s maps synergy displacements to active internal forces (G F_s = 0).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..compiled import compiled
from .contacts import ContactModels, Contacts, Rows

RANK_TOLERANCE = 1e-9
"""Relative size below which a singular value counts as zero."""


@dataclass(frozen=True)
class Hand:
    """The hand as far as the statics go; constant over a problem."""

    synergies: Array
    """S (3), shape (h, s)."""
    joint_compliance: Array
    """Diagonal of C_q, rad / (N m), shape (h,)."""


@dataclass(frozen=True)
class Load:
    """The wrench to balance; constant over a problem."""

    center_of_mass: Array
    """World, m, shape (3,)."""
    wrench: Array
    """External force and torque about the centre of mass, world, N and N m, shape (6,)."""
    rho: float
    """Length that divides torques, m."""

    @cached_property
    def scaled(self) -> Array:
        """The wrench with its torque divided by rho, N, shape (6,)."""
        return np.concatenate([self.wrench[:3], self.wrench[3:] / self.rho])


@dataclass(frozen=True)
class Statics:
    """The matrices of a grasp with c force components, h hand joints and s synergies."""

    hand: Hand
    load: Load
    G: Array
    """Grasp matrix, torque rows divided by rho, shape (6, c)."""
    J: Array
    """Hand Jacobian, shape (c, h)."""
    K: Array
    """Hand stiffness (C_s + J C_q J^T)^-1, shape (c, c)."""
    compliance_inverse: Array
    """(G K G^T)^+, shape (6, 6)."""
    G_K_R: Array
    """K-weighted pseudo-inverse of G (6), shape (c, 6)."""
    F_s: Array
    """Synergy displacements to active internal forces, shape (c, s)."""
    E_s: Array
    """Basis of the active internal forces, orthonormal with spin torques divided by their radius e, shape (c, e_s);
    each column squeezes for y > 0."""
    E_s_to_synergies: Array
    """F_s^+ E_s: the synergy displacement of least norm for each column of E_s, shape (s, e_s)."""
    f_p: Array
    """Particular solution -G_K^R w, shape (c,)."""
    residual: Array
    """Wrench that no contact force balances, w + G f, torque divided by rho, N, shape (6,)."""

    def reference_displacement(self, y: Array) -> Array:
        """Return q_r - q = S delta sigma (3), shape (h,): how far the reference moves beyond contact."""
        return np.asarray(self.hand.synergies @ (self.E_s_to_synergies @ y))


def grasp_statics(contacts: Contacts, models: ContactModels, hand: Hand, load: Load) -> Statics:
    """Build the matrices of sections 3.1 and 3.2.

    Args:
        contacts: contact points, normals into the object and hand Jacobians, world frame.
        models: contact models and structural compliance.
        hand: synergy matrix and joint compliance.
        load: external wrench and where it acts.
    """
    matrices = _matrices(
        contacts,
        load.center_of_mass,
        models.rows,
        models.contact_compliance,
        hand.joint_compliance,
        hand.synergies,
        load.scaled,
        load.rho,
    )
    return Statics(hand, load, *matrices)


@compiled
def _matrices(
    contacts: Contacts,
    center: Array,
    rows: Rows,
    contact_compliance: Array,
    joint_compliance: Array,
    synergies: Array,
    wrench: Array,
    rho: float,
) -> tuple[Array, Array, Array, Array, Array, Array, Array, Array, Array, Array]:
    """Return the matrices of `Statics` in their order."""
    G = np.zeros((6, len(contact_compliance)))
    J = np.zeros((len(contact_compliance), len(joint_compliance)))
    normals, jacobians = contacts.normals, contacts.jacobians
    for i in range(len(normals)):
        force, spin = rows.force[i], rows.spin[i]
        x, y, z = (contacts.points[i] - center) / rho
        G[3, force + 1], G[3, force + 2] = -z, y
        G[4, force], G[4, force + 2] = z, -x
        G[5, force], G[5, force + 1] = -y, x
        for axis in range(3):
            G[axis, force + axis] = 1.0
            if spin >= 0:
                G[3 + axis, spin] = normals[i, axis] / rho
            for joint in range(len(joint_compliance)):
                J[force + axis, joint] = jacobians[i, axis, joint]
                if spin >= 0:
                    J[spin, joint] += normals[i, axis] * jacobians[i, 3 + axis, joint]
    compliance = (J * joint_compliance) @ J.T
    for row in range(len(compliance)):
        compliance[row, row] += contact_compliance[row]
    K: Array = np.linalg.inv(compliance).astype(np.float64)
    KGt = K @ G.T
    inverse, rank = _pseudo_inverse(G @ KGt)
    G_K_R = KGt @ inverse
    KJS = K @ (J @ synergies)
    F_s = KJS - G_K_R @ (G @ KJS)
    E_s, to_synergies = _internal_basis(F_s, KJS, normals, rows, len(K) - rank)
    E_s = E_s - G_K_R @ (G @ E_s)  # of weak synergies, rounding would not balance
    f_p = -(G_K_R @ wrench)
    return G, J, K, inverse, G_K_R, F_s, E_s, to_synergies, f_p, wrench + G @ f_p


@compiled
def _pseudo_inverse(A: Array) -> tuple[Array, int]:
    """Return A^+ of a symmetric positive semidefinite matrix, and its rank."""
    values, vectors = np.linalg.eigh(A)
    inverse, rank = np.zeros(A.shape), 0
    for k in range(len(values)):
        if values[k] > RANK_TOLERANCE * values[-1]:
            rank += 1
            for i in range(len(values)):
                for j in range(len(values)):
                    inverse[i, j] += vectors[i, k] * vectors[j, k] / values[k]
    return inverse, rank


@compiled
def _internal_basis(F_s: Array, KJS: Array, normals: Array, rows: Rows, most: int) -> tuple[Array, Array]:
    """Return E_s and F_s^+ E_s from the singular value decomposition of F_s, spin torques divided by their radius e.

    A singular value counts as zero against the scale of K J S, of which F_s is a projection: a hand that cannot
    squeeze has e_s = 0. Nor has it more than the internal forces have dimensions (`most`): what is beyond is rounding,
    which grows with the distance of the contacts from the centre of mass. Signs are chosen so that y > 0 presses on
    the object.
    """
    in_newtons = np.ones(len(F_s))
    for i in range(len(rows.spin)):
        if rows.spin[i] >= 0:
            in_newtons[rows.spin[i]] = rows.inverse_radius[i]
    U, values, Vt = np.linalg.svd(F_s * in_newtons.reshape(-1, 1), full_matrices=False)
    least = RANK_TOLERANCE * np.abs(KJS * in_newtons.reshape(-1, 1)).max()
    rank = 0
    while rank < min(most, len(values)) and values[rank] > least:
        rank += 1
    E, back = np.empty((len(U), rank)), np.empty((Vt.shape[1], rank))
    for k in range(rank):
        pressing = 0.0
        for i in range(len(rows.force)):
            for axis in range(3):
                pressing += normals[i, axis] * U[rows.force[i] + axis, k]
        sign = -1.0 if pressing < 0.0 else 1.0
        for j in range(len(E)):
            E[j, k] = sign * U[j, k] / in_newtons[j]
        for j in range(len(back)):
            back[j, k] = sign * Vt[k, j] / values[k]
    return E, back
