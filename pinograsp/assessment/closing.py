"""The gripper closes again: where pads and object come to rest when the object is not where it was thought to be.

The arm stands still. The hand closes until all pads bear, and the object gives way to it: it moves as little as it can
(quasi-statically, with no more than the pads push). From its displaced pose it moves by xi = (v, omega), v of the
origin of its frame, omega as a rotation vector. With the hand's variables y = (synergies, contact parameters), the
conditions are those of a grasp, in metres, rho the size of the object:

    c(xi, y) = ( signed distance of every contact point,  rho (n_pad + n_object) of every contact )  = 0

Of all motions that keep them the one is wanted that moves the object least, and of the hands that go with it the one
nearest to y_0, where the search begins:

    first     minimise  |c|^2 / CONTACT^2  +  |v|^2 + rho^2 |omega|^2  +  HAND^2 |y - y_0|^2     over xi and y
    second    minimise  |c|^2 / CONTACT^2  +  |y - y_0|^2                                        over y

with y in units that slide a contact by a metre. CONTACT = 1e-3 makes c vanish to micrometres and leaves alone what
yields less than a thousandth of the motion: pads that are parallel whatever the hand does cannot both be tilted.
HAND = 1e-2 puts the object before the hand: the object moves by 1e-4 of what the hand could do in its place.
Levenberg-Marquardt steps lead there; one that leaves c = 0, which curves, is brought back by a second one. If what of
the object is at the contact point p moves by dp, the distance there changes by -n . dp, and the normal by
omega x n - H dp, H the Hessian of the distance. On a mesh n and H are those of the smoothed distance, which pads feel,
and a contact bears within the tilt that the rubber of its pad evens out.

Bounds. A synergy that comes to its limit stays there. A contact that leaves its pad is not drawn back: it may slide
along its footprint, with object and fingers where they are (a flat pad on a flat side touches at other points too); if
that does not bring it onto the pad, contact is lost.

What is left out: what the object stands on or runs into as it gives way, its weight and friction meanwhile, the way
the open fingers come to it, rubber that yields, and an arm or finger that bends. A hand of several synergies is taken
to close as it was planned to, each finger until it touches. A pad that is a line is taken at its word: contact is on
the line, and the object is drawn to it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Mask, skew
from ..geometry.patches import half_sides
from ..geometry.shapes import Surface
from ..kinematics.contacts import ContactKinematics, contact_kinematics
from ..kinematics.forward import Configuration, forward
from ..kinematics.robot import SLIP_STEP, Robot

CONTACT = 1e-3
HAND = 1e-2
STEPS = 60
DONE = 1e-8
"""Length of a step, m, after which the search ends."""
GAIN = 1e-12
"""Decrease of the sum, m^2, below which it ends as well."""
GAP, TILT = 1e-5, 1e-3
"""Gap, m, and angle, rad, of a contact that bears: half of what the verification allows where rubber does not yield."""


@dataclass(frozen=True)
class Closed:
    """A hand that has closed, and the object in it."""

    posture: Array
    """(q_a, sigma), shape (l + s,)."""
    T_world_object: Array
    """Where the object has come to, shape (4, 4)."""
    points: Array
    """Contact points, world, m, shape (n, 3)."""
    rotations: Array
    """Of the pads' frames in the world, shape (n, 3, 3)."""
    left: bool = False
    """Whether a contact has left its pad; its point is then the nearest one on the rim."""


@dataclass(frozen=True)
class _Place:
    """An iterate and the conditions there."""

    z: Array
    """(v, rho omega, y), m, shape (6 + s + c,)."""
    T: Array
    """Pose of the object, shape (4, 4)."""
    configuration: Configuration
    contacts: ContactKinematics
    values: Array
    """c, m, shape (4 n,)."""
    jacobian: Array
    """Of c in z, shape (4 n, 6 + s + c)."""


