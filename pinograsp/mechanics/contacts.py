"""Contacts as arrays.

A contact i transmits a force F_i (three components, world axes) and, for a soft finger, a spin torque m_i
about its normal n_i (pointing into the object). The contact force vector f in R^c stacks, contact by contact,
F_i and then m_i where there is one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices


class Rows(NamedTuple):
    """Where the parts of f are."""

    force: Indices
    """First of the three rows of F_i, shape (n,)."""
    spin: Indices
    """Row of m_i, -1 for a hard finger, shape (n,)."""
    inverse_radius: Array
    """1 / e, 0 for a hard finger, 1/m, shape (n,)."""


@dataclass(frozen=True)
class ContactModels:
    """Components that the contacts transmit; constant over a problem."""

    torsion_radius: Array
    """e of each contact, m, shape (n,); 0 for a hard finger."""
    contact_compliance: Array
    """Diagonal of C_s, m/N for forces and rad/(N m) for spin torques, shape (c,)."""

    @classmethod
    def hard(cls, count: int, stiffness: float) -> ContactModels:
        """Return `count` hard fingers of the given structural stiffness k_stru, N/m."""
        return cls(np.zeros(count), np.full(3 * count, 1.0 / stiffness))

    @cached_property
    def rows(self) -> Rows:
        """Where the parts of f are."""
        soft = self.torsion_radius > 0
        first = np.cumsum(3 + soft) - (3 + soft)
        inverse = np.divide(1.0, self.torsion_radius, out=np.zeros(len(soft)), where=soft)
        return Rows(first, np.where(soft, first + 3, -1), inverse)

    def forces(self, f: Array) -> Array:
        """Return the force of every contact, shape (n, 3)."""
        return np.asarray(f[self.rows.force[:, None] + np.arange(3)])

    def spins(self, f: Array) -> Array:
        """Return the spin torque of every contact (zero for hard fingers), shape (n,)."""
        return np.where(self.rows.spin < 0, 0.0, f[self.rows.spin])


class Contacts(NamedTuple):
    """A configuration of n contacts of a hand with h joints; world frame."""

    points: Array
    """m, shape (n, 3)."""
    normals: Array
    """Unit normals into the object, shape (n, 3)."""
    jacobians: Array
    """Twist (linear at the contact point, angular) per hand joint rate, shape (n, 6, h)."""


class ContactDerivatives(NamedTuple):
    """Derivatives of `Contacts` with respect to v variables."""

    points: Array
    """Shape (n, 3, v)."""
    normals: Array
    """Shape (n, 3, v)."""
    jacobians: Array
    """Shape (n, 6, h, v)."""
