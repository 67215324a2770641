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

import numpy as np

from ..arrays import Array, skew
from .contacts import ContactModels, Contacts

RANK_TOLERANCE = 1e-9
"""Relative size below which a singular value counts as zero."""


@dataclass(frozen=True)
class Hand:
    """What the statics need to know of a hand; constant over a problem."""

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

    @property
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
    """Orthonormal basis of the active internal forces, shape (c, e_s); each column squeezes for y > 0."""
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
    G = models.grasp_template.copy()
    lever = skew((contacts.points - load.center_of_mass) / load.rho)
    for rows, block in zip(models.force_rows, lever, strict=True):
        G[3:, rows[0] : rows[0] + 3] = block
    J = np.empty((len(models.contact_compliance), len(hand.joint_compliance)))
    J[models.force_rows] = contacts.jacobians[:, :3]
    for i, row in zip(models.soft, models.spin_rows, strict=True):
        G[3:, row] = contacts.normals[i] / load.rho
        J[row] = contacts.normals[i] @ contacts.jacobians[i, 3:]
    K = np.asarray(np.linalg.inv(models.structural_compliance + (J * hand.joint_compliance) @ J.T), dtype=float)
    KGt = K @ G.T
    inverse = _pseudo_inverse(G @ KGt)
    G_K_R = KGt @ inverse
    KJS = np.asarray(K @ (J @ hand.synergies))
    F_s: Array = KJS - G_K_R @ (G @ KJS)
    E_s, to_synergies = _internal_basis(F_s, KJS, models, contacts.normals)
    wrench = load.scaled
    f_p = np.asarray(-G_K_R @ wrench)
    residual = np.asarray(wrench + G @ f_p)
    return Statics(hand, load, G, J, K, inverse, G_K_R, F_s, E_s, to_synergies, f_p, residual)


def _pseudo_inverse(A: Array) -> Array:
    """Return A^+ of a symmetric positive semidefinite matrix."""
    values, vectors = np.linalg.eigh(A)
    kept = values > RANK_TOLERANCE * values[-1]
    vectors = vectors[:, kept]
    return np.asarray((vectors / values[kept]) @ vectors.T)


def _internal_basis(F_s: Array, KJS: Array, models: ContactModels, normals: Array) -> tuple[Array, Array]:
    """Return E_s and F_s^+ E_s from the singular value decomposition of F_s.

    A singular value counts as zero against K J S, of which F_s is a projection: a hand that cannot squeeze
    has e_s = 0. Signs are chosen so that y > 0 presses on the object.
    """
    U, values, Vt = np.linalg.svd(F_s, full_matrices=False)
    kept = values > RANK_TOLERANCE * np.abs(KJS).max()
    E, back = U[:, kept], Vt[kept].T / values[kept]
    signs = np.where((normals.ravel() @ E[models.force_rows.ravel()]) < 0, -1.0, 1.0)
    return np.asarray(E * signs), np.asarray(back * signs)
