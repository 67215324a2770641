"""Wrenches that a set of contacts balances, on plain arrays.

Point j of the footprint of contact i transmits a force f_j and, for a soft finger, a spin torque m_j about the pad's
outward normal n. With f_n = n . f_j, f_t the rest of f_j, e the torsional friction radius and F_i the sum of the f_j of
contact i, the contacts can exert the forces with

    norm(f_t, m_j / e) <= mu f_n            Coulomb at every point (elliptic with the spin torque; hard finger: m_j = 0)
    n . F_i >= f_min                        for every contact
    norm(F_i) <= f_max                      for every contact, if f_max is finite
    sum_j t_j . (f_j, m_j) = tau            the drive squeezes with the torque that it has

Two questions are answered about a wrench w on the object, force and torque about its centre of mass:

    multiples    max a  with  w + a d + sum_j G_j (f_j, m_j) = 0,  a >= 0, for each of several wrenches d
    margin       max s  with  w + sum_j G_j (f_j, m_j) = 0  and s more than is needed left in every inequality, N

Balance and drive are linear, E x = (-w - a d, tau) for the components x of all forces. What the left null space of E
sees of the right-hand side no forces balance, whatever their size: for two hard fingers a torque about the line that
joins them. As no grasp is exact, a share of `SHARE` of a wrench is left alone there; beyond, the multiple is 0 and the
margin -inf.

Torques are divided by a length, the size of the object, so that all rows are in N.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Indices, Mask, cross
from .cone_programs import Cones, maximised

SHARE = 2e-3
"""Share of a wrench, torques over the length, that may stay unbalanced in a direction that no forces balance."""
_RANK = 1e-7
"""Relative size below which a singular value of E counts as zero."""
_NUDGES = (1e-7, -1e-7, 1e-6, -1e-6)
"""Changes of a wrench, in parts of it, that are tried where the solver gives up: on a few wrenches in a thousand."""


@dataclass(frozen=True)
class Limits:
    """Limits of contact forces."""

    friction: float
    """mu."""
    least: float
    """f_min, N."""
    most: float
    """f_max, N; infinite: the drive alone bounds the forces."""


@dataclass(frozen=True)
class ContactPoints:
    """The points of all footprints, contact by contact, world frame; p points."""

    contact: Indices
    """Number of the contact of each point, from 0, in order, shape (p,)."""
    points: Array
    """m, shape (p, 3)."""
    normals: Array
    """Outward normals of the pads, into the object, shape (p, 3)."""
    torsion_radius: Array
    """e, m, 0 for hard fingers, shape (p,)."""
    drive: Array
    """Torque of the drive per newton of f_j along x, y, z and per newton metre of m_j, shape (p, 4)."""


class BalanceProblem:
    """The forces that contacts can exert on an object, and what they balance.

    Args:
        at: the points of the contacts.
        drive_torque: tau, in the unit of `at.drive` times N.
        limits: friction and force limits.
        center_of_mass: of the object, world, m, shape (3,).
        length: by which torques are divided, m: the size of the object.
    """

    def __init__(
        self, at: ContactPoints, drive_torque: float, limits: Limits, center_of_mass: Array, length: float
    ) -> None:
        self._length = length
        columns = _Columns.of(at)
        arms = (at.points - center_of_mass)[columns.point]
        torques = cross(arms, columns.forces) + columns.torques
        size = float(np.abs(columns.drives).max(initial=0.0))
        # A hand whose drive the contacts do not feel squeezes with nothing: no row.
        drives, self._tau = ([columns.drives / size], [drive_torque / size]) if size > 0.0 else ([], [])
        self._equations = np.vstack([columns.forces.T, torques.T / length, *drives])
        self._cones = _cones(at, columns, limits)

    @cached_property
    def _ranges(self) -> tuple[Array, Array]:
        """Orthonormal bases of the range of E and of its left null space, in columns."""
        U, sigma, _ = np.linalg.svd(self._equations)
        rank = int((sigma > _RANK * sigma[0]).sum())
        return U[:, :rank], U[:, rank:]

    def multiples(self, wrench: Array, directions: Array) -> Array:
        """Return by how much of each direction the wrench may grow, shape (directions,).

        It is 0 where the wrench alone is not balanced, infinite where nothing bounds it (fingers that friction locks),
        and not a number where the solver fails.

        Args:
            wrench: w, force and torque about the centre of mass, N and N m, shape (6,).
            directions: d, the same, not zero, shape (directions, 6).
        """
        return _first_found(lambda share: self._multiples(share * wrench, directions))

    def _multiples(self, wrench: Array, directions: Array) -> Array:
        load, along = self._sides(wrench, 1.0), self._sides(directions, 0.0)
        found = np.zeros(len(directions))
        going = self._in_reach(along) & self._in_reach(load[None])
        if going.any():
            E = self._ranges[0].T @ self._equations
            growth = np.column_stack([-along[going] @ self._ranges[0], np.zeros((going.sum(), len(self._cones.rows)))])
            found[going] = maximised(E, self._ranges[0].T @ load, self._cones, growth, positive=True)
        return found

    def margin(self, wrench: Array) -> float:
        """Return the slack left in every inequality when the wrench is balanced, N; negative if it cannot be.

        It is infinite where friction locks the fingers, and not a number where the solver fails.

        Args:
            wrench: force and torque about the centre of mass, N and N m, shape (6,).
        """
        return float(_first_found(lambda share: self._margin(share * wrench))[0])

    def _margin(self, wrench: Array) -> Array:
        load = self._sides(wrench, 1.0)
        if not self._in_reach(load[None])[0]:
            return np.array([-math.inf])
        E = self._ranges[0].T @ self._equations
        left = np.concatenate([np.zeros(len(E)), self._cones.heads])[None]
        return maximised(E, self._ranges[0].T @ load, self._cones, left, positive=False)

    def _sides(self, wrenches: Array, drive: float) -> Array:
        """Return right-hand sides of E x = b for wrenches, shape (..., 6); `drive` is 1 to squeeze, 0 for a change."""
        forces, torques = wrenches[..., :3], wrenches[..., 3:] / self._length
        tau = np.broadcast_to([drive * tau for tau in self._tau], (*wrenches.shape[:-1], len(self._tau)))
        return np.concatenate([-forces, -torques, tau], axis=-1)

    def _in_reach(self, sides: Array) -> Mask:
        missing = np.linalg.norm(sides @ self._ranges[1], axis=1)
        return np.asarray(missing <= SHARE * np.linalg.norm(sides, axis=1))


@dataclass(frozen=True)
class _Columns:
    """The components of all forces: pressing, two tangential ones and, for soft fingers, spin, all in N."""

    point: Indices
    """Shape (n,)."""
    kind: Indices
    """0 pressing, 1 and 2 tangential, 3 spin, shape (n,)."""
    forces: Array
    """Force of a unit, world, shape (n, 3)."""
    torques: Array
    """Torque of a unit besides that of the force, world, m, shape (n, 3)."""
    drives: Array
    """Drive torque of a unit, shape (n,)."""

    @classmethod
    def of(cls, at: ContactPoints) -> _Columns:
        least = np.eye(3)[np.abs(at.normals).argmin(axis=1)]
        first = cross(least, at.normals)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        axes = np.stack([at.normals, first, cross(at.normals, first)], axis=1)
        count = len(at.points)
        forces = np.zeros((count, 4, 3))
        forces[:, :3] = axes
        torques = np.zeros((count, 4, 3))
        torques[:, 3] = at.torsion_radius[:, None] * at.normals
        drives = np.einsum("pkx,px->pk", forces, at.drive[:, :3])
        drives[:, 3] = at.torsion_radius * at.drive[:, 3]
        point, kind = np.nonzero(np.column_stack([np.ones((count, 3), dtype=bool), at.torsion_radius > 0.0]))
        return cls(point, kind, forces[point, kind], torques[point, kind], drives[point, kind])


def _cones(at: ContactPoints, columns: _Columns, limits: Limits) -> Cones:
    count, contacts = len(at.points), int(at.contact[-1]) + 1
    of_contact = at.contact[columns.point]
    presses = columns.kind == 0
    pressing = (of_contact == np.arange(contacts)[:, None]) * presses
    coulomb = np.diag(np.where(presses, limits.friction, 1.0))
    sizes = np.bincount(columns.point, minlength=count)
    least = -limits.least * np.ones(contacts)
    rows, offsets = [pressing, coulomb], [least, np.zeros(len(presses))]
    heads, limited = [np.ones(contacts, dtype=bool), presses], contacts if math.isfinite(limits.most) else 0
    for contact in range(limited):
        total = np.where(of_contact == contact, columns.forces.T, 0.0)
        rows.append(np.vstack([np.zeros(len(presses)), total]))
        offsets.append(np.array([limits.most, 0.0, 0.0, 0.0]))
        heads.append(np.array([True, False, False, False]))
    return Cones(
        np.concatenate(rows),
        np.concatenate(offsets),
        np.concatenate(heads),
        contacts,
        (*sizes.tolist(), *[4] * limited),
    )


def _first_found(solve: Callable[[float], Array]) -> Array:
    """Return the solution for the wrench, or for one next to it where the solver gives up.

    It is not a number where the solver always does.

    Args:
        solve: the solution for a multiple of the wrench.
    """
    found = solve(1.0)
    for nudge in _NUDGES:
        if not np.isnan(found).any():
            break
        found = np.where(np.isnan(found), solve(1.0 + nudge), found)
    return found
