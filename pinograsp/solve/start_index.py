"""A start database in memory, for tasks one after the other: rows by where the hand would grasp.

The place of a grasp is between the pads, at a distance L from the wrist along its z axis. The places nearest to an
object are found by a k-d tree in microseconds, where a query of the file takes tens of milliseconds; among these the
starts come first whose pads are nearest to the desired contact points.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from scipy.spatial import cKDTree

from ..arrays import Array, Indices
from ..database.store import Database
from ..geometry.patches import patch_point
from ..kinematics.batch import BatchKinematics
from ..kinematics.contacts import contact_kinematics
from ..kinematics.forward import forward
from ..kinematics.robot import Robot
from ..problem import TaskModel
from .starts import RANGE_SLACK, held, in_turn, locked, postures, ranged, turning

MOST_ROWS = 400_000
"""Of a larger database an even share is taken."""
LOOKED_AT = 1500
"""Rows nearest to an object whose pads are looked at."""
LOCKED_SHARE = 8
"""Where joints are locked, those rows are the one of so many whose joints are nearest to their values."""


class HeldHand:
    """The hand as it is held before a grasp, on many arm configurations at once.

    Args:
        model: the task; where its object stands does not matter.
    """

    def __init__(self, model: TaskModel) -> None:
        robot = model.robot
        self.synergies = held(model)
        """Shape (s,)."""
        self._batch = BatchKinematics(robot, self.synergies)
        middles = robot.parameter_limits.mean(axis=1)
        self._pads: list[tuple[int, Array]] = []
        for pad in robot.pads:
            local = np.eye(4)
            local[:3, 3] = pad.rotation @ patch_point(pad.patch, middles[pad.parameters]).point + pad.translation
            group = self._batch.group_of[pad.joint]
            self._pads.append((group, self._batch.placement(pad.joint, local)[:3, 3]))

    def misses(self, q: Array, points: Array) -> Array:
        """Return the squared distances of the pads' middles from points, summed, the best assignment each, m^2.

        Args:
            q: arm configurations, rad (m), shape (n, l).
            points: in the world, m, shape (..., pads, 3).

        Returns:
            Shape (..., n).
        """
        frames = self._batch.frames(q)
        pads = np.array([frames.place(group, point) for group, point in self._pads])
        square = ((pads[:, None] - points[..., None, :, None, :]) ** 2).sum(axis=-1)
        rows = range(len(pads))
        sums = [square[..., rows, order, :].sum(axis=-2) for order in itertools.permutations(rows)]
        return np.asarray(np.min(sums, axis=0))


class StartIndex:
    """Rows of a database by the place of their grasp.

    Args:
        database: open; it can be closed afterwards.
        robot: mounted as in the database.
    """

    def __init__(self, database: Database, robot: Robot) -> None:
        share = max(1, math.ceil(database.rows() / MOST_ROWS))
        angles = [f"q{i}" for i in range(1, robot.arm_size + 1)]
        columns = database.select_columns(
            f"SELECT {', '.join(angles)}, x, y, z, ax, ay, az FROM configurations WHERE sample % {share} = 0"
        )
        self._q, wrists, self._approaches = (
            np.column_stack([np.asarray(columns[name], dtype=float) for name in names])
            for names in (angles, ("x", "y", "z"), ("ax", "ay", "az"))
        )
        self._tree = cKDTree(wrists + _reach(robot) * self._approaches)

    def starts(self, model: TaskModel, hand: HeldHand, wanted: Array, count: int) -> Array:
        """Return up to `count` postures (q_a, sigma), the most promising first, shape (found, l + s).

        Those that keep the task's cone of approach directions and its joint ranges come first, then those that miss
        them by up to `starts.RANGE_SLACK`, as in `starts_near`. Where joints are locked, rows are taken that are near
        the object and near their values, and set to these; how far the pads are from the desired contacts counts after.

        Args:
            model: the task.
            hand: as it is held before a grasp of the task.
            wanted: points where the pads may be wanted, world, m, shape (k, pads, 3): those that are nearest count.
            count: number of starts wanted.
        """
        if not len(self._q):
            return np.empty((0, model.robot.posture_size))
        rows = self._near(model, wanted.mean(axis=(0, 1)), max(count, LOOKED_AT))
        found = postures(model, self._q[rows], hand.synergies)
        missed = self._missed(model, found, self._approaches[rows])
        kept = np.where(missed > RANGE_SLACK, 2, np.where(missed > 0.0, 1, 0))
        order = np.lexsort([hand.misses(found[:, : model.robot.arm_size], wanted).min(axis=0), kept])
        return found[order[kept[order] < 2][:count]]

    def _near(self, model: TaskModel, place: Array, count: int) -> Indices:
        """Return up to `count` rows whose grasp is near a place; of more of them those nearest to locked joints."""
        fixed = locked(model)
        more = count * LOCKED_SHARE if len(fixed) else count
        _, rows = self._tree.query(place, k=min(len(self._q), more))
        rows = np.atleast_1d(rows)
        if not len(fixed):
            return rows
        off = np.abs(in_turn(model, self._q[rows])[:, fixed] - model.lower[fixed]) / model.robot.step_units[fixed]
        return rows[np.argsort(off.max(axis=1), kind="stable")[:count]]

    def _missed(self, model: TaskModel, found: Array, approaches: Array) -> Array:
        """Return by how much starts miss cone or ranges at most, rad, shape (n,); no slack for sliders."""
        missed = np.zeros(len(found))
        if model.approach is not None:
            missed = np.arccos(np.clip(approaches @ model.approach.axis, -1.0, 1.0)) - model.approach.half_angle
        turned = turning(model)
        for name, i in ranged(model).items():
            beyond = np.maximum(model.lower[i] - found[:, i], found[:, i] - model.upper[i])
            missed = np.maximum(missed, beyond if name in turned else np.where(beyond > 0.0, np.inf, beyond))
        return np.asarray(missed)


def _reach(robot: Robot) -> float:
    """Return how far the middle between the pads is from the wrist along its z axis, m, the hand in mid-range."""
    configuration = forward(robot, robot.model.createData(), 0.5 * (robot.lower + robot.upper))
    points = contact_kinematics(configuration, robot.parameter_limits.mean(axis=1)).points
    frame = robot.model.frames[robot.wrist_frame]
    R, p = configuration.rotations[frame.parentJoint], configuration.translations[frame.parentJoint]
    wrist, axis = R @ frame.placement.translation + p, R @ frame.placement.rotation[:, 2]
    return float((points.mean(axis=0) - wrist) @ axis)
