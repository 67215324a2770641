"""The clearances of a robot at a task: which of its links may come how near to what."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..descriptions.hand import PadDescription
from ..descriptions.task import Task
from .certificate import Figure, PairClearance
from .clearance import Placed, Surroundings, Walls, enclosure_figure, self_figure, shape_figure
from .pair_clearances import link_clearances, shape_clearances, wall_clearances
from .robot import VerifiedRobot
from .rubber import pad_links, rubber_clearances, rubber_figure
from .shapes import PlacedShape
from .shapes.core import PENETRATION
from .standing_out import standing_out


class Clearances:
    """Distances of the robot's links to walls, obstacles, the object and one another, with their limits.

    Args:
        robot: its meshes.
        task: its margins.
        pads: those of the task.
        walls: of the enclosure.
        target: the object that is grasped.
        obstacles: the other bodies.
    """

    def __init__(
        self,
        robot: VerifiedRobot,
        task: Task,
        pads: tuple[PadDescription, ...],
        walls: Walls,
        target: PlacedShape,
        obstacles: Sequence[PlacedShape],
    ) -> None:
        self._moving, self._margin, self._walls, self._target = robot.moving, task.margin, walls, target
        self.enabled, self.never = robot.pairs(task.margin.robot)
        """Pairs of links that keep the margin, and that may touch but not enter each other."""
        of_pads = {pad.link for pad in pads}
        beside = standing_out(robot, tuple((pad.link, pad.patch) for pad in pads))
        others = [mesh for link, mesh in robot.meshes.items() if link not in of_pads]
        touching = [mesh for link, mesh in robot.meshes.items() if link in of_pads]
        self._around_links = Surroundings((*others, *beside.values()), [target])
        self._around_pads = Surroundings(touching, [target])
        self._rubber = pad_links(robot, pads) if target.limits.yields else ()
        self._obstacles = Surroundings(robot.moving, obstacles)

    def figures(self, placed: Placed) -> list[Figure]:
        """Return how far the robot is from the enclosure, from obstacles and from itself."""
        figures = [enclosure_figure(self._moving, self._walls, placed, self._margin.enclosure)]
        if self._obstacles:
            limit = self._margin.enclosure - 1e-6
            figures.append(shape_figure("obstacle clearance", self._obstacles, placed, limit))
        return [
            *figures,
            self_figure("self clearance", self.enabled, placed, self._margin.robot - 1e-6),
            self_figure("self collision", self.never, placed, 0.0),
        ]

    def of_object(self, placed: Placed) -> list[Figure]:
        """Return how far pads are from the object, and everything else of the robot.

        What of a pad's link is flush with the pad or behind it counts as the pad.
        """
        limit = self._margin.object - self._target.limits.margin
        figures = [shape_figure("object clearance", self._around_links, placed, limit)] if self._around_links else []
        if self._rubber:
            return [*figures, rubber_figure(self._rubber, self._target, placed)]
        if self._around_pads:
            figures.append(shape_figure("pad clearance", self._around_pads, placed, -PENETRATION))
        return figures

    def pairs(self, placed: Placed) -> tuple[PairClearance, ...]:
        """Return the distances below 50 mm, pair by pair, the least first."""
        found = [
            *wall_clearances(self._moving, self._walls, placed),
            *shape_clearances("obstacle clearance", self._obstacles, placed),
            *shape_clearances("object clearance", self._around_links, placed),
            *self._of_pads(placed),
            *link_clearances("self clearance", self.enabled, placed),
            *link_clearances("self collision", self.never, placed),
        ]
        return tuple(sorted(found, key=lambda pair: pair.distance))

    def _of_pads(self, placed: Placed) -> Iterable[PairClearance]:
        if self._rubber:
            return rubber_clearances(self._rubber, self._target, placed)
        return shape_clearances("pad clearance", self._around_pads, placed)