class Closing:
    """Closes a hand on an object as a grasp has planned it.

    Args:
        robot: with the pads of the task, mounted.
        surface: of the object.
        q_arm: where the arm was planned to stand, rad (m), shape (l,).
        hand: planned synergies and contact parameters, (sigma, q_c), shape (s + c,).
        T_world_object: where the object was planned to be, shape (4, 4).
    """

    def __init__(self, robot: Robot, surface: Surface, q_arm: Array, hand: Array, T_world_object: Array) -> None:
        self._robot, self._surface = robot, surface
        self.size = surface.radius
        """Of the object: radius of a ball about its frame's origin that holds it, m."""
        yielding = [pad.description.rubber_depth / half_sides(pad.patch).max() for pad in robot.pads]
        self._tilts = np.array(yielding) if surface.uneven else np.full(len(robot.pads), TILT)
        self._data = robot.model.createData()
        arm, (low, high) = robot.arm_size, robot.parameter_limits.T
        self._hand = robot.posture_size - arm
        self._unit = robot.step_units[arm:] / SLIP_STEP
        anywhere = np.full(6, np.inf)
        self._lower = np.concatenate([-anywhere, np.concatenate([robot.lower[arm:], low]) / self._unit])
        self._upper = np.concatenate([anywhere, np.concatenate([robot.upper[arm:], high]) / self._unit])
        self._slides = np.arange(len(self._lower)) >= 6 + self._hand
        self._as_planned = np.concatenate([np.zeros(6), hand / self._unit])
        planned = self._place(q_arm, T_world_object, self._as_planned)
        self.planned = self._result(planned)
        """Hand and object of the grasp."""
        self._touched = (planned.contacts.points - T_world_object[:3, 3]) @ T_world_object[:3, :3]

    def closed(self, q_arm: Array, T_world_object: Array) -> Closed:
        """Return where hand and object come to rest; whether the pads bear there is left to the verification.

        The search begins with the pads at the points of the object that they were planned to touch, as far as they
        reach there, and once more with the contact points where they were planned to be on the pads.

        Args:
            q_arm: where the arm stands, rad (m), shape (l,).
            T_world_object: where the object is before the hand closes, shape (4, 4).
        """
        place = self._place(q_arm, T_world_object, np.clip(self._as_planned, self._lower, self._upper))
        followed, _ = self._settled(q_arm, T_world_object, self._following(q_arm, T_world_object, place))
        if self._bears(followed):
            return self._result(followed)
        kept, left = self._settled(q_arm, T_world_object, place)
        return self._result(kept, left=left and not self._bears(kept))

    def _settled(self, q_arm: Array, T_displaced: Array, place: _Place) -> tuple[_Place, bool]:
        """Return where hand and object come to rest, contacts on their pads, and whether some had left them."""
        anywhere, origin = np.where(self._slides, np.inf, 0.0), place.z
        bounds = self._lower - anywhere, self._upper + anywhere
        place = self._solved(q_arm, T_displaced, place, origin, np.ones(len(origin), dtype=bool), bounds)
        place = self._solved(q_arm, T_displaced, place, origin, np.arange(len(origin)) >= 6, bounds)
        on_pads = np.clip(place.z, self._lower, self._upper)
        if (on_pads == place.z).all():
            return place, False
        place = self._place(q_arm, T_displaced, on_pads)
        if not self._bears(place):
            place = self._solved(q_arm, T_displaced, place, origin, self._slides, (self._lower, self._upper))
        return place, True

    def _following(self, q_arm: Array, T_displaced: Array, place: _Place) -> _Place:
        """Return the pads with their contact points where they were planned to touch the object, or nearest to it."""
        wanted = self._touched @ T_displaced[:3, :3].T + T_displaced[:3, 3]
        d_points = place.contacts.d_points[:, :, self._robot.arm_size :] * self._unit
        sliding = self._slides[6:]
        z = place.z.copy()
        away = (wanted - place.contacts.points).ravel()
        z[self._slides] += np.linalg.lstsq(d_points[:, :, sliding].reshape(len(away), -1), away, rcond=None)[0]
        return self._place(q_arm, T_displaced, np.clip(z, self._lower, self._upper))

    def _result(self, place: _Place, left: bool = False) -> Closed:
        pads = self._robot.pads
        rotations = place.configuration.rotations[[pad.joint for pad in pads]] @ np.array(
            [pad.rotation for pad in pads]
        )
        return Closed(place.configuration.posture, place.T, place.contacts.points, rotations, left)

    def _bears(self, place: _Place) -> bool:
        """Whether every contact is on the object's surface, pad and object tangent."""
        gaps, tilts = np.split(np.abs(place.values), [len(self._robot.pads)])
        return bool(gaps.max() < GAP and (tilts.reshape(-1, 3).max(axis=1) < self._tilts * self.size).all())

    def _place(self, q_arm: Array, T_displaced: Array, z: Array) -> _Place:
        """Return the conditions where object and hand have moved to z; T_displaced is where the object was."""
        arm, n, variables = self._robot.arm_size, len(self._robot.pads), self._unit * z[6:]
        posture = np.concatenate([q_arm, variables[: self._hand]])
        configuration = forward(self._robot, self._data, posture)
        contacts = contact_kinematics(configuration, variables[self._hand :])
        T, turn = moved(T_displaced, z[:3], z[3:6] / self.size)
        R, arms = T[:3, :3], contacts.points - T[:3, 3]
        distances, gradients, _ = self._surface.signed_distance(arms @ R)
        normals, turning = self._surface.footprint(arms @ R)
        gradients, normals, turning = gradients @ R.T, normals @ R.T, R @ turning @ R.T
        # Of pads against the object, in z: how points and normals move.
        points, directions = np.zeros((n, 3, len(z))), np.zeros((n, 3, len(z)))
        points[:, :, :3], points[:, :, 3:6] = -np.eye(3), skew(arms) @ (turn / self.size)
        points[:, :, 6:] = contacts.d_points[:, :, arm:] * self._unit
        directions[:, :, 3:6] = -skew(normals) @ (turn / self.size)
        directions[:, :, 6:] = contacts.d_normals[:, :, arm:] * self._unit
        values = np.concatenate([distances, self.size * (contacts.normals + normals).ravel()])
        d_sums = self.size * (directions + turning @ points)
        jacobian = np.vstack([(gradients[:, None] @ points)[:, 0], d_sums.reshape(3 * n, -1)])
        return _Place(z, T, configuration, contacts, values, jacobian)

    def _solved(
        self,
        q_arm: Array,
        T_displaced: Array,
        place: _Place,
        origin: Array,
        free: Mask,
        bounds: tuple[Array, Array],
    ) -> _Place:
        """Return where Levenberg-Marquardt steps of the free variables lead, within bounds.

        Motion is counted from `origin`; that of the hand counts for little if the object is free.
        """
        (lower, upper), hand = bounds, np.arange(len(free)) >= 6
        weights = np.where(hand & free[0], HAND, 1.0)
        square = _square(place, weights, origin)
        damping = 1.0
        for _ in range(STEPS):
            J, rest = place.jacobian / CONTACT, weights**2 * (place.z - origin)
            gradient = J.T @ place.values / CONTACT + rest
            moving = free & ~((place.z <= lower) & (gradient > 0.0)) & ~((place.z >= upper) & (gradient < 0.0))
            H = J[:, moving].T @ J[:, moving] + np.diag(weights[moving] ** 2 + damping * weights[moving])
            step = np.zeros_like(place.z)
            step[moving] = -_solution(H, gradient[moving])
            trial = self._place(q_arm, T_displaced, np.clip(place.z + step, lower, upper))
            length = float(np.abs(trial.z - place.z).max())
            trial_square = _square(trial, weights, origin)
            if trial_square > square:  # the conditions curve away from the step: back onto them
                step[moving] = -_solution(H, (J.T @ trial.values / CONTACT)[moving])
                trial = self._place(q_arm, T_displaced, np.clip(trial.z + step, lower, upper))
                trial_square = _square(trial, weights, origin)
            gained = square - trial_square
            if gained >= 0.0:
                place, square, damping = trial, trial_square, 0.1 * damping
            else:
                damping *= 10.0
            if length < DONE or 0.0 <= gained < GAIN:
                break
        return place


def _solution(H: Array, gradient: Array) -> Array:
    """Return the solution of H x = gradient; the shortest one where what damps H is lost in rounding."""
    try:
        return np.asarray(np.linalg.solve(H, gradient))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(H, gradient, rcond=None)[0])


def _square(place: _Place, weights: Array, origin: Array) -> float:
    change = weights * (place.z - origin)
    return float(place.values @ place.values) / CONTACT**2 + float(change @ change)


def moved(T: Array, v: Array, omega: Array) -> tuple[Array, Array]:
    """Return a pose moved by v, m, and turned in place by the rotation vector omega, and how the turn grows with omega.

    Returns:
        T: shape (4, 4).
        J: left Jacobian of the rotation: d omega turns the moved frame by J d omega, world axes, shape (3, 3).
    """
    angle, X = float(np.linalg.norm(omega)), skew(omega)
    first, second, third = 1.0, 0.5, 1.0 / 6.0
    if angle > 1e-6:
        first, second = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle**2
        third = (1.0 - first) / angle**2
    result = T.copy()
    result[:3, :3] = (np.eye(3) + first * X + second * X @ X) @ T[:3, :3]
    result[:3, 3] += v
    return result, np.eye(3) + second * X + third * X @ X
