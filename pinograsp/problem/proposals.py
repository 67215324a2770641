"""Where to touch, if nobody says: pairs of opposite points that the hand can hold between two of its pads.

Points are drawn on the surface, and each gets its opposite one. What is left of them

    is opposite       normals that pads can be tangent to: exactly opposite for pads that stay parallel,
                      within the friction cones about the line that joins the points for others
    fits the jaw      as far apart as the pads can be
    may be touched    both points in the contact region, and as far from edges as the task's reserve
    holds the pads    at one of eight turns about the normal, and at one of nine places on the pad: nothing of the object
                      stands in pads or fingers, and the footprint is in the region
    can be got at     there, no wall, obstacle or other object is in a finger or the wrist, and the approach is wanted

is put in an order in which each pair is as far as possible from those before it, the first one near the centre of mass.
All but the last holds wherever the object stands.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Indices
from ..collision.hand_free import hand_free
from ..descriptions.patches import LinePatch, PlanePatch
from ..errors import TaskError
from ..frozen import Record
from ..geometry.antipodal import Pairs, opposite_points
from ..geometry.contact_faces import edge_distance
from ..geometry.patches import patch_point
from ..geometry.shapes import surface_of
from ..kinematics.grips import Grips, grips
from ..kinematics.hand_posture import always_parallel
from ..kinematics.reach import arm_reach
from ..kinematics.robot import Pad
from .task_model import TaskModel

DRAWN, DRAWS = 400, 10
"""Points drawn at once, and how often at most."""
LOOKED_AT = 120
"""Pairs that are tried with the pads, at most."""
KEPT = 48
"""Pairs that are kept, at most: where the object stands, some of them cannot be got at."""
PARALLEL = math.radians(0.5)
"""Greatest angle between a normal and the opposite of the other one for pads that stay parallel, rad."""
TURNS = 8
"""Of the hand about the normal."""
PLACES = (0.0, -1.0, 1.0)
"""Of the contact on a pad, between the ends of each parameter; the middle is tried first."""
SPACING = 0.005
"""Of the points at which a pad is looked at, m."""
SLACK = 0.003
"""How far off the pad the second contact may be where the first one is given: the table of grips is coarse, m."""
RUBBER = 0.001
"""How deep the object may be in the face of a pad, m."""
TOUCHED = 1e-4
"""What of a pad is nearer than this to the object is its footprint, m."""
BEHIND = (0.003, 0.008)
"""How far behind the face of a pad the finger is looked at, m."""
WRIST = (0.8, 1.0)
"""Where between pads and wrist the hand is looked at."""


@dataclass(frozen=True, eq=False, repr=False)
class ContactPair(Record):
    """Two opposite points of an object that two pads can touch."""

    points: Array
    """On the object's surface, in its frame, m, shape (2, 3); a task's `desired_contacts` may be these."""
    normals: Array
    """Outward unit normals there, object's frame, shape (2, 3)."""
    width: float
    """How far the pads are apart that hold it, m."""


@dataclass(frozen=True)
class Candidate:
    """A pair that fits the hand, with the ways in which the hand can hold it; object's frame."""

    pair: ContactPair
    synergies: Array
    """That hold the pads as far apart, rad (m), shape (s,)."""
    probes: Array
    """Places in the fingers and in the wrist, for each way, m, shape (ways, k, 3)."""
    approaches: Array
    """The wrist's z axis, for each way, shape (ways, 3)."""


