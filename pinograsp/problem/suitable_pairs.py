"""Pairs of opposite points that suit the pads of a hand, of as many as are drawn; and why others do not."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..descriptions.mesh_contact import SIGMAS
from ..errors import TaskError
from ..geometry.antipodal import Pairs, opposite_points
from ..geometry.contact_faces import edge_distance
from ..geometry.patches import half_sides
from .contact_pairs import Candidate, ContactPair
from .lone_faces import LoneFaces
from .pair_holds import HoldFinder
from .task_model import TaskModel

DRAWN, DRAWS = 400, 40
"""Points that are drawn at once, and how often at most."""
LOOKED_AT, MOST_LOOKED_AT = 120, 480
"""Pairs that are tried with the pads: at least, if there are enough, and at most; as many of those near edges."""
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


class SuitablePairs:
    """Draws pairs for a task, wherever its object stands.

    Args:
        model: the task.
        wanted: pairs far from edges that are enough.
    """

    def __init__(self, model: TaskModel, wanted: int) -> None:
        self._model, self._wanted = model, wanted
        self._finder = HoldFinder(model)
        self._tilt = PARALLEL
        if model.surface.uneven:
            halves = [half_sides(pad.patch).max() for pad in model.robot.pads]
            depths = [pad.rubber_depth for pad in model.robot.description.pads]
            self._tilt = float(np.arctan2(depths, halves).sum())
        self._lone = LoneFaces(self._lean, self._tilt if self._finder.parallel else None)

    @property
    def _lean(self) -> float:
        """Greatest angle between a normal and the line between the points, rad."""
        return math.atan(self._model.task.contact.friction)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Which parts of the surface that was drawn have no opposite points as the pads are, and why."""
        return self._lone.remarks(self._model.task.contact.friction)

    def found(self, rng: np.random.Generator) -> list[Candidate]:
        """Return what fits, of as many points as it takes.

        Raises:
            TaskError: nothing does; the message says why.
        """
        found, looked_at, reason = self._drawn(rng)
        if found:
            return found
        if looked_at:
            reason = self._no_face()
        elif not reason.problem and self._model.surface.uneven:
            thin = f"thinner than {1e3 * SIGMAS[-1]:g} mm"
            remedy = "Give desired contacts, or a shape other than a mesh"
            reason = _Reason(f"all opposite points are at edges, or where it is {thin}", remedy)
        elif not reason.problem:
            reason = _Reason("all opposite points are at edges", "Give a smaller reserve.rim")
        task = self._model.task
        problem = f"no contacts can be proposed for {task.object!r}: {reason.problem}"
        raise TaskError(
            "; ".join((problem, *self.remarks)),
            file=self._model.scene.source,
            key=f"objects.{task.object}.shape",
            remedy=reason.remedy,
        )

    def _drawn(self, rng: np.random.Generator) -> tuple[list[Candidate], int, _Reason]:
        """Return what fits, how many pairs were tried with the pads, and what kept the last ones from that."""
        found, tried, reason = list[Candidate](), {True: 0, False: 0}, _Reason("", "")
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
            enough = sum(candidate.roomy for candidate in found) >= self._wanted
            if tried[True] == MOST_LOOKED_AT or (tried[True] >= LOOKED_AT and enough):
                break
        return found, sum(tried.values()), reason

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
        self._lone.see(pairs)
        opposite = pairs.leans.max(axis=1) <= self._lean
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


class _Reason(NamedTuple):
    """Why no pair suits."""

    problem: str
    remedy: str
