"""Findings about the hand as a whole: do pads face each other, how far does it open, where does the wrist point."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from ..arrays import Array
from ..kinematics.contacts import contact_kinematics
from ..kinematics.forward import forward
from ..kinematics.robot import Robot
from ..words import in_words, number_of
from .findings import Finding

POSTURES = 400
"""Postures of a hand with more than one synergy, drawn at random; of one synergy, a tenth, evenly."""
TURNED = 0.01
"""Change of the cosine between the normals of pads of which they count as parallel."""
OPPOSED, HARDLY = math.radians(10.0), math.radians(75.0)
"""Up to the first angle pads face each other; beyond the second no friction that there is would hold anything."""
ASKEW, ASIDE = math.radians(30.0), math.radians(75.0)
"""The wrist's z axis may be this far off the direction to the pads: of two, which a jaw has ahead, and of more."""


def hand_findings(robot: Robot) -> Iterator[Finding]:
    """Judge pads and wrist over postures of the hand, the arm in the middle of its limits."""
    pads = robot.description.pads
    hard = sum(pad.contact.model == "hard_finger" for pad in pads)
    what = f"{number_of(len(pads), 'contact')}, {hard} hard and {len(pads) - hard} soft fingers"
    if len(pads) == hard == 2:
        what += ": no torque about the line through them is held"
    yield Finding("ok", what)
    points, normals, wrists = _contacts(robot)
    if len(pads) == hard == 2 and np.ptp((normals[:, 0] * normals[:, 1]).sum(axis=1)) > TURNED:
        what = "the pads do not stay parallel, and are hard fingers: weight turns what they hold about both contacts"
        yield Finding("doubtful", what, "Describe rubber as soft_finger; hard ones hold only where nothing turns it")
    yield from _facing(robot, points, normals)
    yield from _approach(robot, points, wrists)


def _contacts(robot: Robot) -> tuple[Array, Array, Array]:
    """Return pad centres and normals, shapes (postures, pads, 3), and wrist poses, shape (postures, 4, 4)."""
    data, centers, size = robot.model.createData(), robot.parameter_limits.mean(axis=1), robot.arm_size
    low, high = robot.lower[size:], robot.upper[size:]
    if len(low) == 1:
        hands = np.linspace(low, high, POSTURES // 10 + 1)
    else:
        hands = np.random.default_rng(0).uniform(low, high, (POSTURES, len(low)))
    posture = 0.5 * (robot.lower + robot.upper)
    points, normals, wrists = [], [], []
    for sigma in hands:
        posture[size:] = sigma
        configuration = forward(robot, data, posture)
        contacts = contact_kinematics(configuration, centers)
        frame = robot.model.frames[robot.wrist_frame]
        points.append(contacts.points)
        normals.append(contacts.normals)
        wrists.append(data.oMi[frame.parentJoint].homogeneous @ frame.placement.homogeneous)
    return np.array(points), np.array(normals), np.array(wrists)


def _facing(robot: Robot, points: Array, normals: Array) -> Iterator[Finding]:
    names = [pad.name for pad in robot.description.pads]
    best = np.full((len(names), len(names)), math.pi)
    gaps: list[float] = []
    for i, j in itertools.combinations(range(len(names)), 2):
        apart = points[:, j] - points[:, i]
        gap = (apart * normals[:, i]).sum(axis=1)
        before = (gap > -1e-3) & ((apart * normals[:, j]).sum(axis=1) < 1e-3)
        angles = np.arccos(np.clip(-(normals[:, i] * normals[:, j]).sum(axis=1), -1.0, 1.0))
        if before.any():
            best[i, j] = best[j, i] = angles[before].min()
        gaps += gap[before & (angles < OPPOSED)].tolist()
    remedy = "Check the pads' normals and links, and which joints the synergies move; look at the picture"
    alone = [name for name, angles in zip(names, best, strict=True) if angles.min() > HARDLY]
    if len(alone) == len(names):
        yield Finding("wrong", f"the pads never face each other: {in_words(names)}", remedy)
    elif alone:
        yield Finding("doubtful", f"pads that never face another one: {in_words(alone)}", remedy)
    elif not gaps:
        what = f"no two pads come nearer than {math.degrees(best.min()):.0f} degrees to facing each other"
        yield Finding("doubtful", what, remedy)
    else:
        low, high = 1e3 * max(min(gaps), 0.0), 1e3 * max(gaps)
        yield Finding("ok", f"pads face each other, {low:.1f} to {high:.1f} mm apart")


def _approach(robot: Robot, points: Array, wrists: Array) -> Iterator[Finding]:
    wrist, remedy = (
        robot.description.arm.wrist,
        "Name a link under arm.wrist whose z axis points to where the pads close",
    )
    towards = points.mean(axis=1) - wrists[:, :3, 3]
    lengths = np.linalg.norm(towards, axis=1)
    if lengths.min() < 1e-3:  # a frame between the pads: any direction would do
        yield Finding("ok", f"the wrist, {wrist}, is between the pads")
        return
    angle = _off(towards, wrists)
    if angle > math.pi / 2:  # a frame beyond the pads: what counts is how the fingers point
        data = forward(robot, robot.model.createData(), 0.5 * (robot.lower + robot.upper))
        last = data.translations[robot.model.frames[robot.wrist_frame].parentJoint]
        angle = min(angle, _off(points.mean(axis=1) - last, wrists))
    what = f"the z axis of {wrist} is {math.degrees(angle):.0f} degrees off the direction to the pads"
    if angle > (ASKEW if points.shape[1] == 2 else ASIDE):
        yield Finding("doubtful", f"{what}: approach directions mean something else", remedy)
    else:
        yield Finding("ok", what)


def _off(directions: Array, wrists: Array) -> float:
    """Return the mean angle between directions, shape (n, 3), and z axes of poses, shape (n, 4, 4), rad."""
    cosines = (directions * wrists[:, :3, 2]).sum(axis=1) / np.linalg.norm(directions, axis=1)
    return float(np.arccos(np.clip(cosines, -1.0, 1.0)).mean())
