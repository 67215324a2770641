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

import numpy as np

from ..arrays import Array
from ..errors import TaskError
from ..geometry.filled import center_of_mass
from ..geometry.shapes import Surface, surface_of
from ..kinematics.reach import arm_reach
from ..mechanics import Contacts, grasp_statics, solve_forces
from .contact_pairs import Candidate, ContactPair, Held
from .pair_holds import TURNS, Holds
from .suitable_pairs import SuitablePairs
from .task_model import TaskModel

KEPT = 48
"""Pairs that are kept, at most: where the object stands, some of them cannot be got at."""
TRIALS = 48
"""Pairs that are tried, at most."""
ENOUGH = 4
"""With fewer pairs of the best grade, those of the next one are proposed, too."""


Trial = Callable[[ContactPair, Holds], tuple[Held, ...]]


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
        suitable = SuitablePairs(model, KEPT)
        found = suitable.found(np.random.default_rng(seed))
        self.candidates = tuple(c for roomy in (True, False) for c in self._spread(found, roomy))
        """Each as far as possible from those before it, those near edges last."""
        self.remarks = suitable.remarks
        """Which parts of the surface have no pair, and why."""

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
        none = (
            f"the hand gets at none of {len(self.candidates)} pairs of opposite points of {model.task.object!r} that "
            "fit it: walls, obstacles or other objects are in the way, or it is too far"
        )
        raise TaskError(
            "; ".join((none, *self.remarks)),
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

    def _spread(self, found: list[Candidate], roomy: bool) -> list[Candidate]:
        """Return candidates far from edges, or those near them, each as far as possible from those before it."""
        some = [candidate for candidate in found if candidate.roomy == roomy]
        if not some:
            return []
        points = np.array([candidate.pair.points for candidate in some])
        center = center_of_mass(self._model.scene.objects[self._model.task.object])
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
