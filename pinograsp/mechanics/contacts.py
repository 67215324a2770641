"""Contacts as arrays.

A contact i transmits a force F_i (three components, world axes) and, for a soft finger, a spin torque m_i
about its normal n_i (pointing into the object). The contact force vector f in R^c stacks, contact by contact,
F_i and then m_i where there is one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Indices


@dataclass(frozen=True)
class ContactModels:
    """What the contacts can transmit; constant over a problem."""

    torsion_radius: Array
    """e of each contact, m, shape (n,); 0 for a hard finger."""
    contact_compliance: Array
    """Diagonal of C_s, m/N for forces and rad/(N m) for spin torques, shape (c,)."""

    @classmethod
    def hard(cls, count: int, stiffness: float) -> ContactModels:
        """Return `count` hard fingers of the given structural stiffness k_stru, N/m."""
        return cls(np.zeros(count), np.full(3 * count, 1.0 / stiffness))

    @cached_property
    def count(self) -> int:
        """Number of contacts."""
        return len(self.torsion_radius)

    @cached_property
    def soft(self) -> Indices:
        """Indices of the soft fingers."""
        return np.flatnonzero(self.torsion_radius > 0)

    @cached_property
    def force_rows(self) -> Indices:
        """Rows of f that hold F_i, shape (n, 3)."""
        sizes = 3 + (self.torsion_radius > 0)
        first = np.concatenate([[0], np.cumsum(sizes)[:-1]])
        rows: Indices = first[:, None] + np.arange(3)
        return rows

    @cached_property
    def spin_rows(self) -> Indices:
        """Rows of f that hold m_i, shape (soft,)."""
        rows: Indices = self.force_rows[self.soft, 2] + 1
        return rows

    @cached_property
    def inverse_radius(self) -> Array:
        """1 / e of the soft fingers, shape (soft,)."""
        return np.asarray(1.0 / self.torsion_radius[self.soft])

    def forces(self, f: Array) -> Array:
        """Return the force of every contact, shape (n, 3)."""
        return f[self.force_rows]

    def spins(self, f: Array) -> Array:
        """Return the spin torque of every contact (zero for hard fingers), shape (n,)."""
        spins = np.zeros(self.count)
        spins[self.soft] = f[self.spin_rows]
        return spins

    @cached_property
    def grasp_template(self) -> Array:
        """The part of G that no configuration changes, shape (6, c): a force on the object is its sum."""
        G = np.zeros((6, len(self.contact_compliance)))
        for rows in self.force_rows:
            G[:3, rows] = np.eye(3)
        return G

    @cached_property
    def structural_compliance(self) -> Array:
        """C_s, shape (c, c)."""
        return np.diag(self.contact_compliance)

    def wrenches(self, f: Array, normals: Array) -> Array:
        """Return force and torque at every contact point, shape (n, 6), for normals of shape (n, 3)."""
        wrenches = np.zeros((self.count, 6))
        wrenches[:, :3] = f[self.force_rows]
        if self.soft.size:
            wrenches[self.soft, 3:] = f[self.spin_rows, None] * normals[self.soft]
        return wrenches


@dataclass(frozen=True)
class Contacts:
    """A configuration of n contacts of a hand with h joints; world frame."""

    points: Array
    """m, shape (n, 3)."""
    normals: Array
    """Unit normals into the object, shape (n, 3)."""
    jacobians: Array
    """Twist (linear at the contact point, angular) per hand joint rate, shape (n, 6, h)."""


@dataclass(frozen=True)
class ContactDerivatives:
    """Derivatives of `Contacts` with respect to v variables."""

    points: Array
    """Shape (n, 3, v)."""
    normals: Array
    """Shape (n, 3, v)."""
    jacobians: Array
    """Shape (n, 6, h, v)."""
