"""Whether the hand can hold a proposed pair: tried with nothing but hand and object in the way.

The object is brought to the hand, turned as in one of the ways to hold the pair, with the arm in a posture in which the
wrist can move to all sides. The projection of a start from there moves hand and contacts until pads lie on the object
and nothing else touches it. Where it does not come to that, starts do not either.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..collision.distances import Distances
from ..descriptions.enclosure import Enclosure
from ..kinematics.forward import Configuration, forward
from ..kinematics.wrist import wrist_pose
from ..mechanics import Contacts
from ..problem import GraspProblem, Hold, TaskModel
from ..problem.contact_pairs import ContactPair, Held, desired_points
from ..problem.pair_holds import Holds
from .held_hand import BETWEEN, between, turned, turned_about
from .projection import descend, miss

WAYS = 3
"""Ways to hold a pair that are tried, at most."""
MOVED = 0.01
"""How far contacts may be from their points then, m."""
DESCENTS = ((0.3, 0.05, 0.5), (0.0, 0.3, 0.01))
"""Descents one after the other: weight of the points, part of the squared residual by which a descent goes on, and norm
of the scaled residual above which the pair is given up: of starts that are led to pairs that are held nine of ten come
to a grasp, of others one of four."""
TURNS = np.arange(0.0, math.tau, 2.0 * BETWEEN)
"""By which a hand that holds a pair is turned about the line through it, and looked at, rad."""
LITTLE, LEAST, CLOSE = 0.3, 0.004, 1e-3
"""Norm of the scaled residual up to which a turned hand may come to hold the pair; that up to which it does, after a
descent; and that at which this ends. Bumps of a rough surface are in the way at some turns, by 0.1 mm and more."""
COVERED = 0.2
"""A way that differs by less from a hand that was found, turned, is not tried, rad."""
FAR = 100.0
"""Half edge of the room, m."""
POSTURES, MIDDLE = 200, 3.0
"""Random arm postures that are looked at, and how far from 0 their joints are at most, rad (m)."""
LENGTH = 0.3
"""Moves of the wrist, m, that count as much as a turn by 1 rad."""


class PairTrials:
    """Tries to hold pairs of points of a task's object; where that stands does not matter.

    Args:
        model: the task.
    """

    def __init__(self, model: TaskModel) -> None:
        task, arm = model.task, set(model.robot.description.arm.joints)
        ranges = {name: value for name, value in task.joint_ranges.items() if name not in arm}
        lock = {name: value for name, value in task.lock.items() if name not in arm}
        alone = {"approach": None, "joint_ranges": ranges, "lock": lock}
        scene = model.scene.model_copy(
            update={
                "enclosure": Enclosure(min=(-FAR, -FAR, -FAR), max=(FAR, FAR, FAR)),
                "obstacles": {},
                "objects": {task.object: model.scene.objects[task.object]},
                "tasks": {model.task_name: task.model_copy(update=alone)},
            }
        )
        self._model = TaskModel(model.robot.unmounted, scene, model.task_name)
        self._configuration = _loose(self._model)

    def held(self, pair: ContactPair, holds: Holds) -> tuple[Held, ...]:
        """Return hands that hold a pair, none of which is another one turned.

        Args:
            pair: of points.
            holds: ways to hold it.
        """
        found: list[Held] = []
        for way in _apart(holds.approaches):
            T_wrist = holds.pads[way] @ np.linalg.inv(holds.T_wrist_pad)
            if any(between(T_wrist, turned(held.hold, T_wrist)) <= COVERED for held in found):
                continue
            problem = self._problem(pair, holds, way)
            x = self._held_at(problem, holds)
            if x is not None:
                found.append(self._held(pair, problem, x))
        return tuple(found)

    def _problem(self, pair: ContactPair, holds: Holds, way: int) -> GraspProblem:
        """Return the problem with the object at the hand as in one of the ways."""
        T = wrist_pose(self._configuration) @ holds.T_wrist_pad @ np.linalg.inv(holds.pads[way])
        return self._with_object(pair, tuple(holds.orders[way].tolist()), T)

    def _with_object(self, pair: ContactPair, assignment: tuple[int, ...], T: Array) -> GraspProblem:
        """Return the problem with the object at a pose, shape (4, 4)."""
        name = self._model.task.object
        model = self._model.moved(name, self._model.scene.with_object_pose(name, T))
        return GraspProblem(model, assignment, desired=desired_points(pair, model))

    def _held_at(self, problem: GraspProblem, holds: Holds) -> Array | None:
        """Return the point at which the pair of a problem is held, shape (v,), if there is one."""
        robot = problem.model.robot
        x = 0.5 * (problem.lower + problem.upper)
        x[: robot.arm_size] = self._configuration.posture[: robot.arm_size]
        x[robot.arm_size : robot.posture_size] = holds.synergies
        x = np.clip(x, problem.lower, problem.upper)
        for targets, stalled, within in DESCENTS:
            x = descend(problem, targets, 1.0, x, stalled)
            if miss(problem, x) > within:
                return None
        state = problem.state(x)
        moved = np.linalg.norm(state.contacts.points - state.desired, axis=1)
        return x if moved.max() <= MOVED else None

    def _held(self, pair: ContactPair, problem: GraspProblem, x: Array) -> Held:
        """Return the hand that holds a pair at a point of a problem, shape (v,)."""
        state, T, robot = problem.state(x), problem.model.T_world_object, problem.model.robot
        points, normals, jacobians = state.grasp
        twists = np.concatenate([T[:3, :3].T @ jacobians[:, :3], T[:3, :3].T @ jacobians[:, 3:]], axis=1)
        contacts = Contacts((points - T[:3, 3]) @ T[:3, :3], normals @ T[:3, :3], twists)
        across = contacts.normals[0] - contacts.normals[1]
        origin, along = contacts.points.mean(axis=0), across / np.linalg.norm(across)
        turns = [0.0]
        for turn in TURNS[1:]:
            there = self._with_object(pair, problem.assignment, T @ turned_about(origin, along, -turn))
            if miss(there, x) <= LITTLE and miss(there, descend(there, 0.0, 1.0, x, 0.3, done=CLOSE)) <= LEAST:
                turns.append(turn)
        hand, parameters = x[robot.arm_size : robot.posture_size], x[robot.posture_size :]
        T_wrist = np.linalg.inv(T) @ wrist_pose(state.configuration)
        hold = Hold(T_wrist, hand, parameters, problem.assignment, np.stack([origin, along]), np.array(turns))
        return Held(hold, contacts)


def _apart(approaches: Array) -> list[int]:
    """Return up to `WAYS` numbers of directions, each as far as possible from the lines along those before it."""
    chosen = [0]
    while len(chosen) < min(WAYS, len(approaches)):
        along = np.abs(approaches @ approaches[chosen].T).max(axis=1)
        along[chosen] = np.inf
        chosen.append(int(along.argmin()))
    return chosen


def _loose(model: TaskModel) -> Configuration:
    """Return the arm as it can best move its wrist to all sides, of random postures that keep links off each other."""
    robot, rng, size = model.robot, np.random.default_rng(0), model.robot.arm_size
    data, posture = robot.model.createData(), 0.5 * (model.lower + model.upper)
    low, high = np.maximum(model.lower[:size], -MIDDLE), np.minimum(model.upper[:size], MIDDLE)
    wrist = robot.model.frames[robot.wrist_frame].parentJoint
    margins = np.array([pair.margin for pair in model.collisions.pairs])

    def clear(found: Distances) -> bool:
        return bool((found.values >= margins[found.indices]).all())

    best, most = forward(robot, data, posture.copy()), -1.0
    for _ in range(POSTURES):
        posture[:size] = rng.uniform(low, high)
        configuration = forward(robot, data, posture.copy())
        moves = (configuration.jacobian * robot.supports[wrist]) @ robot.B[:, :size]
        moves[:3] -= np.cross(moves[3:].T, -configuration.translations[wrist]).T
        moves[:3] /= LENGTH
        least = float(np.linalg.svd(moves, compute_uv=False)[-1])
        if least > most and clear(model.collisions.distances(configuration)):
            best, most = configuration, least
    return best
