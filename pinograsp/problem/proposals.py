"""Where to touch, if nobody says: pairs of opposite points that the hand can hold between two of its pads.

Points are drawn on the surface, and each gets its opposite one. What is left of them

    is opposite       normals that pads can be tangent to: for pads that stay parallel opposite, on an uneven surface as
                      far as rubber yields, and within the friction cones about the line that joins the points
    fits the jaw      as far apart as the pads can be
    may be touched    both points in the contact region, and as far from edges as the task's reserve; of an uneven
                      surface where it is about as tilted itself as what a pad feels
    holds the pads    at one of eight turns about the normal, and one of nine places on the pad: nothing of the object
                      is in pads or fingers, and the footprint is in the region
    can be got at     there, no wall, obstacle or other object is in a finger or the wrist, and the approach is wanted

is put in an order in which each pair is as far as possible from those before it, the first one near the centre of mass.
All but the last holds wherever the object stands. Of these pairs those are proposed that

    are held          a trial with hand and object alone comes to all conditions of contact and clearance
    bear the wrench   the hand's forces there balance it within friction and force limits

and others only if such pairs are few.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..descriptions.mesh_contact import SIGMAS
from ..errors import TaskError
from ..frozen import Record
from ..geometry.antipodal import Pairs, opposite_points
from ..geometry.contact_faces import edge_distance
from ..geometry.patches import half_sides
from ..geometry.shapes import Surface, surface_of
from ..kinematics.reach import arm_reach
from ..mechanics import Contacts, grasp_statics, solve_forces
from .desired import DesiredPoints, Hold, Proposal
from .pair_holds import TURNS, HoldFinder, Holds
from .task_model import TaskModel

DRAWN, DRAWS = 400, 40
"""Points that are drawn at once, and how often at most."""
LOOKED_AT, MOST_LOOKED_AT = 120, 480
"""Pairs that are tried with the pads: at least, if there are enough, and at most; as many of those near edges."""
KEPT = 48
"""Pairs that are kept, at most: where the object stands, some of them cannot be got at."""
WIDE = 0.005
"""Margin from the object that may be why no pad fits on it, m; 1 mm is usual."""
PARALLEL = math.radians(0.5)
"""Greatest angle between a normal and the opposite of the other one for pads that stay parallel, rad."""
EDGE = math.radians(12.0)
"""Angle between the normal of an uneven surface and what a pad feels from which on there is an edge, rad."""
ROOM = 0.006
"""Pairs nearer than this to an edge are proposed only if no other one can be got at, m.

From there contacts slide over the edge: of starts that are led to such pairs half fail. So do those that fit at
the rim of a pad alone.
"""
TRIALS = 48
"""Pairs that are tried, at most."""
ENOUGH = 4
"""With fewer pairs of the best grade, those of the next one are proposed, too."""


@dataclass(frozen=True, eq=False, repr=False)
class ContactPair(Record):
    """Two opposite points of an object that two pads can touch."""

    points: Array
    """On the object's surface, in its frame, m, shape (2, 3); a task's `desired_contacts` may be these."""
    normals: Array
    """Outward normals there, unit vectors, object's frame, shape (2, 3)."""
    width: float
    """How far apart the pads are that hold it, m."""


def proposal(candidate: Candidate, model: TaskModel) -> Proposal:
    """Return what is proposed to a start, where the object of a task stands."""
    T = model.T_world_object
    placed = [
        hold._replace(T_wrist=T @ hold.T_wrist, axis=hold.axis @ T[:3, :3].T + [T[:3, 3], np.zeros(3)])
        for hold in candidate.held
    ]
    return Proposal(desired_points(candidate.pair, model), tuple(placed))


def desired_points(pair: ContactPair, model: TaskModel) -> DesiredPoints:
    """Return the points of a pair, and that pads are to look at them, where the object of a task stands."""
    R, origin = model.T_world_object[:3, :3], model.T_world_object[:3, 3]
    return DesiredPoints(pair.points @ R.T + origin, pair.normals @ R.T)


class Held(NamedTuple):
    """A hand that holds a pair, object's frame."""

    hold: Hold
    contacts: Contacts


