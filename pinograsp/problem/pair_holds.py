"""Ways in which a hand can hold a pair of points of an object between two pads.

The first pad touches one of the points, in the middle or towards a rim, and the hand is turned in steps about the
normal there. Flat pads are looked at all over; of a round one the contact point alone counts.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices, Mask, cross
from ..collision.hand_free import hand_free
from ..descriptions.patches import LinePatch, PlanePatch
from ..errors import TaskError
from ..geometry.antipodal import Pairs
from ..geometry.patches import patch_point, rectangle
from ..kinematics.grips import Grips, grips
from ..kinematics.hand_posture import always_parallel
from ..kinematics.pads import Pad
from .task_model import TaskModel

TURNS = 8
"""Of the hand about the normal."""
PLACES = (0.0, -1.0, 1.0)
"""Of the contact on a pad, between the ends of each parameter; the middle is tried first."""
SPACING, FINE = 0.005, 0.002
"""Of the points at which a pad is looked at, m; the fine one for footprints that a contact region is to hold."""
SLACK = 0.003
"""How far off its pad the second contact may be where the first one is given, m: the table of grips is coarse."""
TOUCHED = 1e-4
"""What of a pad is nearer than this to the object is its footprint, m."""
BEHIND = (0.003, 0.008)
"""How far behind the face of a pad the finger is looked at, m."""
FEW = 7
"""Of so many points one is looked at before all of them are."""
WRIST = (0.8, 1.0)
"""Where between pads and wrist the hand is looked at."""
FINGER, FINGER_SPACING = 0.5, 0.003
"""Share of the way back to the wrist that fingers of a jaw go straight; spacing at which they are looked at, m."""


class Holds(NamedTuple):
    """Ways to hold a pair; object's frame."""

    synergies: Array
    """That hold the pads as far apart, rad (m), shape (s,)."""
    probes: Array
    """Points in the fingers and in the wrist, m, shape (ways, k, 3)."""
    approaches: Array
    """The wrist's z axis, shape (ways, 3)."""
    pads: Array
    """Poses of the first pad's patch frame, shape (ways, 4, 4)."""
    orders: Indices
    """Point that each pad touches, shape (ways, 2)."""
    T_wrist_pad: Array
    """Pose of the first pad's patch frame in the frame of the wrist, shape (4, 4)."""
    central: bool
    """Whether the contact is in the middle of the first pad."""


class HoldFinder:
    """Finds the ways to hold pairs of points in a task; where its object stands does not matter.

    Raises:
        TaskError: the pads face each other in no posture of the hand that the task allows.
    """

    def __init__(self, model: TaskModel) -> None:
        self._model = model
        self._grips = _free_grips(model)
        own = [model.parameter_limits[pad.parameters] for pad in model.robot.pads]
        spacing = SPACING if model.region is None else FINE
        self._outlines = tuple(_outline(*pad, spacing) for pad in zip(model.robot.pads, own, strict=True))
        self._limits = own[0]
        self.parallel = always_parallel(model.robot)
        """Whether the hand is a jaw whose pads stay parallel."""
        self._rubber = min(pad.rubber_depth for pad in model.robot.description.pads)
        widths = self._grips.widths
        self.narrowest, self.widest = float(widths.min()), float(widths.max())
        """Least and greatest distance of the pads, m."""

    def holds(self, pair: Pairs) -> Holds | None:
        """Return the ways to hold one pair in which the pads fit; None if there is none.

        They have the contact at one place of the pad, the first one at which there are some.
        """
        grip = self._grips.at(self._grips.nearest(float(pair.widths[0]))[:1])
        for place in itertools.product(PLACES, repeat=len(self._limits)):
            ways = self._ways(pair, grip, np.array(place))
            fit = np.flatnonzero(self._fit(ways.faces, ways.probes)) if len(ways.faces) else np.zeros(0, dtype=np.intp)
            if len(fit):
                own = ways.at(fit)
                hand = grip.synergies[0], own.probes, own.approaches, own.pads, own.orders, grip.pads[0, 0]
                return Holds(*hand, central=not any(place))
        return None

    def _ways(self, pair: Pairs, grip: Grips, place: Array) -> _Ways:
        """Return the hand with a place of the first pad at one of the points, turned.

        Those ways are left out in which the second pad is not at the other point then.
        """
        own, other = self._outlines
        low, high = self._limits.T
        contact = patch_point(self._model.robot.pads[0].patch, 0.5 * (low + high + place * (high - low)))
        orders = np.repeat([[0, 1], [1, 0]], TURNS, axis=0)
        points = pair.points[0, orders]
        frames = np.array([_frame(-normal) for normal in pair.normals[0]])
        R = (frames[:, None] @ _ABOUT_Z).reshape(-1, 3, 3) @ _frame(contact.normal).T
        p = points[:, 0] - R @ contact.point
        to_wrist = np.linalg.inv(grip.pads[0, 0])
        to_other = to_wrist @ grip.pads[0, 1]
        R_other, p_other = R @ to_other[:3, :3], R @ to_other[:3, 3] + p
        off = ((points[:, 1] - p_other)[:, None] @ R_other)[:, 0] - other.middle
        there = np.ones(len(R), dtype=bool)
        if other.rectangle is not None:
            low, high = (other.rectangle - other.middle[:2, None]).T
            there = ((off[:, :2] >= low - SLACK) & (off[:, :2] <= high + SLACK)).all(axis=1)
            off[:, :2] = 0.0
        p_other = p_other + (R_other @ off[:, :, None])[:, :, 0]
        faces = np.concatenate([_placed(R, p, own.face), _placed(R_other, p_other, other.face)], axis=1)
        middles = points.mean(axis=1)[:, None]
        wrists = middles + np.array(WRIST)[:, None] * (_placed(R, p, to_wrist[None, :3, 3]) - middles)
        back = -(R @ to_wrist[:3, 2])[:, None]
        length = FINGER * float(np.linalg.norm(to_wrist[:3, 3] - own.middle)) if self.parallel else 0.0
        steps = np.arange(0.0, length, FINGER_SPACING)[:, None]
        roots = _placed(R, p, own.root[None]), _placed(R_other, p_other, other.root[None])
        fingers = [root + steps * back for root in roots]
        probes = [_placed(R, p, own.behind), _placed(R_other, p_other, other.behind), *fingers, wrists]
        pads = np.tile(np.eye(4), (len(R), 1, 1))
        pads[:, :3, :3], pads[:, :3, 3] = R, p
        ways = _Ways(faces, np.concatenate(probes, axis=1), R @ to_wrist[:3, 2], pads, orders)
        return ways.at(np.flatnonzero(there))

    def _fit(self, faces: Array, probes: Array) -> Mask:
        """Return in which ways the object is in no pad, finger or wrist, and the footprints are in the region."""
        model, fit = self._model, np.ones(len(faces), dtype=bool)
        for points, least in ((probes, model.task.margin.object), (faces, -self._rubber)):
            for some in (points[:, ::FEW], points):  # most ways end with the few
                left = np.flatnonzero(fit)
                fit[left] = self._distances(some[left]).min(axis=1) >= least
        if model.region is not None and model.task.contact_regions == "footprint":
            left = np.flatnonzero(fit)
            inside = model.region(faces[left].reshape(-1, 3))[0].reshape(len(left), faces.shape[1])
            touched = self._distances(faces[left]) <= TOUCHED
            fit[left] = np.where(touched, inside, 0.0).min(axis=1) >= 0.0
        return fit

    def _distances(self, points: Array) -> Array:
        """Return the signed distances of points, shape (ways, k, 3), from the object, m, shape (ways, k)."""
        return self._model.surface.signed_distance(points.reshape(-1, 3))[0].reshape(points.shape[:2])