class Proposals:
    """Pairs for a task, wherever its object stands.

    Args:
        model: the task.
        seed: of what is drawn.

    Raises:
        TaskError: the hand has not two pads, or nothing suits it; the message says why.
    """

    def __init__(self, model: TaskModel, seed: int) -> None:
        pads = len(model.robot.pads)
        if pads != 2:
            raise TaskError(
                f"contacts can be proposed for two pads, and {pads} are to touch {model.task.object!r}",
                file=model.scene.source,
                key=f"tasks.{model.task_name}.desired_contacts",
                remedy="Give a desired contact for each pad, or name two pads in `pads`",
            )
        self._model = model
        self._grips = _free_grips(model)
        self.candidates = self._spread(self._found(np.random.default_rng(seed)))

    def here(self, model: TaskModel, most: int) -> tuple[Candidate, ...]:
        """Return up to `most` candidates that can be got at where the object stands now, spread over it.

        Args:
            model: the task, its object moved or not.
            most: number of candidates.

        Raises:
            TaskError: there is none.
        """
        free = tuple(itertools.islice((c for c in self.candidates if _can_be_got_at(model, c)), most))
        if not free:
            raise TaskError(
                f"{len(self.candidates)} pairs of opposite points of {model.task.object!r} fit the hand, and it gets at "
                "none of them: walls, obstacles or other objects are in the way, or it is too far",
                file=model.scene.source,
                key=f"objects.{model.task.object}.pose",
                remedy="Move the object, or widen `approach` if the task has one",
            )
        return free

    def _found(self, rng: np.random.Generator) -> list[Candidate]:
        """Return what fits, of as many points as it takes."""
        found: list[Candidate] = []
        tried, problem = 0, ""
        for _ in range(DRAWS):
            pairs, reason = self._suitable(opposite_points(self._model.surface, DRAWN, rng))
            problem = reason or problem
            for number in range(min(len(pairs.points), LOOKED_AT - tried)):
                found += self._held(pairs.at(np.array([number])))
                tried += 1
            if tried >= LOOKED_AT:
                break
        if not found:
            raise self._refusal("no face is there that a pad fits on" if tried else problem)
        return found

    def _suitable(self, pairs: Pairs) -> tuple[Pairs, str]:
        """Return the pairs that points, normals and widths allow; if there is none, what is wrong with the last ones."""
        model, task = self._model, self._model.task
        if always_parallel(model.robot):
            opposite = pairs.tilts <= PARALLEL
            opposite &= (pairs.leans <= math.atan(task.contact.friction)).all(axis=1)
        else:
            opposite = (pairs.leans <= math.atan(task.contact.friction)).all(axis=1)
        pairs = pairs.at(np.flatnonzero(opposite))
        if not len(pairs.points):
            return pairs, "no two faces are opposite to each other as the pads are"
        narrowest, widest = float(self._grips.widths.min()), float(self._grips.widths.max())
        widths = pairs.widths
        if widths.min() > widest:
            opens = f"opposite points are at least {1e3 * widths.min():.1f} mm apart, and the pads open to"
            return pairs.at(_NONE), f"too wide by {1e3 * (widths.min() - widest):.1f} mm: {opens} {1e3 * widest:.1f} mm"
        if widths.max() < narrowest:
            closes = f"opposite points are at most {1e3 * widths.max():.1f} mm apart, and the pads close to"
            missing = 1e3 * (narrowest - widths.max())
            return pairs.at(_NONE), f"too narrow by {missing:.1f} mm: {closes} {1e3 * narrowest:.1f} mm"
        pairs = pairs.at(np.flatnonzero((widths >= narrowest) & (widths <= widest)))
        if not len(pairs.points):
            return pairs, "opposite points are too far from each other, or too near, for the pads"
        if model.region is not None:
            inside = model.region(pairs.points.reshape(-1, 3))[0].reshape(-1, 2) >= 0.0
            pairs = pairs.at(np.flatnonzero(inside.all(axis=1)))
        if not len(pairs.points):
            return pairs, "no two opposite points that fit the jaw are in the contact region"
        pairs = pairs.at(np.flatnonzero([self._off_edges(pair) for pair in pairs.points]))
        return pairs, "" if len(pairs.points) else "all opposite points that fit the jaw are at edges"

    def _off_edges(self, pair: Array) -> bool:
        surface, reserve = self._model.surface, self._model.task.reserve.rim
        return all(edge_distance(surface.contact_face(point), point)[0] >= reserve for point in pair)

    def _held(self, pair: Pairs) -> list[Candidate]:
        """Return the candidate that a pair makes, if the pads fit."""
        width = float(pair.widths[0])
        grip = self._grips.at(self._grips.nearest(width)[:1])
        for place in itertools.product(PLACES, PLACES):
            probes, approaches = [], []
            for ways in self._ways(pair, grip, place):
                if self._fits(ways):
                    probes.append(np.concatenate([*ways.behind, ways.wrist]))
                    approaches.append(ways.approach)
            if probes:
                record = ContactPair(pair.points[0], pair.normals[0], width)
                return [Candidate(record, grip.synergies[0], np.array(probes), np.array(approaches))]
        return []

    def _ways(self, pair: Pairs, grip: Grips, place: tuple[float, float]) -> Iterator[_Way]:
        """Yield the ways in which the hand holds a pair with a place of the first pad at one of its points."""
        pads = self._model.robot.pads
        for first, turn in itertools.product((0, 1), range(TURNS)):
            points, normals = pair.points[0, [first, 1 - first]], pair.normals[0, [first, 1 - first]]
            contact = patch_point(pads[0].patch, self._parameters(pads[0], place))
            T_pad = np.eye(4)
            T_pad[:3, :3] = _turned(-normals[0], math.tau * turn / TURNS) @ _turned(contact.normal, 0.0).T
            T_pad[:3, 3] = points[0] - T_pad[:3, :3] @ contact.point
            T_wrist = T_pad @ np.linalg.inv(grip.pads[0, 0])
            T_other = T_wrist @ grip.pads[0, 1]
            off = (points[1] - T_other[:3, 3]) @ T_other[:3, :3]
            if _is_flat(pads[1]):
                low, high = _rectangle(pads[1]).T
                if (off[:2] < low - SLACK).any() or (off[:2] > high + SLACK).any():
                    continue
                T_other[:3, 3] += off[2] * T_other[:3, 2]
            poses = (T_pad, T_other)
            faces = tuple(_face(pad, T, point) for pad, T, point in zip(pads, poses, points, strict=True))
            behind = [face - depth * T[:3, 2] for face, T in zip(faces, poses, strict=True) for depth in BEHIND]
            middle = points.mean(axis=0)
            wrist = middle + np.outer(WRIST, T_wrist[:3, 3] - middle)
            yield _Way(faces, behind, wrist, T_wrist[:3, 2])

    def _parameters(self, pad: Pad, place: tuple[float, float]) -> Array:
        low, high = self._model.parameter_limits[pad.parameters].T
        return np.asarray(0.5 * (low + high) + 0.5 * (high - low) * np.array(place[: len(low)]))

    def _fits(self, way: _Way) -> bool:
        """Whether nothing of the object is in a pad, a finger or the wrist, and the footprints are in the region."""
        model, faces = self._model, np.concatenate(way.faces)
        depths = model.surface.signed_distance(faces)[0]
        if depths.min() < -RUBBER:
            return False
        behind = np.concatenate([*way.behind, way.wrist])
        if model.surface.signed_distance(behind)[0].min() < model.task.margin.object:
            return False
        if model.region is None or model.task.contact_regions == "point":
            return True
        return bool(model.region(faces[depths <= TOUCHED])[0].min(initial=0.0) >= 0.0)

    def _spread(self, found: list[Candidate]) -> tuple[Candidate, ...]:
        """Return candidates, each as far as possible from those before it."""
        points = np.array([candidate.pair.points for candidate in found])
        center = np.array(self._model.scene.objects[self._model.task.object].center_of_mass)
        apart = np.linalg.norm(points.mean(axis=1) - center, axis=1)
        order = [int(apart.argmin())]
        gaps = _gaps(points, order[0])
        while len(order) < min(KEPT, len(found)):
            order.append(int(gaps.argmax()))
            gaps = np.minimum(gaps, _gaps(points, order[-1]))
        return tuple(found[i] for i in order)

    def _refusal(self, why: str) -> TaskError:
        task = self._model.task
        return TaskError(
            f"no contacts can be proposed for {task.object!r}: {why}",
            file=self._model.scene.source,
            key=f"objects.{task.object}.shape",
            remedy="Use another gripper or another object, or a wider contact region if the task has one",
        )