Trial = Callable[[ContactPair, Holds], tuple[Held, ...]]


class Candidate(NamedTuple):
    """A pair that fits the hand."""

    pair: ContactPair
    holds: Holds
    roomy: bool
    """Whether it is far from edges, and may be in the middle of a pad."""
    held: tuple[Hold, ...] = ()
    """Hands that hold it, object's frame; none if it was not tried."""


class Proposals:
    """Pairs for a task, wherever its object stands.

    Args:
        model: the task.
        seed: of what is drawn.
        trial: returns the contacts of the hand that holds a pair in one of some ways, if there is one.

    Raises:
        TaskError: the hand has not two pads, or nothing suits it; the message says why.
    """

    def __init__(self, model: TaskModel, seed: int, trial: Trial) -> None:
        pads = len(model.robot.pads)
        if pads != 2:
            raise TaskError(
                f"contacts are proposed for two pads, and {pads} are to touch {model.task.object!r}",
                file=model.scene.source,
                key=f"tasks.{model.task_name}.desired_contacts",
                remedy="Give a desired contact for each pad, or name two of them in `pads`",
            )
        self._model, self._trial = model, trial
        self._held: dict[int, tuple[Held, ...]] = {}
        """By number of the candidate: hands that hold it."""
        self._finder = HoldFinder(model)
        self._tilt = PARALLEL
        if model.surface.uneven:
            halves = [half_sides(pad.patch).max() for pad in model.robot.pads]
            depths = [pad.rubber_depth for pad in model.robot.description.pads]
            self._tilt = float(np.arctan2(depths, halves).sum())
        found = self._found(np.random.default_rng(seed))
        self.candidates = tuple(c for roomy in (True, False) for c in self._spread(found, roomy))
        """Each as far as possible from those before it, those near edges last."""

    def here(self, model: TaskModel, most: int) -> tuple[Candidate, ...]:
        """Return up to `most` candidates that can be got at where the object stands now, in their order.

        Args:
            model: the task, its object moved or not.
            most: number of candidates.

        Raises:
            TaskError: there is none.
        """
        bodies = model.scene.bodies_besides(model.task).values()
        others = [(surface_of(body.shape), body.pose.matrix) for body in bodies]
        there = [number for number, c in enumerate(self.candidates) if _can_be_got_at(model, c, others)]
        grades = self._grades(model, there, most)
        free: list[Candidate] = []
        for best in sorted(set(grades), reverse=True):
            if len(free) < ENOUGH:
                free += [self._with_holds(i) for i, grade in zip(there, grades, strict=True) if grade == best]
        if free:
            return tuple(free[:most])
        raise TaskError(
            f"the hand gets at none of {len(self.candidates)} pairs of opposite points of {model.task.object!r} that "
            "fit it: walls, obstacles or other objects are in the way, or it is too far",
            file=model.scene.source,
            key=f"objects.{model.task.object}.pose",
            remedy="Move the object, or widen `approach` if the task has one",
        )

    def _with_holds(self, number: int) -> Candidate:
        """Return the candidate of a number with the hands that hold it, as far as it was tried."""
        return self.candidates[number]._replace(held=tuple(held.hold for held in self._held.get(number, ())))

    def _grades(self, model: TaskModel, numbers: Sequence[int], most: int) -> list[int]:
        """Return how well candidates of some numbers suit: 3 is best, 0 what slips or is near edges.

        They are tried one after the other until `most` hold; what a trial says is true wherever the object stands.
        """
        grades, good = [int(self.candidates[number].roomy) for number in numbers], 0
        for i, number in enumerate(numbers[:TRIALS]):
            if good == most:
                break
            pair, holds, roomy, _ = self.candidates[number]
            if number not in self._held:
                self._held[number] = self._trial(pair, holds)
            if self._held[number]:
                bears = any(_bears(model, held.contacts) for held in self._held[number])
                grades[i] = 2 + int(roomy) if bears else 0
                good += grades[i] > 1
        return grades

    def _found(self, rng: np.random.Generator) -> list[Candidate]:
        """Return what fits, of as many points as it takes."""
        found: list[Candidate] = []
        tried, reason = {True: 0, False: 0}, _Reason("", "")
        for _ in range(DRAWS):
            pairs = self._suitable(opposite_points(self._model.surface, DRAWN, rng))
            if isinstance(pairs, _Reason):
                reason = pairs
                continue
            rooms = self._rooms(pairs)
            for number in rng.permutation(np.flatnonzero(rooms >= self._model.task.reserve.rim)).tolist():
                pair, roomy = pairs.at(np.array([number])), bool(rooms[number] >= ROOM)
                if tried[roomy] < MOST_LOOKED_AT:
                    tried[roomy] += 1
                    holds = self._finder.holds(pair)
                    if holds is not None:
                        record = ContactPair(pair.points[0], pair.normals[0], float(pair.widths[0]))
                        found.append(Candidate(record, holds, roomy and holds.central))
            if tried[True] == MOST_LOOKED_AT or (tried[True] >= LOOKED_AT and sum(c.roomy for c in found) >= KEPT):
                break
        if any(tried.values()):
            reason = self._no_face()
        elif not reason.problem and self._model.surface.uneven:
            thin = f"thinner than {1e3 * SIGMAS[-1]:g} mm"
            remedy = "Give desired contacts, or a shape other than a mesh"
            reason = _Reason(f"all opposite points are at edges, or where it is {thin}", remedy)
        elif not reason.problem:
            reason = _Reason("all opposite points are at edges", "Give a smaller reserve.rim")
        if not found:
            task = self._model.task
            raise TaskError(
                f"no contacts can be proposed for {task.object!r}: {reason.problem}",
                file=self._model.scene.source,
                key=f"objects.{task.object}.shape",
                remedy=reason.remedy,
            )
        return found

    def _no_face(self) -> _Reason:
        """Return what keeps pads off all faces: their size, or other links that are to be far from the object."""
        margin, problem = self._model.task.margin.object, "no face is there that a pad fits on"
        if margin <= WIDE:
            return _Reason(problem, "Use a gripper with smaller pads")
        return _Reason(
            f"{problem} with other links {1e3 * margin:g} mm off (margin.object)", "Give a smaller margin.object"
        )

    def _suitable(self, pairs: Pairs) -> Pairs | _Reason:
        """Return the pairs that normals, jaw and region allow, or what keeps all of them out."""
        model, narrowest, widest = self._model, self._finder.narrowest, self._finder.widest
        opposite = pairs.leans.max(axis=1) <= math.atan(model.task.contact.friction)
        if self._finder.parallel:
            opposite &= pairs.tilts <= self._tilt
        pairs = pairs.at(np.flatnonzero(opposite))
        if not len(pairs.points):
            return _Reason("no two faces are opposite to each other as the pads are", "Give desired contacts")
        widths = pairs.widths
        if widths.min() > widest:
            least, missing, opens = 1e3 * widths.min(), 1e3 * (widths.min() - widest), 1e3 * widest
            problem = f"too wide by {missing:.1f} mm: at least {least:.1f} mm, and the pads open to {opens:.1f} mm"
            return _Reason(problem, "Use a larger gripper or a smaller object")
        if widths.max() < narrowest:
            most, missing, closes = 1e3 * widths.max(), 1e3 * (narrowest - widths.max()), 1e3 * narrowest
            problem = f"too narrow by {missing:.1f} mm: at most {most:.1f} mm, and the pads close to {closes:.1f} mm"
            return _Reason(problem, "Use a smaller gripper or a larger object")
        pairs = pairs.at(np.flatnonzero((widths >= narrowest) & (widths <= widest)))
        if not len(pairs.points):
            thick, wide = 1e3 * widths[widths < narrowest].max(), 1e3 * widths[widths > widest].min()
            jaw = f"the pads close to {1e3 * narrowest:.1f} mm and open to {1e3 * widest:.1f} mm"
            problem = f"too narrow or too wide: {thick:.1f} mm or less, {wide:.1f} mm or more, and {jaw}"
            return _Reason(problem, "Use another gripper or another object")
        if model.region is not None:
            inside = model.region(pairs.points.reshape(-1, 3))[0].reshape(-1, 2) >= 0.0
            pairs = pairs.at(np.flatnonzero(inside.all(axis=1)))
        if not len(pairs.points):
            return _Reason("no two opposite points that fit the jaw are in the contact region", "Widen the region")
        return pairs

    def _rooms(self, pairs: Pairs) -> Array:
        """Return how far both points of pairs are from the edges of their faces, m, shape (n,); -inf on an edge."""
        surface = self._model.surface
        if surface.uneven:
            points = pairs.points.reshape(-1, 3)
            cosines = (surface.signed_distance(points)[1] * surface.footprint(points)[0]).sum(axis=1)
            return np.where(cosines.reshape(-1, 2).min(axis=1) < math.cos(EDGE), -np.inf, np.inf)
        face_of = self._model.surface.contact_face
        rooms = [[edge_distance(face_of(point), point)[0] for point in pair] for pair in pairs.points]
        return np.asarray(np.min(rooms, axis=1))

    def _spread(self, found: list[Candidate], roomy: bool) -> list[Candidate]:
        """Return candidates far from edges, or those near them, each as far as possible from those before it."""
        some = [candidate for candidate in found if candidate.roomy == roomy]
        if not some:
            return []
        points = np.array([candidate.pair.points for candidate in some])
        center = np.array(self._model.scene.objects[self._model.task.object].center_of_mass_object)
        order = [int(np.linalg.norm(points.mean(axis=1) - center, axis=1).argmin())]
        gaps = _gaps(points, order[0])
        while len(order) < min(KEPT, len(some)):
            order.append(int(gaps.argmax()))
            gaps = np.minimum(gaps, _gaps(points, order[-1]))
        return [some[i] for i in order]