def _free_grips(model: TaskModel) -> Grips:
    """Return the grips of the hand that the task allows, and in which its links keep off each other."""
    own, free = slice(model.robot.arm_size, None), hand_free(model.collisions, model.robot)
    found = grips(model.robot, model.lower[own], model.upper[own])
    kept = [i for i, sigma in enumerate(found.synergies) if free(sigma)]
    if not kept:
        raise TaskError(
            "the two pads face each other in no posture of the hand that the task allows",
            file=model.scene.source,
            key=f"tasks.{model.task_name}.desired_contacts",
            remedy="Give a desired contact for each pad",
        )
    return found.at(np.array(kept))


class _Ways(NamedTuple):
    """The hand at a pair, turned in steps: parts of `Holds`, and points of the pads' faces, m, shape (ways, j, 3)."""

    faces: Array
    probes: Array
    approaches: Array
    pads: Array
    orders: Indices

    def at(self, indices: Indices) -> _Ways:
        """Return some of the ways."""
        faces, probes, approaches, pads, orders = self
        return _Ways(faces[indices], probes[indices], approaches[indices], pads[indices], orders[indices])


class _Outline(NamedTuple):
    """Points of a pad in its patch frame, m."""

    middle: Array
    """Shape (3,)."""
    rectangle: Array | None
    """Ranges along x and y of a flat one, shape (2, 2)."""
    face: Array
    """Shape (k, 3)."""
    behind: Array
    """In the finger, shape (j, 3)."""
    root: Array
    """In the middle of the finger, shape (3,)."""


def _outline(pad: Pad, limits: Array, spacing: float) -> _Outline:
    """Return the points of a pad; of a round one the middle counts."""
    patch, middle = pad.patch, patch_point(pad.patch, limits.mean(axis=1))
    ranges, face = None, middle.point[None]
    if isinstance(patch, PlanePatch | LinePatch):
        ranges = rectangle(patch)
        x, y = (np.linspace(low, high, math.ceil((high - low) / spacing) + 1) for low, high in ranges)
        face = np.array([[u, v, 0.0] for u, v in itertools.product(x, y)])
    behind = np.concatenate([face - depth * middle.normal for depth in BEHIND])
    return _Outline(middle.point, ranges, face, behind, middle.point - BEHIND[-1] * middle.normal)


def _placed(R: Array, p: Array, points: Array) -> Array:
    """Return points, shape (k, 3), of bodies at poses, shapes (n, 3, 3) and (n, 3), shape (n, k, 3)."""
    return np.asarray(points @ R.transpose(0, 2, 1) + p[:, None])


def _frame(axis: Array) -> Array:
    """Return a frame with this z axis, shape (3, 3)."""
    x = np.eye(3)[np.abs(axis).argmin()]
    x = x - (x @ axis) * axis
    x /= math.sqrt(float(x @ x))
    return np.column_stack([x, cross(axis, x), axis])


_ABOUT_Z = np.array(
    [
        [[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]]
        for angle in np.arange(TURNS) * math.tau / TURNS
    ]
)
"""Rotations, shape (TURNS, 3, 3)."""