@dataclass(frozen=True)
class _Way:
    """A way to hold a pair; object's frame, m."""

    faces: tuple[Array, ...]
    """Points of the face of each pad, shapes (k, 3)."""
    behind: list[Array]
    """Points in the fingers."""
    wrist: Array
    """Points at the wrist."""
    approach: Array
    """The wrist's z axis, shape (3,)."""


_NONE: Indices = np.empty(0, dtype=np.intp)


def _free_grips(model: TaskModel) -> Grips:
    """Return the grips of the hand that the task allows, and in which its links keep off each other.

    Raises:
        TaskError: there is none.
    """
    robot, found, free = model.robot, grips(model.robot), hand_free(model.collisions, model.robot)
    own = slice(robot.arm_size, None)
    within = ((found.synergies >= model.lower[own]) & (found.synergies <= model.upper[own])).all(axis=1)
    kept = np.flatnonzero([inside and free(sigma) for inside, sigma in zip(within, found.synergies, strict=True)])
    if not len(kept):
        raise TaskError(
            "the two pads face each other in no posture of the hand that the task allows",
            file=model.scene.source,
            key=f"tasks.{model.task_name}.desired_contacts",
            remedy="Give a desired contact for each pad",
        )
    return found.at(kept)


def _can_be_got_at(model: TaskModel, candidate: Candidate) -> bool:
    """Whether nothing is in the way of one of the ways to hold a candidate where the object stands."""
    R, origin = model.T_world_object[:3, :3], model.T_world_object[:3, 3]
    base, reach = arm_reach(model.robot)
    if np.linalg.norm(candidate.pair.points @ R.T + origin - base, axis=1).max() > reach:
        return False
    probes = candidate.probes @ R.T + origin
    free = np.ones(len(probes), dtype=bool)
    for inward, offset in model.scene.enclosure.walls.values():
        free &= (probes @ inward).min(axis=1) > offset
    if model.approach is not None:
        beyond = model.approach.half_angle + math.pi / TURNS
        free &= candidate.approaches @ R.T @ model.approach.axis >= math.cos(min(beyond, math.pi))
    for body in model.scene.bodies_besides(model.task).values() if free.any() else ():
        T = body.pose.matrix
        local = (probes.reshape(-1, 3) - T[:3, 3]) @ T[:3, :3]
        free &= surface_of(body.shape).signed_distance(local)[0].reshape(len(probes), -1).min(axis=1) > 0.0
    return bool(free.any())


