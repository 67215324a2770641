"""Preferences of a task in terms of its robot: a cone of approach directions, bounds of posture and contacts."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..descriptions import Scene, Task
from ..descriptions.task import JointInterval
from ..errors import TaskError, UnknownNameError, close_names
from ..geometry.cone import DirectionCone
from ..geometry.patches import inside_rim
from ..kinematics.robot import Robot

ROUNDING = 1e-9
"""How far the value of a lock may be outside the limits and still be their end, rad (m)."""


def approach_cone(task: Task, T_world_object: Array) -> DirectionCone | None:
    """Return the cone of a task in the world, or None if every approach direction is fine."""
    if task.approach is None:
        return None
    R = T_world_object[:3, :3] if task.approach.frame == "object" else np.eye(3)
    return DirectionCone(R @ np.array(task.approach.direction), task.approach.angle)


def posture_bounds(robot: Robot, scene: Scene, task_name: str) -> tuple[Array, Array]:
    """Return lower and upper bounds of the posture (q_a, sigma), rad (m): the robot's limits, narrowed by the task.

    The task asks for a reserve of the arm joints that have limits, for ranges, and for joints that are locked, whose
    bounds are equal.

    An interval of a joint whose whole turns do not count is moved by turns until its middle is within half a turn of
    the middle of what is left of the joint's bounds. At first that is zero, so that a range of less than a turn lies
    within the +-2 pi that the model gives such a joint; then it is a range that the task gives besides a lock.

    Raises:
        UnknownNameError: a range or a lock names no arm joint or synergy.
        TaskError: one does not meet the robot's limits less the reserve, or both contradict each other, or the reserve
            leaves nothing of a joint's limits.
    """
    names = list(robot.posture_names)
    lower, upper = _within_reserve(robot, scene, task_name)
    for interval in scene.task(task_name).intervals:
        if interval.name not in names:
            raise _unknown_joint(robot, scene, task_name, interval)
        i = names.index(interval.name)
        low, high = interval.lower, interval.upper
        if robot.turns_freely(interval.name):
            shift = math.tau * round(0.5 * (low + high - lower[i] - upper[i]) / math.tau)
            low, high = low - shift, high - shift
        room = min(upper[i], high) - max(lower[i], low)
        if room < -ROUNDING or (room <= 0.0 and low < high):
            raise _apart(robot, scene, task_name, interval)
        lower[i], upper[i] = np.clip((low, high), lower[i], upper[i])
    return lower, upper


def _unknown_joint(robot: Robot, scene: Scene, task_name: str, interval: JointInterval) -> UnknownNameError:
    mimic = robot.urdf.mimics.get(interval.name)
    return UnknownNameError(
        f"{interval.name!r} is no arm joint or synergy of {robot.description.name}",
        file=scene.source,
        key=_key(task_name, interval),
        remedy=f"It mimics {mimic.leader}: name that" if mimic else close_names(interval.name, robot.posture_names),
    )


def _apart(robot: Robot, scene: Scene, task_name: str, interval: JointInterval) -> TaskError:
    """Return the error of an interval that does not meet what the robot, the reserve or the task's range allow."""
    task, name, locked = scene.task(task_name), interval.name, interval.key == "lock"
    i = robot.posture_names.index(name)
    low, high = float(robot.lower[i]), float(robot.upper[i])
    reserve = task.reserve.joint if i < robot.arm_size and not robot.turns_freely(name) else 0.0
    within = robot.turns_freely(name) or low + reserve <= interval.lower <= high - reserve
    if locked and within:
        first, last = task.joint_ranges[name]
        problem = f"{interval.lower:g} is outside joint_ranges.{name}, [{first:g}, {last:g}]"
        remedy = "Give the lock alone, or a range that holds it"
    else:
        limits = f"the limits [{low + reserve:g}, {high - reserve:g}] of the robot"
        limits += f", less the task's reserve of {reserve:g}" if reserve else ""
        if locked:
            problem, remedy = f"{interval.lower:g} is outside {limits}", "Give a value within them"
            if low <= interval.lower <= high:
                remedy += ", or a smaller reserve.joint"
        else:
            problem = f"[{interval.lower:g}, {interval.upper:g}] does not meet {limits}"
            remedy = "Give a range that overlaps them"
    return TaskError(problem, file=scene.source, key=_key(task_name, interval), remedy=remedy)


def _key(task_name: str, interval: JointInterval) -> str:
    return f"tasks.{task_name}.{interval.key}.{interval.name}"


def _within_reserve(robot: Robot, scene: Scene, task_name: str) -> tuple[Array, Array]:
    """Return the robot's limits of the posture, those of arm joints less the task's reserve, rad (m)."""
    reserve, lower, upper = scene.task(task_name).reserve.joint, robot.lower.copy(), robot.upper.copy()
    for i, name in enumerate(robot.description.arm.joints):
        if robot.turns_freely(name):
            continue
        if upper[i] - lower[i] <= 2.0 * reserve:
            problem = f"{reserve:g} leaves nothing of the limits [{lower[i]:g}, {upper[i]:g}] of {name}"
            key, remedy = f"tasks.{task_name}.reserve.joint", "Give a smaller reserve"
            raise TaskError(problem, file=scene.source, key=key, remedy=remedy)
        lower[i], upper[i] = lower[i] + reserve, upper[i] - reserve
    return lower, upper


def parameter_limits(robot: Robot, scene: Scene, task_name: str) -> Array:
    """Return the ranges of the contact parameters q_c, within the task's reserve from the rims, m (rad), shape (c, 2).

    Raises:
        TaskError: the reserve leaves nothing of a pad.
    """
    reserve = scene.task(task_name).reserve.rim
    limits = [inside_rim(pad.patch, reserve) for pad in robot.pads]
    for pad, ranges in zip(robot.description.pads, limits, strict=True):
        if (ranges[:, 0] > ranges[:, 1]).any():
            problem = f"a reserve of {1e3 * reserve:g} mm leaves nothing of the pad {pad.name!r}"
            key, remedy = f"tasks.{task_name}.reserve.rim", "Give a smaller reserve"
            raise TaskError(problem, file=scene.source, key=key, remedy=remedy)
    return np.concatenate(limits)
