"""Checks that two pads can be at both desired contacts at once: how far apart these are, and how they face."""

from __future__ import annotations

import math

import numpy as np

from ..errors import TaskError
from ..kinematics.grips import grips
from ..kinematics.hand_posture import always_parallel, jaw_range
from .task_model import TaskModel

COARSE = 0.001
"""How far desired contacts may be beyond what the table of the hand's postures has, m."""
TURNED = math.radians(5.0)
"""How far from opposite the surface may be at the desired contacts of pads that are parallel, rad."""


def check_openings(model: TaskModel) -> list[str]:
    """Refuse an object that no jaw is wide enough for; return why pads do not get to both desired contacts, in words.

    Contacts elsewhere on the object may still be possible. Hands of more than two pads are not looked at.

    Raises:
        TaskError: the jaw does not open as wide as the object is at its narrowest.
    """
    if model.task.desired_contacts is None or len(model.robot.pads) != 2:
        return []
    _jaw_wide_enough(model)
    own = slice(model.robot.arm_size, None)
    widths = grips(model.robot, model.lower[own], model.upper[own]).widths
    if not len(widths):
        return ["the two pads face each other in no posture of the hand that the task allows"]
    normals, beside = model.felt_normals(model.desired_points), "or leave out `desired_contacts`"
    turned = math.acos(float(np.clip(-normals[0] @ normals[1], -1.0, 1.0)))
    if turned > TURNED:
        return _turned_away(model, turned, beside)
    apart = abs(float((model.desired_points[1] - model.desired_points[0]) @ normals[0]))
    shown = f"the desired contacts are {1e3 * apart:.1f} mm apart"
    if apart > widths.max() + COARSE:
        most = 1e3 * float(widths.max())
        return [f"{shown}, the pads open to {most:.1f} mm: give points nearer to each other, {beside}"]
    if apart < widths.min() - COARSE:
        least = 1e3 * float(widths.min())
        return [f"{shown}, the pads close to {least:.1f} mm: give points farther from each other, {beside}"]
    return []


def _turned_away(model: TaskModel, turned: float, beside: str) -> list[str]:
    if not always_parallel(model.robot):
        return []
    return [
        f"the surface at the desired contacts is {math.degrees(turned):.0f} ° from opposite, and the pads are parallel "
        f"in every posture of the hand: give points on opposite sides, {beside}"
    ]


def _jaw_wide_enough(model: TaskModel) -> None:
    jaw = jaw_range(model.robot)
    if jaw is not None and (widest := jaw[1]) < model.surface.least_width:
        raise TaskError(
            f"the pads open to {1e3 * widest:.1f} mm, but {model.task.object!r} is at least "
            f"{1e3 * model.surface.least_width:.1f} mm wide",
            file=model.scene.source,
            key=f"objects.{model.task.object}.shape",
            remedy=f"Use a gripper that opens {1e3 * (model.surface.least_width - widest):.1f} mm wider, or a smaller "
            "object",
        )