def _gaps(points: Array, index: int) -> Array:
    """Return how far pairs are from one of them, whichever point is the first one, m, shape (n,)."""
    same = np.linalg.norm(points - points[index], axis=(1, 2))
    crossed = np.linalg.norm(points - points[index, ::-1], axis=(1, 2))
    return np.asarray(np.minimum(same, crossed))


def _turned(axis: Array, angle: float) -> Array:
    """Return a frame with this z axis, turned about it, shape (3, 3)."""
    x = np.eye(3)[np.abs(axis).argmin()]
    x = x - (x @ axis) * axis
    x /= np.linalg.norm(x)
    y = np.cross(axis, x)
    return np.column_stack(
        [math.cos(angle) * x + math.sin(angle) * y, math.cos(angle) * y - math.sin(angle) * x, axis]
    )


def _is_flat(pad: Pad) -> bool:
    return isinstance(pad.patch, PlanePatch | LinePatch)


def _rectangle(pad: Pad) -> Array:
    """Return the ranges of a flat pad along x and y of its frame, m, shape (2, 2)."""
    patch = pad.patch
    assert isinstance(patch, PlanePatch | LinePatch)
    return np.array([patch.u, patch.v if isinstance(patch, PlanePatch) else (-0.5 * patch.width, 0.5 * patch.width)])


def _face(pad: Pad, T: Array, point: Array) -> Array:
    """Return points spread over a flat pad, of a round one the contact point alone, m, shape (k, 3)."""
    if not _is_flat(pad):
        return point[None]
    x, y = (np.linspace(low, high, math.ceil((high - low) / SPACING) + 1) for low, high in _rectangle(pad))
    local = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), len(y)))], axis=2).reshape(-1, 3)
    return np.asarray(local @ T[:3, :3].T + T[:3, 3])
