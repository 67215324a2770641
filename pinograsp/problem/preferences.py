"""What a task prefers, in terms of its robot: a cone of approach directions, bounds of posture and contacts."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..descriptions import Scene, Task
from ..errors import InputError, close_names
from ..geometry.cone import Cone
from ..geometry.patches import inside_rim
from ..kinematics.robot import Robot

WHOLE_TURN = 2.0 * math.pi


def approach_cone(task: Task, T_world_object: Array) -> Cone | None:
    """Return the cone of a task in the world, or None if every approach direction is fine."""
    if task.approach is None:
        return None
    R = T_world_object[:3, :3] if task.approach.frame == "object" else np.eye(3)
    return Cone(R @ np.array(task.approach.direction), task.approach.angle)


def posture_bounds(robot: Robot, scene: Scene, task_name: str) -> tuple[Array, Array]:
    """Return lower and upper bounds of the posture (q_a, sigma): the robot's limits, narrowed by the task.

    The task asks for a reserve of the arm joints that have limits, and for ranges.

    The range of a joint whose whole turns do not count is moved by turns until its middle is within half a turn of
    zero: a range of less than a turn then lies within the +-2 pi that the model gives such a joint.

    Raises:
        InputError: a range names no arm joint or synergy, or does not meet the robot's limits less the reserve, or the
            reserve leaves nothing of a joint's limits.
    """
    names = list(robot.posture_names)
    lower, upper = _within_reserve(robot, scene, task_name)
    for name, (low, high) in scene.task(task_name).joint_ranges.items():
        key = f"tasks.{task_name}.joint_ranges.{name}"
        if name not in names:
            mimic = robot.urdf.mimics.get(name)
            remedy = f"It mimics {mimic.leader}: name that" if mimic else close_names(name, names)
            problem = f"{name!r} is no arm joint or synergy of {robot.description.name}"
            raise InputError(problem, file=scene.source, key=key, remedy=remedy)
        i = names.index(name)
        shift = WHOLE_TURN * round(0.5 * (low + high) / WHOLE_TURN) if robot.turns_freely(name) else 0.0
        narrowed = max(lower[i], low - shift), min(upper[i], high - shift)
        if narrowed[0] >= narrowed[1]:
            problem = f"[{low:g}, {high:g}] does not meet the limits [{lower[i]:g}, {upper[i]:g}] of the robot"
            reserve = scene.task(task_name).reserve.joint if i < robot.arm_size else 0.0
            problem += f", less the task's reserve of {reserve:g}" if reserve and not robot.turns_freely(name) else ""
            raise InputError(problem, file=scene.source, key=key, remedy="Give a range that overlaps them")
        lower[i], upper[i] = narrowed
    return lower, upper


def _within_reserve(robot: Robot, scene: Scene, task_name: str) -> tuple[Array, Array]:
    """Return the robot's limits of the posture, those of arm joints less the task's reserve."""
    reserve, lower, upper = scene.task(task_name).reserve.joint, robot.lower.copy(), robot.upper.copy()
    for i, name in enumerate(robot.description.arm.joints):
        if robot.turns_freely(name):
            continue
        if upper[i] - lower[i] <= 2.0 * reserve:
            problem = f"{reserve:g} leaves nothing of the limits [{lower[i]:g}, {upper[i]:g}] of {name}"
            key, remedy = f"tasks.{task_name}.reserve.joint", "Give a smaller reserve"
            raise InputError(problem, file=scene.source, key=key, remedy=remedy)
        lower[i], upper[i] = lower[i] + reserve, upper[i] - reserve
    return lower, upper


def parameter_limits(robot: Robot, scene: Scene, task_name: str) -> Array:
    """Return the ranges of the contact parameters q_c, within the task's reserve from the rims, shape (c, 2).

    Raises:
        InputError: the reserve leaves nothing of a pad.
    """
    reserve = scene.task(task_name).reserve.rim
    limits = [inside_rim(pad.patch, reserve) for pad in robot.pads]
    for pad, ranges in zip(robot.description.pads, limits, strict=True):
        if (ranges[:, 0] > ranges[:, 1]).any():
            problem = f"a reserve of {1e3 * reserve:g} mm leaves nothing of the pad {pad.name!r}"
            key, remedy = f"tasks.{task_name}.reserve.rim", "Give a smaller reserve"
            raise InputError(problem, file=scene.source, key=key, remedy=remedy)
    return np.concatenate(limits)
