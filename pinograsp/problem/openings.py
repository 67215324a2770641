"""Checks that two pads can be at both desired contacts at once: how far apart these are, and how they face."""

from __future__ import annotations

import math

import numpy as np

from ..errors import TaskError
from ..geometry.contact_faces import widest_room
from ..kinematics.grips import grips
from ..kinematics.hand_posture import always_parallel, jaw_range
from ..units import shown
from .task_model import TaskModel

COARSE, EXACT = 0.001, 1e-5
"""How far desired contacts may be beyond what the table of the hand's postures has, m; and for pads that are parallel
in all of them, of a hand of one synergy, whose table has the ends."""
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
    return [*_openings(model), *_narrow_faces(model)]


def _openings(model: TaskModel) -> list[str]:
    """Return why the hand does not get its pads to both desired contacts."""
    own = slice(model.robot.arm_size, None)
    widths = grips(model.robot, model.lower[own], model.upper[own]).widths
    if not len(widths):
        return ["the two pads face each other in no posture of the hand that the task allows"]
    normals, beside = model.felt_normals(model.desired_points), "or leave out `desired_contacts`"
    turned = math.acos(float(np.clip(-normals[0] @ normals[1], -1.0, 1.0)))
    if turned > TURNED:
        return _turned_away(model, turned, beside)
    apart = abs(float((model.desired_points[1] - model.desired_points[0]) @ normals[0]))
    told = f"the desired contacts are {shown(apart, 'm')} apart"
    beyond = EXACT if always_parallel(model.robot) and model.robot.synergies.shape[1] == 1 else COARSE
    if apart > widths.max() + beyond:
        most = shown(float(widths.max()), "m")
        return [f"{told}, the pads open to {most}: give points nearer to each other, {beside}"]
    if apart < widths.min() - beyond:
        least = shown(float(widths.min()), "m")
        return [f"{told}, the pads close to {least}: give points farther from each other, {beside}"]
    return []


def _turned_away(model: TaskModel, turned: float, beside: str) -> list[str]:
    if not always_parallel(model.robot):
        return []
    return [
        f"the surface at the desired contacts is {math.degrees(turned):.0f} ° from opposite, and the pads are parallel "
        f"in every posture of the hand: give points on opposite sides, {beside}"
    ]


def _narrow_faces(model: TaskModel) -> list[str]:
    """Return which desired contacts are on faces that are narrower than contacts are to be off their edges."""
    rim, found = model.task.reserve.rim, []
    for number, point in enumerate(model.desired_points):
        room = widest_room(model.contact_face(point))
        if room < rim:
            wide, kept = shown(2.0 * room, "m"), f"contacts keep {shown(rim, 'm')} from edges (reserve.rim)"
            remedy = "give a point on another face, or a smaller reserve.rim"
            found.append(f"desired_contacts[{number}] is on a face {wide} wide, and {kept}: {remedy}")
    return found


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