def _bears(model: TaskModel, held: Contacts) -> bool:
    """Whether contacts, object's frame, can balance the wrench on the object within friction and force limits."""
    R, origin = model.T_world_object[:3, :3], model.T_world_object[:3, 3]
    twists = np.concatenate([R @ held.jacobians[:, :3], R @ held.jacobians[:, 3:]], axis=1)
    contacts = Contacts(held.points @ R.T + origin, held.normals @ R.T, twists)
    statics = grasp_statics(contacts, model.contact_models, model.hand, model.load)
    forces = solve_forces(statics, contacts.normals, model.contact_models, model.limits)
    return model.limits.strict_cost >= forces.V


class _Reason(NamedTuple):
    """Why no pair suits."""

    problem: str
    remedy: str


def _can_be_got_at(model: TaskModel, candidate: Candidate, others: Sequence[tuple[Surface, Array]]) -> bool:
    """Whether nothing is in the way of one of the ways to hold a candidate where the object stands.

    Args:
        model: the task.
        candidate: the pair.
        others: surfaces of the bodies that may be in the way, with their poses, shape (4, 4).
    """
    R, origin = model.T_world_object[:3, :3], model.T_world_object[:3, 3]
    base, reach = arm_reach(model.robot)
    if np.linalg.norm(candidate.pair.points @ R.T + origin - base, axis=1).max() > reach:
        return False
    probes = candidate.holds.probes @ R.T + origin
    free = np.ones(len(probes), dtype=bool)
    for inward, offset in model.scene.enclosure.walls.values():
        free &= (probes @ inward).min(axis=1) > offset
    if model.approach is not None:
        beyond = min(model.approach.half_angle + math.pi / TURNS, math.pi)
        free &= candidate.holds.approaches @ R.T @ model.approach.axis >= math.cos(beyond)
    for surface, T in others if free.any() else ():
        local = (probes.reshape(-1, 3) - T[:3, 3]) @ T[:3, :3]
        free &= surface.exact_distances(local).reshape(len(probes), -1).min(axis=1) > 0.0
    return bool(free.any())


def _gaps(points: Array, index: int) -> Array:
    """Return how far pairs are from one of them, whichever point is the first one, m, shape (n,)."""
    same = np.linalg.norm(points - points[index], axis=(1, 2))
    crossed = np.linalg.norm(points - points[index, ::-1], axis=(1, 2))
    return np.asarray(np.minimum(same, crossed))
